// Recordings of robots' loops by the verb tap: their replays, and their comparison with a simulation.
#include <rehearse/gtest.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <sys/stat.h>
#include <rehearse/tap.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <random>

#include "support/environment_variable.h"
#include "tap/tap_verb.h"

namespace rehearse::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// The first tick from which on one of the joints differs.
std::int64_t first_tick_of(const nlohmann::json& joints) {
  std::int64_t first = std::numeric_limits<std::int64_t>::max();
  for (const nlohmann::json& joint : joints)
    if (!joint["from"].is_null()) first = std::min(first, joint["from"].get<std::int64_t>());
  return first;
}

class Flights : public TapVerb {
 protected:
  /// A flight of a robot that is the simulation in a recording. `noise`: of its velocities [rad/s].
  void fly(const std::string& simulation, const std::string& flight, int joints, double noise) const {
    const auto trace = Trace::load(folder() / simulation);
    ASSERT_TRUE(trace);
    const std::string model = (folder() / "walker.urdf").string();
    rehearse_tap_options options{};
    options.model = model.c_str();
    options.controller = "Walk";
    Tap loop(tap().c_str(), options);
    ASSERT_TRUE(loop.is_open()) << Tap::error();
    std::vector<std::string> names;
    std::vector<std::vector<double>> numbers, imu, efforts;
    for (int i = 0; i < joints; ++i) names.push_back(fmt::format("J{}", i));
    for (const char* quantity : {"q", "dq"})
      for (const std::string& name : names) numbers.push_back(trace->values("Walker/" + name + "/" + quantity));
    for (const char* quantity : {"angular_velocity", "linear_acceleration"})
      for (const char* axis : {"x", "y", "z"})
        imu.push_back(trace->values(fmt::format("Walker/Imu/{}/{}", quantity, axis)));
    for (const std::string& name : names) efforts.push_back(trace->values("Walker/Walk/output/" + name + "/u"));
    const int of_joints = loop.joints("Walker", names, REHEARSE_TAP_Q | REHEARSE_TAP_DQ),
              of_imu = loop.imu("Walker", "Imu"), of_efforts = loop.commands("Walker", names, REHEARSE_TAP_U);
    std::minstd_rand random(82);
    std::normal_distribution<double> normal(0.0, 1.0);
    const auto row = [](const std::vector<std::vector<double>>& columns, std::size_t tick) {
      std::vector<double> all;
      for (const std::vector<double>& column : columns) all.push_back(column[tick]);
      return all;
    };
    constexpr std::size_t late = 1;  // the IMU measures after the first step
    for (std::size_t tick = 0; tick < efforts[0].size(); ++tick) {
      std::vector<double> measured = row(numbers, tick);
      for (std::size_t i = names.size(); i < measured.size(); ++i) measured[i] += noise * normal(random);
      Tap::Tick recorded = loop.tick(static_cast<std::int64_t>(tick) * 1'000'000);
      recorded.write(of_joints, measured);
      if (tick >= late) recorded.write(of_imu, row(imu, tick - late));
      recorded.write(of_efforts, row(efforts, tick));
    }
    loop = Tap();
    EXPECT_EQ(rehearse({"tap", tap(), "--recover", "-o", flight}).status, 0);
  }
  /// Copies a recording, with other facts of its loop.
  void restate(const std::string& from, const std::string& to, const mcap::StringMap& facts) const {
    const auto reader = mcap::Reader::open(folder() / from);
    auto writer = mcap::Writer::create(folder() / to);
    ASSERT_TRUE(reader && writer);
    for (const mcap::Attachment& one : (*reader)->attachments())
      ASSERT_TRUE((*writer)->add_attachment(one.name, one.media_type, one.data));
    for (mcap::Metadata entry : (*reader)->metadata()) {
      if (entry.name == "rehearse.flight")
        for (const auto& [fact, value] : facts) entry.values[fact] = value;
      ASSERT_TRUE((*writer)->add_metadata(entry.name, entry.values));
    }
    std::map<std::uint16_t, std::uint16_t> ids;
    for (const auto& [id, channel] : (*reader)->channels()) {
      const mcap::Schema* schema = (*reader)->schema_of(channel);
      ASSERT_NE(schema, nullptr);
      ids[id] = (*writer)->add_channel((*writer)->add_schema(schema->name, schema->encoding, schema->data),
                                       channel.topic, channel.message_encoding, channel.metadata);
    }
    const auto copied = (*reader)->for_each_message([&](const mcap::Message& message) {
      return static_cast<bool>((*writer)->write(ids.at(message.channel->id), message.log_time, message.publish_time,
                                                message.data, message.sequence));
    });
    ASSERT_TRUE(copied);
    ASSERT_TRUE((*writer)->close());
  }
};

TEST_F(Flights, RecordsLoopsThatReplayBitForBit) {
  struct Row {
    const char* name;
    fs::path program;
    int joints;
    std::vector<std::string> words;
    const char* guest;
  };
  const Row rows[] = {{"c", LOOP, 12, {}, GUEST},
                      {"cpp17", LOOP_CPP17, 12, {}, GUEST},
                      {"cpp20", LOOP_CPP20, 12, {}, GUEST},
                      {"half", LOOP, 12, {"half"}, GUEST},
                      {"late", LOOP, 12, {"late"}, GUEST},
                      {"fast", LOOP, 12, {"fast"}, GUEST},
                      {"joints", LOOP, 60, {}, GUEST},
                      {"variables", LOOP, 12, {"variables"}, GUEST_WITH_VARIABLES},
                      {"images", LOOP, 12, {"images"}, GUEST},
                      {"bench", BENCH_LOOP, 12, {GUEST}, GUEST}};  // a library in the loop
  for (const Row& row : rows) {
    SCOPED_TRACE(row.name);
    const std::string file = std::string(row.name) + ".mcap";
    EXPECT_EQ(record(file, 2000, row.joints, row.words, {}, row.program), 0) << said();
    EXPECT_THAT(said(), HasSubstr("the loop closed its tap; 2000 ticks recorded in " + file));
    const Outcome replayed = replay(file, row.guest);
    EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
    EXPECT_THAT(replayed.out, HasSubstr(fmt::format("equal bit for bit: 2000 ticks, {} commanded numbers",
                                                    2000 * row.joints + 2000)));
    EXPECT_THAT(replayed.out, HasSubstr("computed with the functions of the robot's libm"));
    EXPECT_EQ(replayed.err, "");
    for (const char* guest : {GUEST_WITH_GAIN, GUEST_WITH_SIGN, GUEST_LATE}) {
      const Outcome changed = rehearse({"replay", file, "--controller", guest, "--json"});
      EXPECT_EQ(changed.status, 1) << guest << changed.err;
      EXPECT_EQ(changed.json()["first"]["tick"], 0) << guest;
      EXPECT_EQ(changed.json()["beyond"]["tick"], 0) << guest;
    }
  }
  EXPECT_FALSE(fs::exists(ring()));
  EXPECT_THAT(done({"cat", "images.mcap", "--topics", "/flight/images"}).out, HasSubstr("frames/000010.png"));
}

/// A robot without the variants of sin and exp that this processor has: the replay takes those of the robot.
TEST_F(Flights, ComputesWithTheMathematicsOfTheRobot) {
  const std::string tunables = "glibc.cpu.hwcaps=-AVX2_Usable,-AVX2,-FMA_Usable,-FMA,-FMA4_Usable,-FMA4";
  Beside recorder(folder(), command, {"tap", tap(), "-o", "flight.mcap"}, "recorder");
  EXPECT_EQ(run(LOOP, loop_words(2000, 12), "GLIBC_TUNABLES=" + tunables).status, 0);
  EXPECT_EQ(recorder.wait(), 0) << said();
  const Outcome replayed = replay("flight.mcap", GUEST);
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_THAT(replayed.out, HasSubstr("computed with the functions of the robot's libm"));
  EXPECT_THAT(replayed.out, HasSubstr("equal bit for bit: 2000 ticks"));
}

/// The recording of a robot whose processor this machine hasn't.
TEST_F(Flights, IsWithinToleranceWhereTheMathematicsIsAnother) {
  EXPECT_EQ(record("here.mcap", 2000, 12), 0) << said();
  restate("here.mcap", "other.mcap", {{"processor_flags", "asimd"}, {"architecture", "aarch64"}});
  const Outcome replayed = replay("other.mcap", GUEST_OF_OTHER_MATHEMATICS);
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_THAT(replayed.out, HasSubstr("within its tolerance: "));
  EXPECT_THAT(replayed.out, HasSubstr("the loop's machine was aarch64, and here "));
  EXPECT_EQ(replay("other.mcap", GUEST_WITH_GAIN).status, 1);
  EXPECT_EQ(replay("here.mcap", GUEST_OF_OTHER_MATHEMATICS).status, 1);  // no other mathematics excuses it
}

/// Two loops at the same time, each with its tap and its recorder.
TEST_F(Flights, RecordsTwoLoopsOfOneRobotBesideEachOther) {
  const std::string other = tap() + "-arm";
  Beside first(folder(), command, {"tap", tap(), "-o", "walk.mcap"}, "recorder");
  Beside second(folder(), command, {"tap", other, "-o", "arm.mcap"}, "second");
  std::vector<std::string> words = loop_words(500, 12, {"paced", "half"});
  words[0] = other;
  Beside loop(folder(), LOOP, words, "loop");
  EXPECT_EQ(run(LOOP, loop_words(1000, 12, {"paced"})).status, 0);
  EXPECT_EQ(loop.wait(), 0);
  EXPECT_EQ(first.wait(), 0);
  EXPECT_EQ(second.wait(), 0);
  EXPECT_EQ(replay("walk.mcap", GUEST).status, 0);
  EXPECT_EQ(replay("arm.mcap", GUEST).status, 0);
}

TEST_F(Flights, IsStartedByTheTap) {
  const std::string path = "PATH=" + command.parent_path().string() + ":$PATH";
  EXPECT_EQ(run(LOOP, loop_words(500, 3, {"paced", "spawn=1"}), path).status, 0);
  for (int i = 0; i < 500 && fs::exists(ring()); ++i) rest(10);
  EXPECT_FALSE(fs::exists(ring()));
  EXPECT_EQ(ticks_in(tap() + ".mcap").size(), 500u);
  EXPECT_EQ(replay(tap() + ".mcap", GUEST).status, 0);
}

TEST_F(Flights, WritesRecordingsThatAllVerbsRead) {
  EXPECT_EQ(record("flight.mcap", 500, 3, {"variables", "mark=100"}), 0);
  EXPECT_THAT(done({"info", "flight.mcap"}).out, HasSubstr("/Walker/Walk/output/joints"));
  EXPECT_THAT(done({"info", "flight.mcap"}).out, HasSubstr("memory_locked"));
  EXPECT_THAT(done({"cat", "flight.mcap", "--topics", "/events"}).out, HasSubstr("mark: a touch"));
  EXPECT_THAT(done({"diff", "flight.mcap", "flight.mcap"}).out, HasSubstr("equal"));
  done({"filter", "flight.mcap", "--topics", "/Walker/*", "-o", "part.mcap"});
  done({"recover", "flight.mcap", "-o", "whole.mcap"});
  EXPECT_EQ(replay("whole.mcap", GUEST_WITH_VARIABLES).status, 0);
  EXPECT_THAT(done({"replay", "flight.mcap", "--controller", GUEST_WITH_VARIABLES, "--tick", "7"}).out,
              HasSubstr("J0"));
  done({"report", "flight.mcap", "-o", "report.html"});
  EXPECT_EQ(rehearse({"doctor", "flight.mcap"}).status, 0) << rehearse({"doctor", "flight.mcap"}).out;
  const auto trace = Trace::load(folder() / "flight.mcap");
  ASSERT_TRUE(trace);
  EXPECT_EQ(trace->values("Walker/J2/q").size(), 500u);
  EXPECT_EQ(trace->values("Walker/Imu/angular_velocity/x").size(), 500u);
  EXPECT_EQ(trace->last("flight/dropped"), 0.0);
  const mcap::StringMap* flight = trace->find_metadata("rehearse.flight");
  ASSERT_NE(flight, nullptr);
  EXPECT_EQ(flight->at("gain"), "40");
}

TEST_F(Flights, WritesAScenarioThatBeginsAsTheFlight) {
  EXPECT_EQ(record("flight.mcap", 100, 3), 0);
  fs::create_directory(folder() / "scenarios");
  const std::vector<std::string> words{"replay", "flight.mcap", "--controller",
                                       GUEST,    "--scenario",  "scenarios/friday.yaml"};
  EXPECT_EQ(rehearse(words).status, 0);
  const std::string text = read_file(folder() / "scenarios/friday.yaml");
  EXPECT_THAT(text, HasSubstr(fmt::format("\"J1\": {}", 0.3 * std::sin(1.0))));
  EXPECT_THAT(text, HasSubstr("duration: 0.1 "));
  EXPECT_EQ(read_file(folder() / "scenarios/walker.urdf"), read_file(folder() / "walker.urdf"));
  EXPECT_EQ(rehearse({"record", "scenarios/friday.yaml", "-o", "run.mcap"}).status, 0);
  EXPECT_NEAR(Trace::load(folder() / "run.mcap")->values("Walker/J1/q")[0], 0.3 * std::sin(1.0), 1e-12);
  const Outcome again = rehearse(words);
  EXPECT_EQ(again.status, 2);
  EXPECT_THAT(again.err, HasSubstr("there is a file scenarios/friday.yaml already"));
}

/// The files of a flight in a folder are one recording for every verb.
TEST_F(Flights, ReadsTheFilesOfAFolderAsOneFlight) {
  fs::create_directory(folder() / "friday");
  EXPECT_EQ(record("friday/part.mcap", 5000, 60, {"paced"}, {"--split", "1"}), 0) << said();
  EXPECT_GE(std::distance(fs::directory_iterator(folder() / "friday"), {}), 3) << said();
  const Outcome replayed = replay("friday", GUEST);
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_THAT(replayed.out, HasSubstr("equal bit for bit: 5000 ticks"));
  EXPECT_THAT(done({"info", "friday"}).out, HasSubstr("/Walker/Walk/output/joints"));
  EXPECT_EQ(done({"diff", "friday", "friday"}).status, 0);
}

/// A robot that is a simulation, measured with noise; then its model is changed.
TEST_F(Flights, FindsTheTickFromWhichAWorldDiffersFromTheRobot) {
  robot(3);
  const std::string scenario = fmt::format(
      "rehearse: 1\nname: Arm\nduration: 1.0\nbodies:\n  - name: Walker\n    model: walker.urdf\n    fixed: true\n"
      "    joints: {{J0: 0.3, J2: -0.2}}\n    controllers: [{{name: Walk, library: {}, delay: false}}]\n",
      GUEST);
  write("arm.yaml", scenario);
  ASSERT_EQ(rehearse({"record", "arm.yaml", "-o", "robot.mcap"}).status, 0);
  for (const double noise : {0.0, 1e-3}) {
    SCOPED_TRACE(noise);
    const std::string flight = fmt::format("flight{}.mcap", noise);
    fly("robot.mcap", flight, 3, noise);
    const Outcome same = rehearse({"check", "arm.yaml", "--flight", flight});
    EXPECT_EQ(same.status, noise == 0.0 ? 0 : 1) << same.out << same.err;  // with noise it isn't the robot's controller
    if (noise == 0.0) {
      EXPECT_THAT(same.out, HasSubstr("controller: equal bit for bit"));
    }
    EXPECT_THAT(same.out, HasSubstr("plant: the world agrees with the robot in 99"));

    const std::string model = read_file(folder() / "walker.urdf");
    std::string heavier = model;
    const std::string inertia = "iyy=\"0.1\"";
    heavier.replace(heavier.rfind(inertia), inertia.size(), "iyy=\"0.12\"");  // of the last link
    write("walker.urdf", heavier);
    const Outcome other = rehearse({"check", "arm.yaml", "--flight", flight});
    EXPECT_EQ(other.status, 1) << other.out << other.err;
    EXPECT_THAT(other.out,
                testing::ContainsRegex("plant: the world differs from the robot from tick [0-9]+ .*: J[0-2]"));
    const nlohmann::json both = rehearse({"check", "arm.yaml", "--flight", flight, "--json"}).json();
    EXPECT_EQ(both["controller"]["equal"], noise == 0.0);
    EXPECT_EQ(both["plant"]["verdict"], "differs");
    EXPECT_EQ(both["plant"]["joints"].size(), 3u);
    EXPECT_THAT(other.out, HasSubstr(fmt::format("from tick {} ", first_tick_of(both["plant"]["joints"]))));
    write("walker.urdf", model);
  }
  std::string free = scenario, model = read_file(folder() / "walker.urdf");
  free.erase(free.find("    fixed: true\n"), 16);
  free.replace(free.find("walker.urdf"), 11, "free.urdf");
  write("free.yaml", free);
  model.replace(model.find("<link name=\"BASE\"/>"), 19,
                "<link name=\"BASE\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" "
                "iyz=\"0\" izz=\"1\"/></inertial></link>");
  write("free.urdf", model);
  const Outcome undecided = rehearse({"check", "free.yaml", "--flight", "flight0.mcap"});
  EXPECT_EQ(undecided.status, 4) << undecided.out << undecided.err;
  EXPECT_THAT(undecided.out, HasSubstr("plant: undecided: state missing: the base of 'Walker' isn't fixed"));
  EXPECT_EQ(rehearse({"check", "arm.yaml", "--flight", "robot.mcap"}).status, 2);
}

TEST_F(Flights, RefusesAControllerThatReadsWhatTheTapLacks) {
  EXPECT_EQ(record("flight.mcap", 10, 3), 0);
  const Outcome replayed = replay("flight.mcap", GUEST_THAT_READS_EFFORTS);
  EXPECT_EQ(replayed.status, 2);
  EXPECT_THAT(replayed.err, HasSubstr("reads u of link 'LINK0', which was not recorded"));
}

TEST_F(Flights, BecomeGoldensOfTests) {
  ASSERT_EQ(record("flight.mcap", 2000, 3), 0) << said();
  fs::create_directories(folder() / "golden");
  const std::vector<std::string> accept{"golden", "accept", "Walker.KeepsItsCommands", "--recording", "flight.mcap"};
  const Outcome accepted = rehearse(accept);
  EXPECT_EQ(accepted.status, 0) << accepted.err;
  EXPECT_THAT(accepted.out, HasSubstr("accepted golden/Walker.KeepsItsCommands.mcap"));
  EXPECT_THAT(rehearse(accept).out, HasSubstr("is this run already: nothing was changed"));
  const Outcome two = rehearse({"golden", "accept", "A.B", "C.D", "--recording", "flight.mcap"});
  EXPECT_EQ(two.status, 2);
  EXPECT_THAT(two.err, HasSubstr("--recording becomes one golden: state its name alone"));
  EXPECT_NE(rehearse({"golden", "accept", "A.B", "--recording", "none.mcap"}).status, 0);

  fs::create_directories(folder() / "controllers");
  const EnvironmentVariable path("REHEARSE_CONTROLLER_PATH", (folder() / "controllers").c_str());
  set_test_folders({folder().string(), (folder() / "golden").string(), folder().string(), ""});
  const auto replay_with = [this](const char* guest) {
    fs::copy_file(guest, folder() / "controllers/Walk.so", fs::copy_options::overwrite_existing);
    return internal::replay_golden("Walker.KeepsItsCommands", "Walker.ReplaysFriday");
  };
  const auto same = replay_with(GUEST);
  EXPECT_TRUE(same.passed) << same.message;
  const auto other = replay_with(GUEST_WITH_GAIN);
  EXPECT_FALSE(other.passed);
  EXPECT_THAT(other.message, HasSubstr("the controller gives other commands: "));
  EXPECT_THAT(internal::replay_golden("Walker.Kept", "Walker.Kept").message,
              HasSubstr("or a recording: rehearse golden accept Walker.Kept --recording FILE"));
}

}  // namespace
}  // namespace rehearse::test
