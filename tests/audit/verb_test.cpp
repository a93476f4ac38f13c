// The verb audit: its arguments, its errors, its output.
#include "audited.h"

#include <gmock/gmock.h>

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using AuditVerb = Audited;

TEST_F(AuditVerb, TakesARecording) {
  done({"record", scenario("good_own_generator").string(), "-o", "zoo.mcap"});
  const Outcome outcome = done({"audit", "zoo.mcap"});
  EXPECT_THAT(outcome.out,
              StartsWith("Pendulum/Zoo is a function of its inputs: 8 replays of 0.2 s under other memory, "
                         "addresses and variables gave the same 200 commands, bit for bit\n"));
  EXPECT_THAT(outcome.out, HasSubstr("recorded in closed loop                  not varied: the recording was given\n"));
}

TEST_F(AuditVerb, TakesAnotherLibraryForIt) {
  done({"record", scenario("good_own_generator").string(), "-o", "zoo.mcap"});
  const Outcome outcome = rehearse({"audit", "zoo.mcap", "--controller", "Zoo=" ZOO "/zoo_time.so"});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("Pendulum/Zoo is not deterministic: it depends on the clock"));
}

TEST_F(AuditVerb, JudgesEachOfSeveralControllers) {
  const auto pendulum = [](const std::string& name, const std::string& library, const std::string& x) {
    return "  - name: " + name + "\n    model: " + (fixtures / "models/pendulum.urdf").string() + "\n    position: [" +
           x + ", 0, 0]\n    joints: {hinge: 20 deg}\n    controllers: [{name: Zoo, library: " + ZOO "/zoo_" + library +
           ".so}]\n";
  };
  const fs::path two =
      write("two.yaml", "rehearse: 1\nduration: 0.1\nbodies:\n" + pendulum("Good", "good_own_generator", "0") +
                            pendulum("Bad", "rand", "5"));
  const Outcome outcome = rehearse({"audit", two.string(), "--json"});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  const nlohmann::json report = outcome.json();
  EXPECT_THAT(std::string(report["verdict"]), StartsWith("Bad/Zoo is not deterministic: it depends on random numbers"));
  EXPECT_EQ(report["controllers"][0]["deterministic"], true);
  EXPECT_EQ(report["controllers"][1]["deterministic"], false);
  EXPECT_EQ(report["first"]["channel"], "/Bad/Zoo/output/joints");
}

TEST_F(AuditVerb, SaysWhichOfTwoCallsReachesACommand) {
  const nlohmann::json report = rehearse({"audit", scenario("steady_clock").string(), "--json"}).json();
  std::string filtered, counted;
  for (const auto& call : report["calls"]) {
    const std::string place = call["place"];
    if (place.find("filtered") != std::string::npos) filtered = call["reached"];
    if (place.find("count_busy_time") != std::string::npos) counted = call["reached"];
  }
  EXPECT_EQ(filtered, "yes");
  EXPECT_EQ(counted, "no");
}

TEST_F(AuditVerb, GivesSimulatedTimeAndSeededRandomNumbers) {
  for (const char* controller : {"time", "random_device", "rand", "steady_clock"}) {
    const fs::path zoo = scenario(controller);
    const Outcome outcome = rehearse({"audit", zoo.string(), "--virtualise", "--seed", "7", "-o", "virtual.mcap"});
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("of its inputs, with simulated time and seeded random numbers: "));
    EXPECT_THAT(outcome.out, HasSubstr("\nrecorded in virtual.mcap: "));
    EXPECT_THAT(done({"info", "virtual.mcap"}).out, HasSubstr("clock, random; seed 7"));
    EXPECT_THAT(done({"replay", "virtual.mcap"}).out, HasSubstr("equal bit for bit"));
    EXPECT_THAT(done({"audit", "virtual.mcap"}).out, HasSubstr(", with simulated time and seeded random numbers: "));
    EXPECT_EQ(rehearse({"check", zoo.string(), "--golden", "virtual.mcap"}).status, 0);
    done({"record", zoo.string(), "-o", "real.mcap"});
    const std::string real = rehearse({"replay", "real.mcap"}).out;
    if (controller == std::string("random_device")) {
      EXPECT_THAT(real, HasSubstr("differs: hinge/u is beyond "));
    }
  }
}

TEST_F(AuditVerb, KeepsARecordingOnlyIfItIsVirtual) {
  const Outcome outcome = rehearse({"audit", scenario("time").string(), "-o", "kept.mcap"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("-o is the recording that --virtualise makes"));
  EXPECT_FALSE(exists("kept.mcap"));
}

TEST_F(AuditVerb, RecordsNoRecordingAgain) {
  done({"record", scenario("good_own_generator").string(), "-o", "zoo.mcap"});
  const Outcome outcome = rehearse({"audit", "zoo.mcap", "--virtualise", "-o", "kept.mcap"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("-o is a new recording, which needs a scenario; zoo.mcap is a recording"));
  EXPECT_FALSE(exists("kept.mcap"));
}

TEST_F(AuditVerb, RepeatsAsOftenAsItIsTold) {
  done({"record", scenario("good_own_generator").string(), "-o", "zoo.mcap"});
  EXPECT_THAT(done({"audit", "zoo.mcap", "--repeat", "3"}).out, HasSubstr(": 20 replays of "));
}

TEST_F(AuditVerb, EndsWhereItIsTold) {
  done({"record", scenario("good_own_generator").string(), "-o", "zoo.mcap"});
  EXPECT_THAT(done({"audit", "zoo.mcap", "--until", "0.05"}).out, HasSubstr(" of 0.05 s under"));
}

TEST_F(AuditVerb, RefusesWhatIsNoRun) {
  EXPECT_EQ(rehearse({"audit"}).status, 2);
  const Outcome missing = rehearse({"audit", "nothing.mcap"});
  EXPECT_EQ(missing.status, 2);
  EXPECT_THAT(missing.err, HasSubstr("error: there is no nothing.mcap"));
  write("text.mcap", "not a recording\n");
  const Outcome text = rehearse({"audit", "text.mcap"});
  EXPECT_EQ(text.status, 2);
  EXPECT_THAT(text.err, HasSubstr("not an MCAP file"));
  done({"record", box_scenario.string(), "-o", "box.mcap"});
  const Outcome nobody = rehearse({"audit", "box.mcap"});
  EXPECT_EQ(nobody.status, 2);
  EXPECT_THAT(nobody.err, HasSubstr("has no controllers: there is nothing to audit"));
}

TEST_F(AuditVerb, RefusesControllersThatDoNotLoad) {
  const Outcome missing = rehearse({"audit", scenario("nobody").string()});
  EXPECT_EQ(missing.status, 2);
  EXPECT_THAT(missing.err, HasSubstr("zoo_nobody.so' not found"));
  write("no_library.so", "not a library\n");
  done({"record", scenario("good_own_generator").string(), "-o", "zoo.mcap"});
  const Outcome text = rehearse({"audit", "zoo.mcap", "--controller", "Zoo=./no_library.so"});
  EXPECT_EQ(text.status, 2);
  EXPECT_THAT(text.err, HasSubstr("is not a shared library"));
  const Outcome unknown = rehearse({"audit", "zoo.mcap", "--controller", "Walker=" ZOO "/zoo_time.so"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("there is no controller 'Walker'"));
}

TEST_F(AuditVerb, RefusesATraceWithoutTheInputs) {
  done({"record", scenario("good_own_generator").string(), "-o", "zoo.mcap"});
  const Outcome outcome = rehearse({"audit", "zoo.mcap", "--controller", "Zoo=" ZOO "/zoo_reads_more.so"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, ContainsRegex("controller 'Pendulum/Zoo' reads .*, which was not recorded"));
}

TEST_F(AuditVerb, SaysThatAControllerRefuses) {
  const Outcome outcome = rehearse({"audit", scenario("good_constant_file", "nowhere.txt").string()});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.out,
              StartsWith("failed: controller 'Pendulum/Zoo' refuses to take part: initialize() returned false; "
                         "nowhere.txt wasn't there"));
}

TEST_F(AuditVerb, SaysThatNothingWasCompared) {
  done({"record", scenario("good_own_generator").string(), "-o", "zoo.mcap"});
  EXPECT_THAT(done({"audit", "zoo.mcap", "--until", "0"}).out, StartsWith("nothing was compared: "));
}

TEST_F(AuditVerb, RefusesATraceThatIsCutOff) {
  done({"record", scenario("good_own_generator").string(), "-o", "zoo.mcap"});
  fs::resize_file(folder() / "zoo.mcap", fs::file_size(folder() / "zoo.mcap") / 2);
  const Outcome outcome = rehearse({"audit", "zoo.mcap"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, ContainsRegex("zoo.mcap"));
}

TEST_F(AuditVerb, RefusesToWorkWithoutAFolderForIt) {
  const Outcome outcome = rehearse({"audit", scenario("good_own_generator").string()}, "TMPDIR=/nonexistent");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("error: there is no folder for temporary files"));
}

TEST_F(AuditVerb, LeavesNothingBehindWhenItIsStopped) {
  const fs::path temporary = folder() / "temporary";
  fs::create_directory(temporary);
  const fs::path zoo = scenario("steady_clock");
  // interrupted as soon as its folder is there, however long the machine takes for that
  const std::string script =
      "\"$@\" & until ls temporary/rehearse.* > /dev/null 2>&1; do sleep 0.02; done; kill -INT $!; wait $!";
  const Outcome outcome =
      run("/bin/sh", {"-c", script, "sh", command.string(), "audit", zoo.string(), "--repeat", "500"},
          "TMPDIR=" + quoted(temporary.string()));
  EXPECT_EQ(outcome.status, 130) << outcome.out;
  EXPECT_THAT(outcome.err, HasSubstr("rehearse audit: interrupted by SIGINT; incomplete results are removed"));
  EXPECT_TRUE(fs::is_empty(temporary));
}

TEST_F(AuditVerb, LeavesTheUsersFilesAsTheyAre) {
  write("gain.txt", "0.25\n");
  rehearse({"audit", scenario("changing_file", (folder() / "gain.txt").string()).string()});
  EXPECT_EQ(read_file(folder() / "gain.txt"), "0.25\n");
  rehearse({"audit", scenario("good_scratch_file").string()});
  EXPECT_FALSE(exists("scratch.txt"));
}

TEST_F(AuditVerb, LeavesNothingBehind) {
  done({"audit", scenario("good_own_generator").string()});
  fs::remove(folder() / "zoo.yaml");
  EXPECT_TRUE(is_empty());
}

#if !defined(SANITIZED)  // its malloc() is not varied
TEST_F(AuditVerb, JudgesAlikeWhereverItsTemporaryFilesAre) {
  const fs::path zoo = scenario("pointer_order");
  for (int length = 1; length < 17; length += 5) {  // malloc's sizes are multiples of 16 bytes
    const fs::path temporary = folder() / std::string(static_cast<std::size_t>(length), 't');
    fs::create_directory(temporary);
    const Outcome outcome = rehearse({"audit", zoo.string()}, "TMPDIR=" + quoted(temporary.string()));
    EXPECT_THAT(outcome.out, HasSubstr("it depends on addresses")) << temporary;
  }
}

TEST_F(AuditVerb, NamesThePlaceByValgrind) {
  const Outcome outcome = rehearse({"audit", scenario("use_after_free").string(), "--valgrind"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, HasSubstr("valgrind: memory is read that is not its own in "));
  EXPECT_THAT(outcome.out, ContainsRegex("UseAfterFree::term\\(\\) \\(use_after_free.cpp:16\\)"));
  const Outcome member = rehearse({"audit", scenario("uninitialised_member").string(), "--valgrind"});
  EXPECT_EQ(member.status, 1);
  EXPECT_THAT(member.out,
              HasSubstr("valgrind: a command was never set: hinge/u of /Pendulum/Zoo/output/joints at tick 0"));
}
#endif

}  // namespace
}  // namespace rehearse::test
