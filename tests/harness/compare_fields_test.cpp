// Two files are equal if their messages are equal: any difference in a message is found and reported.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/compare.h>

#include <numbers>

#include "core/ros2msg/ros2msg.h"
#include "small_traces.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;
using Payload = std::vector<std::byte>;

template <class T>
Payload payload_of(const T& message) {
  CdrWriter cdr;
  msg::encode(message, cdr);
  return {cdr.bytes().begin(), cdr.bytes().end()};
}

/// Files of three messages of one type, a millisecond apart.
class TwoFiles {
 public:
  TwoFiles(std::string topic, std::string type, std::string schema)
      : topic_(std::move(topic)), type_(std::move(type)), schema_(std::move(schema)) {}

  template <class T>
  static TwoFiles of(std::string topic) {
    return TwoFiles(std::move(topic), std::string(T::type_name), msg::schema_text<T>());
  }

  Trace load(const std::string& name, const std::vector<Payload>& messages,
             const std::vector<std::uint64_t>& times = {0, 1'000'000, 2'000'000}) const {
    auto writer = *mcap::Writer::create(folder_ / name);
    const std::uint16_t channel = writer->add_channel(writer->add_schema(type_, "ros2msg", schema_), topic_, "cdr");
    for (std::size_t i = 0; i < messages.size(); ++i)
      EXPECT_TRUE(writer->write(channel, times[i], times[i], messages[i]));
    EXPECT_TRUE(writer->close());
    auto trace = Trace::load(folder_ / name);
    EXPECT_TRUE(trace) << to_string(trace.errors());
    return *trace;
  }
  Comparison compared(const Payload& golden, const Payload& actual,
                      const std::vector<ToleranceRule>& rules = {}) const {
    return compare(load("golden.mcap", {golden, golden, golden}), load("actual.mcap", {golden, actual, golden}), rules);
  }
  const std::string& schema() const { return schema_; }
  const std::string& type() const { return type_; }

 private:
  TemporaryFolder folder_;
  std::string topic_, type_, schema_;
};

/// The place of a value in a payload.
struct Place {
  std::string path;
  std::size_t begin = 0, size = 0;
};

std::vector<Place> places_in(const Payload& payload, const TwoFiles& files) {
  ros2msg::Decoder decoder(*ros2msg::Schema::parse(files.type(), files.schema()));
  std::vector<Place> places;
  decoder.decode(payload, [&](const ros2msg::Value& value) {
    std::span<const std::byte> bytes = value.is_number() ? value.bytes : value.blob;
    if (value.kind == ros2msg::Value::Kind::text) bytes = std::as_bytes(std::span(value.text));
    if (bytes.empty()) return;
    places.push_back({std::string(value.path), static_cast<std::size_t>(bytes.data() - payload.data()), bytes.size()});
  });
  return places;
}

/// For each value of the message: changing only its last bit makes two files differ, and the finding states the place.
template <class T>
void every_field_is_compared(const std::string& topic, const T& message) {
  const TwoFiles files = TwoFiles::of<T>(topic);
  const Payload golden = payload_of(message);
  EXPECT_TRUE(files.compared(golden, golden).equal);
  const std::vector<Place> places = places_in(golden, files);
  EXPECT_FALSE(places.empty());
  for (const Place& place : places) {
    Payload actual = golden;
    actual[place.begin] ^= std::byte{1};
    const Comparison found = files.compared(golden, actual);
    EXPECT_FALSE(found.equal) << T::type_name << " " << place.path;
    ASSERT_TRUE(found.first_bit) << T::type_name << " " << place.path;
    EXPECT_EQ(found.first_bit->channel, topic);
    EXPECT_LE(found.first_bit->time, 0.001) << T::type_name << " " << place.path;
    EXPECT_FALSE(found.first_bit->element.empty() && found.first_bit->note.empty()) << place.path;
    EXPECT_FALSE(table(found).empty()) << place.path;
  }
}

msg::Header header() { return {msg::Time::from_ns(7'000'000), "base"}; }

TEST(CompareFields, FindsAnyValueOfAnyTypeThatHasATableOfItsOwn) {
  every_field_is_compared("/R/joints", msg::JointState{header(), {"A", "B"}, {1, 2}, {3, 4}, {5, 6}});
  every_field_is_compared("/R/accelerations", msg::JointAccelerations{header(), {"A", "B"}, {1, 2}});
  every_field_is_compared("/joy", msg::Joy{header(), {0.5F, 1.0F}, {0, 1}});
  every_field_is_compared("/R/A/pose", msg::PoseStamped{header(), {{1, 2, 3}, {0, 0, 0, 1}}});
  every_field_is_compared("/R/A/twist", msg::TwistStamped{header(), {{1, 2, 3}, {4, 5, 6}}});
  every_field_is_compared("/R/A/accel", msg::AccelStamped{header(), {{1, 2, 3}, {4, 5, 6}}});
  every_field_is_compared("/R/A/wrench", msg::WrenchStamped{header(), {{1, 2, 3}, {4, 5, 6}}});
  every_field_is_compared("/R/A/imu", msg::Imu{header(), {}, {1, 2}, {1, 2, 3}, {3, 4}, {5, 6, 7}, {8, 9}});
  every_field_is_compared("/R/A/scan", msg::LaserScan{header(), -1, 1, 0.5F, 0, 1, 0, 9, {1, 2}, {7, 8}});
  every_field_is_compared("/R/A/contact", msg::ContactForce{header(), 2, {1, 2, 3}});
  every_field_is_compared("/R/A/contacts", msg::Contacts{header(), {{{1, 2, 3}, {0, 0, 1}, {4, 5, 6}, {7, 8, 9}, 1}}});
  every_field_is_compared("/tf", msg::TFMessage{{{header(), "link", {{1, 2, 3}, {0, 0, 0, 1}}}}});
  every_field_is_compared("/tick", msg::Tick{{0, 7'000'000}, 5, 6, 7, 8, {true, false}});
}

TEST(CompareFields, FindsAnyValueOfTypesWithoutATableOfTheirOwn) {
  every_field_is_compared(
      "/R/Eye/camera_info",
      msg::CameraInfo{header(), 4, 6, "plumb_bob", {1, 2}, {3}, {4}, {5}, 1, 1, {1, 2, 3, 4, true}});
  every_field_is_compared("/R/Eye/image", msg::CompressedImage{header(), "png", {1, 2, 3}});
  every_field_is_compared("/R/Eye/image",
                          msg::CompressedImage{header(), "png", encode_png({4, 2, std::vector<std::uint8_t>(24, 9)})});
  every_field_is_compared("/R/Eye/depth", msg::Image{header(), 1, 2, "rgb8", 0, 6, {1, 2, 3, 4, 5, 6}});
  every_field_is_compared("/R/Lamp/state", msg::DeviceState{header(), {1, 2}});
  every_field_is_compared("/R/Lamp/phase", msg::Float64{3});
  every_field_is_compared("/events", msg::Event{{0, 1'000'000}, 1, "note", "R/C", "hello"});
  every_field_is_compared("/contacts", msg::ContactChange{{0, 1'000'000}, 1, "R/FOOT", "Floor/Floor", true});
}

TEST(CompareFields, FindsAnyValueOfAPointCloud) {
  msg::PointCloud2 cloud;
  cloud.header = header();
  for (const char* name : {"x", "range", "tag"})
    cloud.fields.push_back({name, static_cast<std::uint32_t>(4 * cloud.fields.size()), msg::PointField::float32, 1});
  cloud.fields.back().datatype = 6;  // uint32
  cloud.point_step = 12;
  cloud.width = 2;
  cloud.height = 1;
  cloud.row_step = 24;
  cloud.data.assign(24, 1);
  every_field_is_compared("/R/Laser/points", cloud);
  const TwoFiles files = TwoFiles::of<msg::PointCloud2>("/R/Laser/points");
  const Payload golden = payload_of(cloud);
  for (const auto& [byte, element] : {std::pair(0, "points/0/x"), std::pair(16, "ranges/1"), std::pair(20, "data")}) {
    msg::PointCloud2 other = cloud;
    other.data[static_cast<std::size_t>(byte)] ^= 0x1;
    const Comparison found = files.compared(golden, payload_of(other));
    ASSERT_TRUE(found.first_bit);
    EXPECT_EQ(found.first_bit->element, element);
    EXPECT_EQ(found.differing, 1) << element;
  }
}

TEST(CompareFields, NamesTheFieldAndBothTexts) {
  const TwoFiles files = TwoFiles::of<msg::Imu>("/R/A/imu");
  msg::Imu golden;
  golden.header = header();
  msg::Imu actual = golden;
  actual.header.frame_id = "world";
  EXPECT_THAT(verdict(files.compared(payload_of(golden), payload_of(actual))),
              HasSubstr("/R/A/imu header/frame_id: is \"world\", expected \"base\""));
  actual = golden;
  actual.orientation.x = 0.25;
  EXPECT_THAT(verdict(files.compared(payload_of(golden), payload_of(actual))),
              HasSubstr("/R/A/imu orientation/x is 0.25, expected 0: off by 0.25"));
}

TEST(CompareFields, TakesAStampThatIsTheLogTimeForAnotherThanOneThatIsZero) {
  const TwoFiles files = TwoFiles::of<msg::ContactForce>("/R/A/contact");
  const auto stamped = [](std::uint64_t time) {
    return payload_of(msg::ContactForce{{msg::Time::from_ns(time), "base"}, 1, {}});
  };
  const Trace golden = files.load("golden.mcap", {stamped(0), stamped(1'000'000), stamped(2'000'000)});
  const Trace actual = files.load("actual.mcap", {stamped(0), stamped(0), stamped(2'000'000)});
  const Comparison found = compare(golden, actual, {});
  EXPECT_EQ(found.differing, 1);
  EXPECT_THAT(verdict(found), HasSubstr("header/stamp is 0 s, expected 0.001 s: off by 0.001 s"));
}

TEST(CompareFields, JudgesANumberWithoutAColumnByTheRuleThatNamesIt) {
  const TwoFiles files = TwoFiles::of<msg::LaserScan>("/R/A/scan");
  msg::LaserScan golden;
  golden.header = header();
  golden.intensities = {1.0F, 2.0F};
  msg::LaserScan actual = golden;
  actual.intensities[1] = 2.5F;
  ToleranceRule rule;
  rule.channel = "R/A/intensities/*";
  rule.atol = 1.0;
  const Comparison found = files.compared(payload_of(golden), payload_of(actual), {rule});
  EXPECT_FALSE(found.equal);
  EXPECT_TRUE(found.within);
  EXPECT_EQ(found.differing, 1);
  EXPECT_FALSE(files.compared(payload_of(golden), payload_of(actual)).within);
}

TEST(CompareFields, NamesAnArrayThatIsShorter) {
  const TwoFiles files = TwoFiles::of<msg::DeviceState>("/R/Lamp/state");
  const Comparison found =
      files.compared(payload_of(msg::DeviceState{header(), {1, 2}}), payload_of(msg::DeviceState{header(), {1}}));
  EXPECT_FALSE(found.within);
  EXPECT_EQ(found.first->element, "values/1");
}

TEST(CompareFields, FindsASecondJointOfTheSameName) {
  const TwoFiles files = TwoFiles::of<msg::JointState>("/R/joints");
  const Comparison found = files.compared(payload_of(msg::JointState{header(), {"A", "A"}, {1, 2}, {}, {}}),
                                          payload_of(msg::JointState{header(), {"A", "A"}, {5, 2}, {}, {}}));
  EXPECT_FALSE(found.equal);
}

TEST(CompareFields, SaysThatAnotherEncodingOfTheSameValuesIsNotTheSameBytes) {
  const TwoFiles files = TwoFiles::of<msg::PoseStamped>("/R/A/pose");
  const Payload golden = payload_of(msg::PoseStamped{header(), {{1, 2, 3}, {0, 0, 0, 1}}});
  Payload longer = golden;
  longer.push_back(std::byte{7});
  const Comparison found = files.compared(golden, longer);
  EXPECT_FALSE(found.equal);
  EXPECT_TRUE(found.within);
  EXPECT_THAT(found.first_bit->note, HasSubstr("bytes differ from"));
}

TEST(CompareFields, TellsAPictureOfTheSamePixelsInOtherBytes) {
  const TwoFiles files = TwoFiles::of<msg::CompressedImage>("/R/Eye/image");
  msg::CompressedImage golden{header(), "png", encode_png({4, 2, std::vector<std::uint8_t>(24, 9)})};
  msg::CompressedImage actual = golden;
  actual.data.push_back(0);  // behind the picture's end
  const Comparison found = files.compared(payload_of(golden), payload_of(actual));
  EXPECT_FALSE(found.equal);
  EXPECT_TRUE(found.within);
}

TEST(CompareFields, ComparesIntegersAsIntegers) {
  const std::int64_t large = (std::int64_t{1} << 53) + 1;
  const TwoFiles files("/R/counter", "std_msgs/msg/Int64", "int64 data\n");
  const auto number = [](std::int64_t value) {
    CdrWriter cdr;
    cdr.put(value);
    return Payload(cdr.bytes().begin(), cdr.bytes().end());
  };
  const Comparison found = files.compared(number(large), number(large - 1));
  EXPECT_FALSE(found.within);
  EXPECT_EQ(found.first->difference, 1.0);
  EXPECT_THAT(verdict(found), HasSubstr("is 9007199254740992, expected 9007199254740993: off by 1"));
  EXPECT_THAT(verdict(files.compared(number(-3), number(4))), HasSubstr("is 4, expected -3: off by 7"));
}

TEST(CompareFields, MatchesMessagesWhateverTheirOrderInTheFile) {
  const TwoFiles files = TwoFiles::of<msg::ContactForce>("/R/A/contact");
  const Payload a = payload_of(msg::ContactForce{header(), 1, {}}), b = payload_of(msg::ContactForce{header(), 2, {}});
  const Payload c = payload_of(msg::ContactForce{{{}, "other"}, 3, {}});
  const Trace golden = files.load("golden.mcap", {a, b, c}, {10, 20, 30});
  const Trace actual = files.load("actual.mcap", {c, a, b}, {30, 10, 20});
  EXPECT_TRUE(compare(golden, actual, {}).equal) << verdict(compare(golden, actual, {}));
  EXPECT_EQ(compare(golden, actual, {}).values, 12);
  const Trace swapped = files.load("swapped.mcap", {c, b, a}, {30, 10, 20});
  EXPECT_FALSE(compare(golden, swapped, {}).within);
}

TEST(CompareFields, TakesACameraInfoWithinALastDigit) {
  const TwoFiles files = TwoFiles::of<msg::CameraInfo>("/R/Eye/camera_info");
  msg::CameraInfo golden;
  golden.k = {300.0 * std::numbers::sqrt2};
  msg::CameraInfo actual = golden;
  actual.k[0] += 12 * 0x1p-44;  // 12 ULPs
  EXPECT_TRUE(files.compared(payload_of(golden), payload_of(actual)).within);
  actual.k[0] = golden.k[0] + 1e-6;
  EXPECT_FALSE(files.compared(payload_of(golden), payload_of(actual)).within);
}

}  // namespace
}  // namespace rehearse
