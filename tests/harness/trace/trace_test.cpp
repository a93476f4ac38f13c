#include "../mcap/mcap_files.h"

#include <rehearse/messages.h>
#include <rehearse/trace.h>

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "core/trace/event_stream.h"
#include "core/trace/trace_windows.h"

using namespace rehearse;
using namespace rehearse::test;
using testing::ElementsAre;
using testing::HasSubstr;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint64_t ms = 1'000'000;

/// Writes messages to topics, and loads the result.
class Recording {
 public:
  Recording() : writer_(std::move(*mcap::Writer::create(file_.path()))) {}

  template <class Message>
  Recording& add(std::string_view topic, std::uint64_t time, const Message& message,
                 const mcap::StringMap& metadata = {{"unit", "rad"}}) {
    auto [channel, is_new] = channels_.try_emplace(std::string(topic), 0);
    if (is_new) {
      const auto schema = writer_->add_schema(Message::type_name, "ros2msg", msg::schema_text<Message>());
      channel->second = writer_->add_channel(schema, topic, "cdr", metadata);
    }
    cdr_.reset();
    msg::encode(message, cdr_);
    return raw(channel->second, time, cdr_.bytes());
  }
  Recording& raw(std::uint16_t channel, std::uint64_t time, mcap::Bytes bytes) {
    EXPECT_TRUE(writer_->write(channel, time, time, bytes));
    return *this;
  }
  mcap::Writer& writer() { return *writer_; }
  const TempFile& file() const { return file_; }

  Result<Trace> try_load(Trace::Damage damage = Trace::Damage::refuse) {
    EXPECT_TRUE(writer_->close());
    return Trace::load(file_.path(), damage);
  }
  Trace load() {
    auto trace = try_load();
    EXPECT_TRUE(trace) << (trace ? "" : to_string(trace.errors()));
    return std::move(*trace);
  }

 private:
  TempFile file_;
  std::unique_ptr<mcap::Writer> writer_;
  std::map<std::string, std::uint16_t> channels_;
  CdrWriter cdr_;
};

msg::JointState joints(std::vector<std::string> names, std::vector<double> q, std::vector<double> u = {}) {
  msg::JointState message;
  message.name = std::move(names);
  message.position = std::move(q);
  message.effort = std::move(u);
  return message;
}

std::vector<std::string> names_of(const Trace& trace) {
  std::vector<std::string> names;
  for (const auto& [name, place] : trace.series()) names.push_back(name);
  return names;
}

std::string message_of(const std::function<void()>& function) {
  try {
    function();
  } catch (const std::out_of_range& error) {
    return error.what();
  }
  return "nothing thrown";
}

}  // namespace

TEST(Trace, NamesJointsByTheirOwner) {
  Recording recording;
  recording.add("/SR1/joints", 0, joints({"RLEG_KNEE", "LLEG_KNEE"}, {0.1, 0.2}));
  recording.add("/SR1/SR1Minimum/output/joints", 0, joints({"RLEG_KNEE"}, {}, {3.0}));
  const Trace trace = recording.load();
  EXPECT_THAT(names_of(trace), ElementsAre("SR1/LLEG_KNEE/q", "SR1/RLEG_KNEE/q", "SR1/SR1Minimum/output/RLEG_KNEE/u"));
  EXPECT_EQ(trace.last("SR1/LLEG_KNEE/q"), 0.2);
  EXPECT_EQ(trace.last("SR1/SR1Minimum/output/RLEG_KNEE/u"), 3.0);
}

TEST(Trace, NamesTheElementsOfEveryStandardType) {
  Recording recording;
  recording.add("/B/L/pose", 0, msg::PoseStamped{{}, {{1, 2, 3}, {4, 5, 6, 7}}});
  recording.add("/B/L/twist", 0, msg::TwistStamped{{}, {{1, 2, 3}, {4, 5, 6}}});
  recording.add("/B/L/accel", 0, msg::AccelStamped{{}, {{1, 2, 3}, {4, 5, 6}}});
  recording.add("/B/Foot/wrench", 0, msg::WrenchStamped{{}, {{1, 2, 3}, {4, 5, 6}}});
  msg::Imu imu;
  imu.angular_velocity = {1, 2, 3};
  imu.linear_acceleration = {4, 5, 6};
  recording.add("/B/Imu/imu", 0, imu);
  msg::JointAccelerations accelerations;
  accelerations.name = {"J"};
  accelerations.acceleration = {9};
  recording.add("/B/accelerations", 0, accelerations);
  recording.add("/B/Dev/state", 0, msg::DeviceState{{}, {7, 8}});
  recording.add("/B/Sole/contact", 0, msg::ContactForce{{}, 4, {1, 2, 3}});
  const Trace trace = recording.load();
  EXPECT_THAT(names_of(trace),
              testing::UnorderedElementsAre(
                  "B/L/position/x", "B/L/position/y", "B/L/position/z", "B/L/orientation/x", "B/L/orientation/y",
                  "B/L/orientation/z", "B/L/orientation/w", "B/L/linear/x", "B/L/linear/y", "B/L/linear/z",
                  "B/L/angular/x", "B/L/angular/y", "B/L/angular/z", "B/L/linear_acceleration/x",
                  "B/L/linear_acceleration/y", "B/L/linear_acceleration/z", "B/L/angular_acceleration/x",
                  "B/L/angular_acceleration/y", "B/L/angular_acceleration/z", "B/Foot/force/x", "B/Foot/force/y",
                  "B/Foot/force/z", "B/Foot/torque/x", "B/Foot/torque/y", "B/Foot/torque/z", "B/Imu/angular_velocity/x",
                  "B/Imu/angular_velocity/y", "B/Imu/angular_velocity/z", "B/Imu/linear_acceleration/x",
                  "B/Imu/linear_acceleration/y", "B/Imu/linear_acceleration/z", "B/J/ddq", "B/Dev/values/0",
                  "B/Dev/values/1", "B/Sole/count", "B/Sole/force/x", "B/Sole/force/y", "B/Sole/force/z"));
  EXPECT_EQ(trace.last("B/Sole/count"), 4);
  EXPECT_EQ(trace.last("B/Sole/force/z"), 3);
  EXPECT_EQ(trace.last("B/L/orientation/w"), 7);
  EXPECT_EQ(trace.last("B/L/angular_acceleration/z"), 6);
  EXPECT_EQ(trace.last("B/Foot/torque/x"), 4);
  EXPECT_EQ(trace.last("B/Imu/linear_acceleration/y"), 5);
  EXPECT_EQ(trace.last("B/J/ddq"), 9);
  EXPECT_EQ(trace.last("B/Dev/values/1"), 8);
}

TEST(Trace, HasAColumnForAsManyContactsAsThereEverAre) {
  Recording recording;
  const auto contact = [](double force) { return msg::Contact{{1, 2, 3}, {0, 0, 1}, {0, 0, force}, {4, 5, 6}, 7}; };
  recording.add("/B/C/input/FOOT/contacts", 0, msg::Contacts{});
  recording.add("/B/C/input/FOOT/contacts", 1, msg::Contacts{{}, {contact(10), contact(20)}});
  recording.add("/B/C/input/FOOT/contacts", 2, msg::Contacts{{}, {contact(30)}});
  const Trace trace = recording.load();
  EXPECT_EQ(trace.series().size(), 1 + 2 * 13u);
  EXPECT_THAT(trace.values("B/C/input/FOOT/contacts/count"), ElementsAre(0, 2, 1));
  EXPECT_THAT(trace.values("B/C/input/FOOT/contacts/0/force/z"), ElementsAre(testing::IsNan(), 10, 30));
  EXPECT_THAT(trace.values("B/C/input/FOOT/contacts/1/force/z"), ElementsAre(testing::IsNan(), 20, testing::IsNan()));
  EXPECT_EQ(trace.last("B/C/input/FOOT/contacts/0/position/y"), 2);
  EXPECT_EQ(trace.last("B/C/input/FOOT/contacts/0/normal/z"), 1);
  EXPECT_EQ(trace.last("B/C/input/FOOT/contacts/0/velocity/x"), 4);
  EXPECT_EQ(trace.last("B/C/input/FOOT/contacts/0/depth"), 7);
}

TEST(Trace, NamesAJoysticksControlsAsItsChannelDoes) {
  Recording recording;
  recording.add("/joy", 0, msg::Joy{{}, {-0.3f, 1.0f}, {0, 1}}, {{"axes", "L_STICK_H L_STICK_V"}, {"buttons", "A B"}});
  recording.add("/joy", 1, msg::Joy{{}, {0.5f, 0.0f}, {1, -1}}, {{"axes", "L_STICK_H L_STICK_V"}, {"buttons", "A B"}});
  const Trace trace = recording.load();
  EXPECT_THAT(names_of(trace), ElementsAre("axes/L_STICK_H", "axes/L_STICK_V", "buttons/A", "buttons/B"));
  EXPECT_THAT(trace.values("axes/L_STICK_H"), ElementsAre(static_cast<double>(-0.3f), 0.5));
  EXPECT_THAT(trace.values("buttons/B"), ElementsAre(1.0, -1.0));
}

TEST(Trace, NumbersTheControlsOfAJoystickThatHasNoNames) {
  Recording recording;
  recording.add("/operator/joy", 0, msg::Joy{{}, {0.25f, 0.5f}, {1}}, {{"axes", "L_STICK_H"}});
  const Trace trace = recording.load();
  EXPECT_THAT(names_of(trace), ElementsAre("operator/axes/1", "operator/axes/L_STICK_H", "operator/buttons/0"));
  EXPECT_EQ(trace.last("operator/axes/1"), 0.5);
}

TEST(Trace, NamesTheBeamsOfScansByTheirNumbers) {
  const float infinite = std::numeric_limits<float>::infinity();
  msg::LaserScan scan;
  scan.angle_min = -0.5f;
  scan.range_max = 10.0f;
  Recording recording;
  recording.add("/B/Laser/scan", 0, scan);  // switched off
  scan.ranges = {1.5f, infinite, 2.25f};
  recording.add("/B/Laser/scan", ms, scan);
  const Trace trace = recording.load();
  EXPECT_THAT(names_of(trace), testing::UnorderedElementsAre(
                                   "B/Laser/angle_min", "B/Laser/angle_max", "B/Laser/range_min", "B/Laser/range_max",
                                   "B/Laser/ranges/0", "B/Laser/ranges/1", "B/Laser/ranges/2"));
  EXPECT_TRUE(std::isnan(trace.values("B/Laser/ranges/0")[0]));
  EXPECT_EQ(trace.last("B/Laser/ranges/0"), 1.5);
  EXPECT_EQ(trace.last("B/Laser/ranges/1"), infinite);
  EXPECT_EQ(trace.last("B/Laser/ranges/2"), 2.25);
  EXPECT_EQ(trace.last("B/Laser/angle_min"), -0.5);
}

TEST(Trace, ReadsScansOfFewerAndOfMoreBeams) {
  msg::LaserScan scan;
  Recording recording;
  for (const std::vector<float>& ranges : {std::vector<float>{1, 2}, {3}, {4, 5, 6}}) {
    scan.ranges = ranges;
    recording.add("/B/Laser/scan", ms, scan);
  }
  const Trace trace = recording.load();
  EXPECT_THAT(trace.values("B/Laser/ranges/0"), ElementsAre(1, 3, 4));
  EXPECT_THAT(trace.values("B/Laser/ranges/1"), ElementsAre(2, testing::IsNan(), 5));
  EXPECT_THAT(trace.values("B/Laser/ranges/2"), ElementsAre(testing::IsNan(), testing::IsNan(), 6));
}

/// Two rows of three points, each with a distance at some place in it.
msg::PointCloud2 cloud() {
  msg::PointCloud2 message;
  message.height = 2;
  message.width = 3;
  message.fields = {{"x", 0, msg::PointField::float32, 1}, {"range", 8, msg::PointField::float32, 1}};
  message.point_step = 12;
  message.row_step = 36;
  message.data.resize(72);
  for (std::size_t i = 0; i < 6; ++i) {
    const float range = 0.5f * static_cast<float>(i);
    std::memcpy(message.data.data() + 12 * i + 8, &range, 4);
  }
  return message;
}

TEST(Trace, FindsTheDistancesInAPointCloud) {
  Recording recording;
  recording.add("/B/Laser/points", 0, cloud());
  const Trace trace = recording.load();
  for (int i = 0; i < 6; ++i) EXPECT_EQ(trace.last("B/Laser/ranges/" + std::to_string(i)), 0.5 * i);
  EXPECT_EQ(trace.last("B/Laser/height"), 2);
}

TEST(Trace, TakesNoDistancesFromAPointCloudWithoutThem) {
  std::vector<msg::PointCloud2> clouds(6, cloud());
  clouds[0].fields.pop_back();
  clouds[1].fields[1].datatype = 8;  // float64
  clouds[2].fields[1].offset = 9;    // beyond the point's end
  clouds[3].data.pop_back();
  clouds[4].point_step = 0;
  clouds[5].width = 0xffffffff;
  for (const msg::PointCloud2& one : clouds) {
    Recording recording;
    recording.add("/B/Laser/points", 0, one);
    EXPECT_THAT(names_of(recording.load()), testing::UnorderedElementsAre("B/Laser/height", "B/Laser/width"));
  }
}

TEST(Trace, NamesTransformsByTheirChildFrame) {
  msg::TFMessage message;
  message.transforms.resize(2);
  message.transforms[0].child_frame_id = "WAIST";
  message.transforms[1].child_frame_id = "CHEST";
  message.transforms[1].transform.translation.x = 5;
  Recording recording;
  recording.add("/tf", 0, message);
  const Trace trace = recording.load();
  EXPECT_EQ(trace.series().size(), 14u);
  EXPECT_EQ(trace.last("CHEST/position/x"), 5);
  EXPECT_EQ(trace.last("WAIST/orientation/w"), 1);
}

TEST(Trace, KeepsHashesExactly) {
  msg::Tick tick;
  tick.tick = 3;
  tick.state_hash = 0xfedcba9876543211;  // a double can't represent it
  tick.controller_results = {true, false};
  Recording recording;
  recording.add("/tick", 3 * ms, tick);
  const Trace trace = recording.load();
  EXPECT_THAT(trace.integers("state_hash"), ElementsAre(0xfedcba9876543211));
  EXPECT_EQ(trace.last("tick"), 3.0);
  EXPECT_EQ(trace.last("controller_results/0"), 1.0);
  EXPECT_EQ(trace.last("controller_results/1"), 0.0);
  EXPECT_EQ(trace.ticks(), 1);
}

TEST(Trace, KeepsEveryBitOfADouble) {
  const double odd = std::bit_cast<double>(std::uint64_t{0x7ff0000000000123});
  Recording recording;
  recording.add("/R/joints", 0, joints({"A", "B"}, {odd, -0.0}));
  recording.add("/R/joints", ms, joints({"A", "B"}, {odd, -0.0}));  // read on the fast path
  const Trace trace = recording.load();
  const TraceChannel& channel = trace.channels()[0];
  for (const std::size_t row : {0, 1}) {
    EXPECT_EQ(channel.bits(row, 0), 0x7ff0000000000123u);
    EXPECT_EQ(channel.bits(row, 1), 0x8000000000000000u);
  }
  EXPECT_THROW(static_cast<void>(trace.integers("R/A/q")), std::invalid_argument);
}

TEST(Trace, FollowsJointsThatChangePlaces) {
  Recording recording;
  recording.add("/R/joints", 0, joints({"A", "B"}, {1, 2}));
  recording.add("/R/joints", 1, joints({"B", "A"}, {20, 10}));
  recording.add("/R/joints", 2, joints({"B", "A"}, {200, 100}));
  recording.add("/R/joints", 3, joints({"C"}, {5}));
  const Trace trace = recording.load();
  EXPECT_THAT(trace.values("R/A/q"), ElementsAre(1, 10, 100, testing::IsNan()));
  EXPECT_THAT(trace.values("R/B/q"), ElementsAre(2, 20, 200, testing::IsNan()));
  EXPECT_THAT(trace.values("R/C/q"), ElementsAre(testing::IsNan(), testing::IsNan(), testing::IsNan(), 5));
}

TEST(Trace, TakesJointsThatComeTwiceAndArraysOfOtherLengths) {
  Recording recording;
  recording.add("/R/joints", 0, joints({"A", "A"}, {1, 2}));
  recording.add("/R/joints", 1, joints({"A", "A"}, {3, 4}));
  recording.add("/S/joints", 0, joints({"A"}, {1, 2}));
  const Trace trace = recording.load();
  EXPECT_THAT(trace.values("R/A/q"), ElementsAre(2, 4));
  EXPECT_EQ(trace.last("S/1/q"), 2) << "a joint without a name goes by its number";
}

TEST(Trace, TellsSeriesOfTheSameNameApart) {
  Recording recording;
  recording.add("/R/left", 0, msg::DeviceState{{}, {1}});
  recording.add("/R/right", 0, msg::DeviceState{{}, {2}});
  const Trace trace = recording.load();
  EXPECT_EQ(trace.last("R/values/0"), 1);
  EXPECT_EQ(trace.last("R/right/values/0"), 2);
}

TEST(Trace, AnswersQuestionsAboutASeries) {
  Recording recording;
  for (std::uint64_t i = 0; i < 5; ++i) {
    recording.add("/R/joints", i * 100 * ms, joints({"A"}, {std::array{3.0, 1.0, 4.0, 1.0, 5.0}[i]}));
  }
  const Trace trace = recording.load();
  EXPECT_EQ(trace.first("R/A/q"), 3);
  EXPECT_EQ(trace.last("R/A/q"), 5);
  EXPECT_EQ(trace.min("R/A/q"), 1);
  EXPECT_EQ(trace.max("R/A/q"), 5);
  EXPECT_EQ(trace.mean("R/A/q", 0.1, 0.3), 2.5) << "from is in, until is out";
  EXPECT_EQ(trace.at("R/A/q", 0.2), 4);
  EXPECT_EQ(trace.at("R/A/q", 0.299), 4) << "a value holds until the next";
  EXPECT_EQ(trace.at("R/A/q", 99), 5);
  EXPECT_THAT(trace.times("R/A/q"), ElementsAre(0.0, 0.1, 0.2, testing::DoubleEq(0.3), 0.4));
  EXPECT_DOUBLE_EQ(trace.duration(), 0.4);
}

TEST(Trace, LetsNoComparisonHoldByANan) {
  Recording recording;
  for (const double q : {1.0, not_a_number, 2.0}) recording.add("/R/joints", 0, joints({"A"}, {q}));
  const Trace trace = recording.load();
  EXPECT_TRUE(std::isnan(trace.min("R/A/q")));
  EXPECT_TRUE(std::isnan(trace.max("R/A/q")));
  EXPECT_TRUE(std::isnan(trace.mean("R/A/q", 0, 1)));
}

TEST(Trace, NamesTheNearestSeriesWhenOneIsUnknown) {
  Recording recording;
  recording.add("/SR1/joints", 0, joints({"RLEG_KNEE", "LLEG_KNEE", "CHEST"}, {1, 2, 3}));
  const Trace trace = recording.load();
  const std::string message = message_of([&] { trace.last("SR1/RLEG_KNE/q"); });
  EXPECT_THAT(message, HasSubstr("no series \"SR1/RLEG_KNE/q\"; the nearest are SR1/RLEG_KNEE/q, SR1/LLEG_KNEE/q"));
  EXPECT_THAT(message_of([&] { trace.at("SR1/CHEST/q", -1.0); }), HasSubstr("nothing thrown"));
  EXPECT_THAT(message_of([&] { trace.mean("SR1/CHEST/q", 5, 6); }), HasSubstr("no sample from 5 s until 6 s"));
}

TEST(Trace, KeepsPicturesInTheFile) {
  msg::CompressedImage picture;
  picture.format = "png";
  Recording recording;
  for (const std::uint8_t byte : {1, 2}) {
    picture.data = {byte};
    recording.add("/R/Camera/image", byte * ms, picture);
  }
  const Trace trace = recording.load();
  EXPECT_TRUE(trace.series().empty());
  const TraceChannel& channel = *trace.find_channel("/R/Camera/image");
  EXPECT_EQ(channel.type, "sensor_msgs/msg/CompressedImage");
  EXPECT_THAT(channel.times, ElementsAre(1 * ms, 2 * ms));
  for (const std::size_t i : {1, 0}) {
    const auto payload = trace.payload(channel, i);
    ASSERT_TRUE(payload);
    CdrReader reader(*payload);
    EXPECT_TRUE(msg::decode(reader, picture));
    EXPECT_THAT(picture.data, ElementsAre(i + 1));
  }
}

TEST(Trace, DecodesEvents) {
  Recording recording;
  recording.add("/events", 5 * ms, msg::Event{{0, 5}, 5, "error", "SR1/SR1Minimum", "wrote NaN into RLEG_KNEE/u"});
  const Trace trace = recording.load();
  ASSERT_EQ(trace.events().size(), 1u);
  EXPECT_EQ(trace.events()[0].tick, 5);
  EXPECT_EQ(trace.events()[0].text, "wrote NaN into RLEG_KNEE/u");
}

TEST(Trace, DecodesChangesOfContact) {
  Recording recording;
  recording.add("/contacts", 5 * ms, msg::ContactChange{{0, 5}, 5, "SR1/RLEG_ANKLE_R", "Floor/Box", true});
  const Trace trace = recording.load();
  EXPECT_TRUE(trace.series().empty());
  ASSERT_EQ(trace.contact_changes().size(), 1u);
  EXPECT_EQ(trace.contact_changes()[0].link, "SR1/RLEG_ANKLE_R");
  EXPECT_EQ(trace.contact_changes()[0].other, "Floor/Box");
  EXPECT_TRUE(trace.contact_changes()[0].begins);
}

TEST(Trace, LoadsInPiecesThatEndWithATick) {
  Recording recording;
  for (std::uint64_t i = 0; i < 3; ++i) {
    recording.add("/SR1/joints", i * ms, joints({"KNEE"}, {0.1 * static_cast<double>(i)}));
    if (i == 1) recording.add("/events", i * ms, msg::Event{{0, 1}, 1, "note", "SR1", "hello"});
    msg::Tick tick;
    tick.tick = static_cast<std::int64_t>(i);
    recording.add("/tick", i * ms, tick);
  }
  ASSERT_TRUE(recording.writer().close());
  std::vector<double> knee;
  std::vector<std::size_t> events;
  const auto last = Trace::load_in_pieces(
      recording.file().path(),
      [&](const Trace& piece) {
        EXPECT_EQ(names_of(piece), names_of(recording.load()));
        const auto values = piece.values("SR1/KNEE/q");
        EXPECT_EQ(piece.values("tick"), values.empty() ? values : std::vector{static_cast<double>(knee.size())});
        knee.insert(knee.end(), values.begin(), values.end());
        events.push_back(piece.events().size());
      },
      1);
  ASSERT_TRUE(last) << to_string(last.errors());
  EXPECT_THAT(knee, ElementsAre(0.0, 0.1, 0.2));
  EXPECT_THAT(events, ElementsAre(0u, 1u, 0u, 0u)) << "a piece for each tick, and what was left: nothing";
  EXPECT_EQ(last->series().size(), recording.load().series().size());
  ASSERT_EQ(last->events().size(), 1u) << "read again from the file";
  EXPECT_EQ(last->events()[0].text, "hello");
}

/// The messages of a trace in memory, and of one that left them in its file.
TEST(EventStream, ReadsMessagesInTheOrderOfTime) {
  Recording recording;
  const std::vector<std::uint64_t> times{3, 1, 2, 1};
  for (std::size_t i = 0; i < times.size(); ++i)
    recording.add("/events", times[i] * ms,
                  msg::Event{msg::Time::from_ns(times[i] * ms), static_cast<std::int64_t>(times[i]), "note", "SR1",
                             std::to_string(i)});
  const Trace whole = recording.load();
  const auto pieces = Trace::load_in_pieces(
      recording.file().path(), [](const Trace&) {}, 1);
  ASSERT_TRUE(pieces);
  for (const Trace* trace : {&whole, &*pieces}) {
    std::vector<std::string> texts;
    EventStream stream(*trace);
    while (const msg::Event* event = stream.next()) texts.push_back(event->text);
    EXPECT_THAT(texts, ElementsAre("1", "3", "2", "0"));
  }
}

TEST(Trace, KnowsChannelsAttachmentsAndMetadata) {
  Recording recording;
  recording.add("/R/joints", 0, joints({"A"}, {1}));
  ASSERT_TRUE(recording.writer().add_attachment("scenario.yaml", "application/yaml", bytes_of("rehearse: 1\n")));
  ASSERT_TRUE(recording.writer().add_metadata("provenance", {{"seed", "7"}}));
  const Trace trace = recording.load();
  EXPECT_EQ(trace.find_channel("/R/joints")->metadata.at("unit"), "rad");
  EXPECT_EQ(trace.find_channel("/none"), nullptr);
  EXPECT_EQ(text_of(trace.find_attachment("scenario.yaml")->data), "rehearse: 1\n");
  EXPECT_EQ(trace.find_attachment("none"), nullptr);
  EXPECT_EQ(trace.find_metadata("provenance")->at("seed"), "7");
  EXPECT_EQ(trace.find_metadata("none"), nullptr);
}

TEST(Trace, OutlivesTheOneThatItWasCopiedFrom) {
  std::optional<Trace> copy;
  {
    Recording recording;
    ASSERT_TRUE(recording.writer().add_attachment("a", "text/plain", bytes_of("still here")));
    const Trace trace = recording.load();
    copy = trace;
  }
  EXPECT_EQ(text_of(copy->find_attachment("a")->data), "still here");
}

TEST(Trace, RefusesADamagedFileUnlessToldOtherwise) {
  Recording recording;
  recording.add("/R/joints", 0, joints({"A"}, {1}));
  ASSERT_TRUE(recording.writer().flush());
  std::filesystem::copy_file(recording.file().path(), recording.file().path().string() + ".cut");
  const std::string cut = recording.file().path().string() + ".cut";
  const auto refused = Trace::load(cut);
  const auto tolerated = Trace::load(cut, Trace::Damage::tolerate);
  std::filesystem::remove(cut);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.errors()[0].message, HasSubstr("truncated"));
  ASSERT_TRUE(tolerated);
  EXPECT_EQ(tolerated->last("R/A/q"), 1);
  EXPECT_EQ(tolerated->damage().size(), 1u);
}

TEST(Trace, NamesAMessageThatIsNotWhatItsSchemaSays) {
  Recording recording;
  recording.add("/R/joints", 0, joints({"A"}, {1}));
  recording.raw(1, 1, bytes_of("not CDR at all"));
  recording.add("/R/joints", 2, joints({"A"}, {2}));
  const auto refused = recording.try_load();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.errors()[0].message,
              HasSubstr("topic /R/joints: message 1 isn't a valid sensor_msgs/msg/JointState"));
  const auto tolerated = Trace::load(recording.file().path(), Trace::Damage::tolerate);
  ASSERT_TRUE(tolerated);
  EXPECT_THAT(tolerated->values("R/A/q"), ElementsAre(1, 2));
}

TEST(Trace, LoadsAChannelWhoseSchemaIsWrongAsBytes) {
  Recording recording;
  const auto schema = recording.writer().add_schema("a/msg/A", "ros2msg", "Unknown x\n");
  const auto channel = recording.writer().add_channel(schema, "/a", "cdr");
  recording.raw(channel, 0, bytes_of("x"));
  const Trace trace = recording.load();
  EXPECT_TRUE(trace.find_channel("/a")->columns.empty());
  EXPECT_EQ(text_of(*trace.payload(*trace.find_channel("/a"), 0)), "x");
}

TEST(Trace, LoadsAChannelThatItCannotDecode) {
  Recording recording;
  const auto channel = recording.writer().add_channel(0, "/custom", "json");
  recording.raw(channel, 0, bytes_of("{}"));
  const Trace trace = recording.load();
  EXPECT_EQ(text_of(*trace.payload(*trace.find_channel("/custom"), 0)), "{}");
}
