// The verbs on robots' logs: map, doctor on bags, diff --align, export for viewers.
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/trace.h>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "../harness/bag/bag_files.h"
#include "command.h"
#include "mixed_file.h"

namespace rehearse::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class Logs : public Command {
 protected:
  /// A second of a joint state at 100 Hz whose clock is `offset` ns ahead, with `jitter` ns between neighbours. The
  /// stamps are the log times.
  void joints(const std::string& name, std::uint64_t offset, std::uint64_t jitter, double amplitude = 1.0) const {
    auto writer = std::move(*mcap::Writer::create(folder() / name));
    TopicWriter topic(*writer, "/joint_states", "cdr", add_schema<msg::JointState>(*writer));
    for (std::uint64_t i = 0; i < 100; ++i) {
      const std::uint64_t time = 1'000'000'000 + i * 10'000'000;
      const double seconds = static_cast<double>(i) * 0.01;
      const double q = amplitude * std::sin(9.0 * seconds * seconds);
      const std::uint64_t logged = time + offset + (i % 2) * jitter;
      topic.put(logged, msg::JointState{{msg::Time::from_ns(logged), "base"}, {"KNEE"}, {q}, {}, {}});
    }
    ASSERT_TRUE(writer->close());
  }
  struct Drift {
    std::int64_t ahead = 0;  // at the beginning of the motion [ns]
    double ppm = 0.0;        // how much the clock is fast
    int begin = 0;           // index of the first message
    int wrong_stamp = -1;    // index of a message that is a third of a second late
    double noise = 0.0;      // amplitude of the values' noise
  };
  /// Ten seconds of a motion at 500 Hz, by a clock that drifts.
  void drifting(const std::string& name, const Drift& drift, int end = 5000) const {
    auto writer = std::move(*mcap::Writer::create(folder() / name));
    TopicWriter topic(*writer, "/joint_states", "cdr", add_schema<msg::JointState>(*writer));
    for (int i = drift.begin; i < end; ++i) {
      const std::int64_t time = std::int64_t{i} * 2'000'000;
      const double seconds = static_cast<double>(time) * 1e-9;
      const double q = std::sin(seconds * seconds) + drift.noise * std::sin(1000.0 * static_cast<double>(i));
      const std::int64_t late = i == drift.wrong_stamp ? 333'333'333 : 0;
      const auto logged = static_cast<std::uint64_t>(2'000'000'000 + drift.ahead + late + time +
                                                     std::llround(static_cast<double>(time) * drift.ppm * 1e-6));
      topic.put(logged, msg::JointState{{msg::Time::from_ns(logged), "base"}, {"KNEE"}, {q}, {}, {}});
    }
    ASSERT_TRUE(writer->close());
  }
  fs::path golden(const std::string& name) const { return fixtures.parent_path() / "golden" / name; }
};

TEST_F(Logs, AlignedByTheirStartAreEqual) {
  joints("a.mcap", 0, 0);
  joints("b.mcap", 5'000'000'000, 0);
  EXPECT_EQ(rehearse({"diff", "a.mcap", "b.mcap"}).status, 1);
  const Outcome outcome = done({"diff", "a.mcap", "b.mcap", "--align", "start"});
  EXPECT_THAT(outcome.out,
              HasSubstr("aligned by start: the times of b.mcap + -5.000000000 s; 100 messages matched, 0 s "
                        "apart (median; at most 0 s)\n"));
  EXPECT_THAT(outcome.out, HasSubstr("equal"));
}

TEST_F(Logs, AlignedByASeriesMatchMessagesInSpiteOfJitter) {
  joints("a.mcap", 0, 0);
  joints("b.mcap", 7'123'456'789, 300'000);
  const auto json = done({"diff", "a.mcap", "b.mcap", "--align", "KNEE/q", "--json"}).json();
  EXPECT_NEAR(json["alignment"]["offset"].get<double>(), -7.123456789, 2e-4);
  EXPECT_GT(json["alignment"]["correlation"].get<double>(), 0.99);
  EXPECT_EQ(json["alignment"]["matched"], 100);
  EXPECT_EQ(json["alignment"]["lone"], nlohmann::json::array({0, 0}));
  EXPECT_LT(json["alignment"]["largest_distance"].get<double>(), 5e-4);
  EXPECT_TRUE(json["equal"].get<bool>());
}

TEST_F(Logs, AFastClockIsStatedAndCorrected) {
  drifting("a.mcap", {});
  drifting("b.mcap", {.ahead = 520'000'000, .ppm = 200});
  for (const std::string by : {"start", "KNEE/q"}) {
    const Outcome outcome = done({"diff", "a.mcap", "b.mcap", "--align", by});
    EXPECT_THAT(
        outcome.out,
        HasSubstr("the clock of b.mcap is 0.52 s ahead at its start and 200 ppm fast (by 5000 messages of equal "
                  "content); 5000 messages matched, 0 s apart (median; at most 0 s)\n"
                  "equal bit for bit: 5000 values, 0 pictures\n"));
  }
}

TEST_F(Logs, ASlowClockIsStatedInJson) {
  drifting("a.mcap", {});
  drifting("b.mcap", {.ahead = -520'000'000, .ppm = -50});
  EXPECT_THAT(done({"diff", "a.mcap", "b.mcap", "--align", "start"}).out,
              HasSubstr("the clock of b.mcap is 0.52 s behind at its start and 50 ppm slow ("));
  const auto json = done({"diff", "a.mcap", "b.mcap", "--align", "start", "--json"}).json();
  EXPECT_NEAR(json["alignment"]["drift"].get<double>(), -50, 1e-3);
  EXPECT_NEAR(json["alignment"]["offset"].get<double>(), 0.52, 1e-8);
  drifting("c.mcap", {.ahead = -520'000'000});
  EXPECT_TRUE(done({"diff", "a.mcap", "c.mcap", "--align", "start", "--json"}).json()["alignment"]["drift"].is_null());
}

TEST_F(Logs, AWrongStampMovesNoEstimate) {
  drifting("a.mcap", {});
  drifting("b.mcap", {.ahead = 520'000'000, .ppm = 200, .wrong_stamp = 2500});
  for (const std::string by : {"start", "KNEE/q"}) {
    const auto json = rehearse({"diff", "a.mcap", "b.mcap", "--align", by, "--json"}).json();
    EXPECT_NEAR(json["alignment"]["drift"].get<double>(), 200, 1e-3) << by;
    EXPECT_NEAR(json["alignment"]["offset"].get<double>(), -0.52, 1e-8) << by;
    EXPECT_LE(json["beyond"], 1) << by;
  }
}

TEST_F(Logs, ADriftIsFoundInLogsOfDifferentStartAndLength) {
  drifting("a.mcap", {});
  drifting("b.mcap", {.ahead = 520'000'000, .ppm = 200, .begin = 1000}, 6000);
  for (const std::string by : {"start", "KNEE/q"}) {
    const auto json = rehearse({"diff", "a.mcap", "b.mcap", "--align", by, "--json"}).json();
    EXPECT_NEAR(json["alignment"]["offset"].get<double>(), -0.5204, 1e-8) << by;
    EXPECT_EQ(json["alignment"]["matched"], 4000) << by;
    EXPECT_EQ(json["differing"], 0) << by;
  }
}

TEST_F(Logs, ADriftIsFoundByTheOrderOfMessagesWithOtherValues) {
  drifting("a.mcap", {});
  drifting("b.mcap", {.ahead = 520'000'000, .ppm = 400, .wrong_stamp = 100, .noise = 1e-5});
  for (const std::string by : {"start", "KNEE/q"}) {
    const auto json = rehearse({"diff", "a.mcap", "b.mcap", "--align", by, "--json"}).json();
    EXPECT_NEAR(json["alignment"]["drift"].get<double>(), 400, 1) << by;
    EXPECT_NEAR(json["alignment"]["offset"].get<double>(), -0.52, 1e-5) << by;
    EXPECT_GE(json["alignment"]["matched"], 4998) << by;
  }
  EXPECT_THAT(rehearse({"diff", "a.mcap", "b.mcap", "--align", "start"}).out, HasSubstr(" messages in order); "));
}

TEST_F(Logs, AlignedOnesThatDifferDiffer) {
  joints("a.mcap", 0, 0);
  joints("b.mcap", 5'000'000'000, 0, 1.001);
  const Outcome outcome = rehearse({"diff", "a.mcap", "b.mcap", "--align", "start"});
  EXPECT_EQ(outcome.status, 1) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("KNEE"));
}

TEST_F(Logs, AlignmentByASeriesThatOneLacksIsRefused) {
  joints("a.mcap", 0, 0);
  joints("b.mcap", 0, 0);
  const Outcome outcome = rehearse({"diff", "a.mcap", "b.mcap", "--align", "KNE/q"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("a.mcap: error: it has no series 'KNE/q' ("));
}

TEST_F(Logs, DoctorComparesMetadataWithTheFiles) {
  const Outcome outcome = rehearse({"doctor", (fixtures / "broken/bag_wrong_counts").string()});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, HasSubstr("metadata.yaml:8: error: it states 2 messages, but the files have 1\n"));
  EXPECT_THAT(outcome.out,
              HasSubstr("metadata.yaml:10: error: it states 2 messages on '/chatter', but the files have 1"));
  EXPECT_THAT(outcome.out,
              HasSubstr("metadata.yaml:5: warning: it states a duration of 1000 ns, but the messages span 0 ns"));
}

TEST_F(Logs, DoctorEndsWithAnotherStatusForWarnings) {
  const Outcome outcome = rehearse({"doctor", (fixtures / "broken/bag_unknown_serialization.db3").string()});
  EXPECT_EQ(outcome.status, 4) << outcome.out << outcome.err;
  EXPECT_THAT(
      outcome.out,
      HasSubstr("bag_unknown_serialization.db3: warning: the messages on '/chatter' are serialized as 'protobuf'"));
}

TEST_F(Logs, ADatabaseWithADamagedPageIsSavedOnBothSidesOfIt) {
  {
    Database bag(folder() / "a.db3");
    bag.topic(1, "/joint_states", "sensor_msgs/msg/JointState");
    bag.run("BEGIN");
    for (std::int64_t i = 0; i < 6000; ++i) bag.message(1, i * 1'000'000, joint_state(0));
    bag.run("COMMIT");
  }
  done({"doctor", "a.db3"});
  zero_page(folder() / "a.db3", 0.3);
  const Outcome outcome = done({"recover", "a.db3", "-o", "saved.mcap"});
  const auto json = done({"recover", "a.db3", "-o", "saved.mcap", "--json"}).json();
  const int saved = json["messages"], lost = json["lost_messages"];
  EXPECT_GT(saved, 5900);
  EXPECT_EQ(saved + lost, 6000);
  EXPECT_EQ(json["loss_is_known"], true);
  EXPECT_EQ(json["whole"], false);
  const std::string damage = fmt::format("damaged: {} of its 6000 messages can't be read (rows ", lost);
  EXPECT_THAT(outcome.out, HasSubstr(fmt::format("saved {} messages, ", saved)));
  EXPECT_THAT(outcome.out, HasSubstr("from 0 s to 5.999 s\n  " + damage));
  EXPECT_THAT(outcome.out, HasSubstr(fmt::format("\n{} messages lost\n", lost)));
  EXPECT_THAT(outcome.out, Not(HasSubstr("aren't in it")));
  const Outcome doctor = rehearse({"doctor", "a.db3"});
  EXPECT_EQ(doctor.status, 1);
  EXPECT_THAT(doctor.out, HasSubstr("a.db3: error: " + damage));
}

TEST_F(Logs, DoctorWarnsOfAFolderWithoutMetadata) {
  fs::create_directory(folder() / "friday");
  joints("friday/friday_0.mcap", 0, 0);
  const Outcome outcome = rehearse({"doctor", "friday"});
  EXPECT_EQ(outcome.status, 4) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("friday: warning: it has no metadata.yaml (ros2 bag reindex makes it from the "));
  EXPECT_THAT(outcome.out, HasSubstr("friday/friday_0.mcap: no findings; "));
}

TEST_F(Logs, DoctorExaminesTheFolderOfAMetadataFile) {
  const Outcome outcome = rehearse({"doctor", (fixtures / "broken/bag_wrong_counts/metadata.yaml").string()});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, HasSubstr("metadata.yaml:8: error: it states 2 messages, but the files have 1\n"));
}

TEST_F(Logs, EventsOfServicesInADatabaseAreDecodedByTheDefinitionOfTheService) {
  CdrWriter event;
  event.put(std::uint8_t{1});  // info: type, stamp, client, sequence number
  event.put(std::int32_t{5});
  event.put(std::uint32_t{0});
  for (int i = 0; i < 16; ++i) event.put(std::uint8_t{0});
  event.put(std::int64_t{7});
  event.put(std::uint32_t{1});  // one request
  event.put(std::uint8_t{1});
  event.put(std::uint32_t{0});  // no response
  {
    Database bag(folder() / "a.db3");
    bag.topic(1, "/light/_service_event", "my_srvs/srv/Light_Event");
    bag.topic(2, "/lamp/_service_event", "my_srvs/srv/Light");
    bag.topic(3, "/other/_service_event", "my_srvs/srv/Other");
    bag.definition("my_srvs/srv/Light", "====\nSRV: my_srvs/srv/Light\nbool on\n---\nbool done\n");
    for (int topic = 1; topic <= 3; ++topic) bag.message(topic, topic, event.bytes());
  }
  for (const std::string topic : {"/light", "/lamp"}) {
    const auto message = done({"cat", "a.db3", "--json", "--topics", topic + "/_service_event"}).json()["message"];
    EXPECT_EQ(message["info"]["sequence_number"], 7) << topic;
    EXPECT_EQ(message["request"][0]["on"], true) << topic;
  }
  EXPECT_EQ(done({"info", "a.db3", "--json"}).json()["messages"], 3);
}

TEST_F(Logs, DoctorNotesTypesThatADatabaseDoesNotDefine) {
  {
    Database bag(folder() / "a.db3");
    bag.topic(1, "/light/_service_event", "my_srvs/srv/Light");
    bag.message(1, 5, joint_state(0));
  }
  EXPECT_THAT(done({"doctor", "a.db3"}).out,
              HasSubstr("a.db3: note: the messages on '/light/_service_event' are of the type "
                        "'my_srvs/srv/Light_Event', which it doesn't define: they can't be decoded\n"));
}

TEST_F(Logs, DoctorRefusesAFolderWithoutItsFiles) {
  const Outcome outcome = rehearse({"doctor", (fixtures / "broken/bag_missing_file").string()});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("metadata.yaml:17:7: error: it names the file 'bag_missing_file_0.mcap'"));
}

TEST_F(Logs, ADraftedMapReplaysARecordingBitForBit) {
  const std::string model = (fixtures / "models/tank.urdf").string(), log = golden("Tank.IsDrivenByJoystick.mcap");
  done({"map", log, "--model", model, "-o", "tank.map.yaml"});
  const std::string map = read_file(folder() / "tank.map.yaml");
  EXPECT_THAT(map, HasSubstr("time_step: 0.005"));
  EXPECT_THAT(map, HasSubstr("  - topic: /Tank/joints    # 4 of the model's 4 joints\n"));
  EXPECT_THAT(map, HasSubstr("  topic: /Tank/Driver/output/joints\n"));
  EXPECT_THAT(map, HasSubstr("info: /Tank/Eye/camera_info, device: Eye}    # by its name"));
  const Outcome replayed = rehearse(
      {"replay", log, "--controller", "TankController", "--model", model, "--map", "tank.map.yaml", "-o", "out.mcap"});
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_THAT(replayed.out, HasSubstr("the log's commands, bit for bit"));
  EXPECT_THAT(done({"doctor", "out.mcap"}).out, HasSubstr("no findings"));
  done({"report", "out.mcap", "-o", "out.html"});
  EXPECT_THAT(read_file(folder() / "out.html"), HasSubstr(R"("complete":true)"));
}

TEST_F(Logs, AMapOfAForeignLogSaysWhatItIsUnsureOf) {
  {
    auto writer = std::move(*mcap::Writer::create(folder() / "log.mcap"));
    TopicWriter states(*writer, "/joint_states", "cdr", add_schema<msg::JointState>(*writer));
    TopicWriter imu(*writer, "/imu/data", "cdr", add_schema<msg::Imu>(*writer));
    for (std::uint64_t i = 0; i < 20; ++i) {
      states.put(i * 2'000'000,
                 msg::JointState{{msg::Time::from_ns(i * 2'000'000), ""}, {"left_wheel_joint", "arm"}, {0, 0}, {}, {}});
      msg::Imu reading;
      reading.header.frame_id = "imu_link";
      imu.put(i * 2'000'000, reading);
    }
    ASSERT_TRUE(writer->close());
  }
  const std::string map = done({"map", "log.mcap", "--model", (fixtures / "models/scout.urdf").string()}).out;
  EXPECT_THAT(map, HasSubstr("time_step: 0.002    # [s]: the distance of the messages on /joint_states\n"));
  EXPECT_THAT(map, HasSubstr("left_wheel_joint: LEFT_WHEEL    # unsure"));
  EXPECT_THAT(map, HasSubstr("velocity: differentiate"));
  EXPECT_THAT(map, HasSubstr("# names without a joint of the model: arm\n"));
  EXPECT_THAT(map, HasSubstr("# joints without a source: RIGHT_WHEEL\n"));
}

TEST_F(Logs, AMapOfABodyHasItsJoints) {
  {
    auto writer = std::move(*mcap::Writer::create(folder() / "log.mcap"));
    TopicWriter states(*writer, "/joint_states", "cdr", add_schema<msg::JointState>(*writer));
    const std::vector<std::string> joints{"STEERING", "REAR_LEFT", "REAR_RIGHT"};
    for (std::uint64_t i = 0; i < 20; ++i)
      states.put(i * 5'000'000, msg::JointState{{msg::Time::from_ns(i * 5'000'000), ""}, joints, {0, 0, 0}, {}, {}});
    ASSERT_TRUE(writer->close());
  }
  const std::string map = done({"map", "log.mcap", "--model", (fixtures / "models/wagon.body").string()}).out;
  EXPECT_THAT(map, HasSubstr("body: Wagon\n"));
  EXPECT_THAT(map, HasSubstr("  - topic: /joint_states    # 3 of the model's 5 joints\n"));
}

TEST_F(Logs, AMapWithoutAJoyTakesATwist) {
  {
    auto writer = std::move(*mcap::Writer::create(folder() / "log.mcap"));
    TopicWriter velocities(*writer, "/cmd_vel", "cdr", add_schema<msg::TwistStamped>(*writer));
    velocities.put(0, msg::TwistStamped());
    ASSERT_TRUE(writer->close());
  }
  const std::string map = done({"map", "log.mcap", "--model", (fixtures / "models/tank.urdf").string()}).out;
  EXPECT_THAT(map, HasSubstr("joystick: /cmd_vel    # unsure: a Twist as axes 0 to 5, linear x, y, z and angular "));
}

TEST_F(Logs, AMapOfALogThatDoesNotFitIsRefused) {
  {
    auto writer = std::move(*mcap::Writer::create(folder() / "log.mcap"));
    TopicWriter topic(*writer, "/wrench", "cdr", add_schema<msg::WrenchStamped>(*writer));
    topic.put(0, msg::WrenchStamped());
    ASSERT_TRUE(writer->close());
  }
  const Outcome outcome = rehearse({"map", "log.mcap", "--model", (fixtures / "models/tank.urdf").string()});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("no topic of the log fits the model Tank (the log has /wrench)"));
}

TEST_F(Logs, AViewersFileHasTheRobotAndItsFrames) {
  const std::string run = golden("Tank.IsDrivenByJoystick.mcap");
  done({"export", run, "--viewer", "tank.mcap", "--layout", "tank.json", "--robot", "files"});
  const Outcome described = done({"cat", "tank.mcap", "--topics", "/robot_description", "--json"});
  EXPECT_THAT(described.json()["message"]["data"].get<std::string>(), HasSubstr("<link name=\"Tank/CHASSIS\""));
  EXPECT_EQ(described.json()["log_time"], 0);
  const Outcome frames = done({"cat", "tank.mcap", "--topics", "/tf_static"});
  EXPECT_THAT(frames.out, HasSubstr("child_frame_id=\"Tank/Eye\""));
  EXPECT_THAT(read_file(folder() / "files/scenario.yaml"), HasSubstr("\nrehearse: 1\n"));
  EXPECT_TRUE(exists("files/tank.urdf"));
  const auto layout = nlohmann::json::parse(read_file(folder() / "tank.json"));
  EXPECT_EQ(layout["configById"]["Image!camera1"]["imageMode"]["imageTopic"], "/Tank/Eye/image");
  const auto& robot = layout["configById"]["3D!robot"];
  EXPECT_EQ(robot["followTf"], "Tank/CHASSIS");
  EXPECT_EQ(robot["topics"]["/robot_description"]["visible"], true);
  EXPECT_EQ(robot["layers"]["/Floor/robot_description"]["topic"], "/Floor/robot_description");
  EXPECT_FALSE(robot["layers"].contains("/Tank/robot_description"));
  done({"doctor", "tank.mcap"});
}

TEST_F(Logs, ALayoutForPlotJugglerIsXml) {
  done({"export", golden("Tank.IsDrivenByJoystick.mcap"), "--layout", "tank.xml"});
  EXPECT_THAT(read_file(folder() / "tank.xml"), HasSubstr("<curve name=\"/Tank/joints/"));
  const Outcome other = rehearse({"export", golden("Tank.IsDrivenByJoystick.mcap"), "--layout", "tank.txt"});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("expected .json for Foxglove and Lichtblick, .xml for PlotJuggler"));
}

TEST_F(Logs, AnExportWithBytesHasThemInBase64) {
  {
    auto writer = std::move(*mcap::Writer::create(folder() / "log.mcap"));
    TopicWriter topic(*writer, "/camera/image", "cdr", add_schema<msg::CompressedImage>(*writer));
    topic.put(0, msg::CompressedImage{{{}, "eye"}, "png", {1, 2, 3}});
    ASSERT_TRUE(writer->close());
  }
  const Outcome without = done({"export", "log.mcap", "-o", "tables"});
  EXPECT_THAT(without.out, HasSubstr("left out of /camera/image: data\n"));
  EXPECT_EQ(read_file(folder() / "tables/camera_image.csv"),
            "time [s],header/stamp/sec,header/stamp/nanosec,header/frame_id,format\n0.000000000,0,0,eye,png\n");
  done({"export", "log.mcap", "-o", "tables", "--bytes"});
  EXPECT_EQ(
      read_file(folder() / "tables/camera_image.csv"),
      "time [s],header/stamp/sec,header/stamp/nanosec,header/frame_id,format,data\n0.000000000,0,0,eye,png,AQID\n");
}

}  // namespace
}  // namespace rehearse::test
