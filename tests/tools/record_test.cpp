// rehearse record: its output, its files, and that a second recording is equal.
#include <rehearse/trace.h>

#include "command.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class Record : public Command {};

TEST_F(Record, SaysWhatWasRecordedAndThatItIsAsExpectedAndHowNearly) {
  const Outcome outcome = done({"record", sr1_scenario.string(), "--duration", "0.1", "-o", "sr1.mcap"});
  EXPECT_THAT(outcome.out,
              HasSubstr("recorded sr1_minimum: SR1 under SR1Minimum\n100 ticks, 0.1 s of simulation, in "));
  EXPECT_THAT(outcome.out,
              ContainsRegex("s with loading: [0-9.e+]+ times real time\n21 channels, 12 pictures, .* in sr1.mcap\n"
                            "control\\(\\) of SR1/SR1Minimum: median .* % of the period\n"
                            "all 2 expectations hold; closest: .* of .* at tick [0-9]+ .*, margin .* %: "
                            ".*\n$"));
  EXPECT_LE(std::ranges::count(outcome.out, '\n'), 5);
}

TEST_F(Record, TellsWhatIsNotAsExpectedAndKeepsTheRecordingAllTheSame) {
  write("box.yaml", read_file(box_scenario) +
                        "expect:\n"
                        "  - {channel: Box/Box/position/z, above: 0.3}\n"
                        "  - {channel: Box/Box/position/y, near: 0, within: 0.1}\n"
                        "  - {channel: Box/Box/positon/z, above: 0, at: end}\n");
  const Outcome outcome = rehearse({"record", "box.yaml"});
  EXPECT_EQ(outcome.status, 2) << "the last one is a mistake of the scenario";
  EXPECT_TRUE(exists("box.mcap"));
  EXPECT_EQ(std::ranges::count(outcome.out, '\n'), 3);
  EXPECT_THAT(outcome.err,
              ContainsRegex("^box.yaml:[0-9]+:15: warning: expected Box/Box/position/z above 0.3 m: 0.29[0-9]* m at "
                            "tick [0-9]+ \\(0.2[0-9]* s\\), at worst "));
  EXPECT_THAT(outcome.err, ContainsRegex("\nbox.yaml:[0-9]+:15: error: .*the run has no such series; the nearest are "
                                         "Box/Box/position/z, "));
  EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 2);
}

/// Expectations of a run are evaluated from its trace.
TEST_F(Record, WritesIntoAPipeOnlyWhatItDoesNotReadAgain) {
  const std::string behind =
      "sh -c 'mkfifo trace; cat trace > copy.mcap & timeout 20 \"$@\"; status=$?; wait; exit $status' sh ";
  const Outcome plain = run(command, {"record", box_scenario.string(), "--duration", "0.1", "-o", "trace"}, behind);
  EXPECT_EQ(plain.status, 0) << plain.err;
  EXPECT_THAT(plain.out, HasSubstr(" pictures in trace\n"));
  done({"info", "copy.mcap"});
  write("box.yaml", read_file(box_scenario) + "expect:\n  - {channel: Box/Box/position/z, above: 0.3}\n");
  fs::remove(folder() / "trace");
  const Outcome judged =
      run(command, {"record", "box.yaml", "-o", "trace"}, "sh -c 'mkfifo trace; exec timeout 20 \"$@\"' sh ");
  EXPECT_EQ(judged.status, 2);
  EXPECT_EQ(judged.err, "error: trace can't be read again, as the check of expectations needs it (write a file)\n");
}

TEST_F(Record, MakesNoFileOfTheNameOfStandardOutput) {
  const Outcome outcome = rehearse({"record", box_scenario.string(), "-o", "-"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(
      outcome.err,
      "error: '-' is no file: nothing is written to standard output (name a file; './-' is a file of that name)\n");
  EXPECT_FALSE(exists("-"));
}

TEST_F(Record, IsRefusedAFileThatAnotherOneWrites) {
  const Outcome both = run(command, {"record", box_scenario.string(), "--duration", "5000", "-o", "box.mcap"},
                           "sh -c '\"$@\" > first.txt 2>&1 & until [ -e box.mcap ]; do sleep 0.05; done; sleep 0.3; "
                           "\"$@\"; status=$?; kill -INT $!; wait; exit $status' sh ");
  EXPECT_EQ(both.status, 2);
  EXPECT_THAT(both.err, HasSubstr("box.mcap: error: another writer has opened this file (name another file, or wait)"));
  EXPECT_THAT(read_file(folder() / "first.txt"), HasSubstr("interrupted by SIGINT")) << "the first one goes on";
  done({"info", "box.mcap"});
}

TEST_F(Record, ExpectsOfAShorterRunOnlyWhatIsInIt) {
  write("box.yaml", read_file(box_scenario) +
                        "expect:\n"
                        "  - {channel: Box/Box/position/z, below: 0.2, at: end}\n"
                        "  - {channel: Box/Box/position/z, below: 0.2, from: 0.8}\n"
                        "  - {channel: Box/Box/position/z, above: 0.3}\n");
  const Outcome outcome = done({"record", "box.yaml", "--duration", "0.1"});
  EXPECT_THAT(outcome.out, HasSubstr("\nthe expectation holds: Box/Box/position/z above 0.3 m; closest: "));
}

TEST_F(Record, KeepsAsManyCheckpointsAsItIsTold) {
  const auto checkpoints = [&](const std::vector<std::string>& how) {
    std::vector<std::string> words{"record", box_scenario.string(), "--duration", "0.2", "-o", "box.mcap"};
    words.insert(words.end(), how.begin(), how.end());
    done(words);
    const auto trace = Trace::load(folder() / "box.mcap");
    return trace ? trace->find_channel("/checkpoint")->messages() : 999u;
  };
  EXPECT_EQ(checkpoints({}), 2u);
  EXPECT_EQ(checkpoints({"--checkpoints", "0.02"}), 10u);
  EXPECT_EQ(checkpoints({"--checkpoints", "0"}), 0u);
  EXPECT_EQ(rehearse({"record", box_scenario.string(), "--checkpoints", "-1"}).status, 2);
}

TEST_F(Record, TellsOnRequestWhetherTheRecordingRepeatsItself) {
  EXPECT_THAT(done({"record", box_scenario.string(), "--verify"}).out,
              HasSubstr("\nthe recording repeats itself, bit for bit: "));
  EXPECT_FALSE(exists("drop_box.mcap.again"));
  const Outcome outcome = rehearse({"record", pendulum(MISBEHAVING, "chance 12").string(), "--verify"});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasSubstr("\nthe recording doesn't repeat itself: fed with its inputs, the controller differs "
                        "at tick 12 (0.012 s): "));
  EXPECT_TRUE(exists("pendulum.mcap"));
}

TEST_F(Record, NamesTheTraceLikeTheScenario) {
  done({"record", box_scenario.string()});
  EXPECT_TRUE(exists("drop_box.mcap"));
}

TEST_F(Record, GivesEqualBytesTwice) {
  for (const char* trace : {"a.mcap", "b.mcap"})
    done({"record", sr1_scenario.string(), "--duration", "0.2", "-o", trace});
  EXPECT_GT(fs::file_size(folder() / "a.mcap"), 100'000u);  // 200 ticks of 29 joints, and 10 pictures
  EXPECT_TRUE(read_file(folder() / "a.mcap") == read_file(folder() / "b.mcap"));
}

TEST_F(Record, GivesEqualBytesWhateverTheEnvironmentSaysOfTheProcessor) {
  const std::string scenario = sr1_without_cameras().string();
  done({"record", scenario, "-o", "a.mcap"});
  rehearse({"record", scenario, "-o", "b.mcap"}, "GALLIUM_OVERRIDE_CPU_CAPS=avx LP_NUM_THREADS=4");
  EXPECT_TRUE(read_file(folder() / "a.mcap") == read_file(folder() / "b.mcap"));
}

TEST_F(Record, ReplacesATrace) {
  done({"record", box_scenario.string(), "-o", "a.mcap", "--duration", "0.5"});
  const auto size = fs::file_size(folder() / "a.mcap");
  done({"record", box_scenario.string(), "-o", "a.mcap"});
  EXPECT_GT(fs::file_size(folder() / "a.mcap"), size);
}

TEST_F(Record, SeedAndDurationOfTheCommandLineStandInTheTrace) {
  done({"record", box_scenario.string(), "-o", "a.mcap", "--seed", "4294967295", "--duration", "0.25"});
  const nlohmann::json info = done({"info", "a.mcap", "--json"}).json();
  EXPECT_EQ(info["metadata"][0]["values"]["seed"], "4294967295");
  EXPECT_EQ(info["metadata"][0]["values"]["duration"], "0.25");
  EXPECT_EQ(info["ticks"], 250);  // with the states of ticks 0 to 250
}

TEST_F(Record, LeavesPicturesOut) {
  const Outcome outcome = done({"record", sr1_scenario.string(), "--duration", "0.1", "--no-frames", "-o", "a.mcap"});
  EXPECT_THAT(outcome.out, HasSubstr("15 channels, 0 pictures"));
}

TEST_F(Record, RefusesAControllerThatTheScenarioHasNot) {
  const Outcome outcome = rehearse({"record", pendulum("SR1MinimumController").string(), "--controller", "Swng=x.so"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err, "error: there is no controller 'Swng' in pendulum (there is: Pendulum/Swing)\n");
  EXPECT_FALSE(exists("pendulum.mcap"));
}

TEST_F(Record, TellsEveryMistakeOfAScenario) {
  const Outcome outcome = rehearse({"record", (fixtures / "broken/scenario_unknown_key.yaml").string()});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, ContainsRegex("scenario_unknown_key.yaml:[0-9]+:[0-9]+: error: "));
  EXPECT_TRUE(is_empty());
}

TEST_F(Record, DrawsNoProgressBarWhenPiped) {
  const Outcome outcome = done({"record", sr1_scenario.string(), "-o", "a.mcap"});
  EXPECT_EQ(outcome.out.find('\x1b'), std::string::npos);
}

TEST_F(Command, RecordNamesEightBodiesAtMost) {
  std::string text = "rehearse: 1\nduration: 0.01\nbodies:\n";
  for (int i = 0; i < 11; ++i)
    text += "  - {name: B" + std::to_string(i) + ", sphere: {radius: 0.1}, mass: 1, position: [" + std::to_string(i) +
            ", 0, 1]}\n";
  write("many.yaml", text);
  EXPECT_THAT(done({"record", "many.yaml"}).out,
              StartsWith("recorded many: B0, B1, B2, B3, B4, B5, B6, B7 and 3 more\n"));
}

}  // namespace
}  // namespace rehearse::test
