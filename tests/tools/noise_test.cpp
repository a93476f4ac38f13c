// rehearse golden noise, and the remarks of check about its file.
#include "command.h"

#include <gmock/gmock.h>

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string noise_file = "golden/Robot.Stands.noise";

/// A repository with one scenario and its golden.
class GoldenNoise : public Command {
 protected:
  GoldenNoise() {
    fs::create_directories(folder() / "golden");
    std::string text = read_file(sr1_without_cameras());
    const std::string before = "golden: SR1.StandsUnderItsMinimumController";
    const std::size_t at = text.find(before);
    EXPECT_NE(at, std::string::npos);
    write("stands.yaml", text.replace(at, before.size(), "golden: Robot.Stands"));
    EXPECT_EQ(rehearse({"check", "stands.yaml"}).status, 1);
    done({"golden", "accept", "Robot.Stands"});
  }
};

TEST_F(GoldenNoise, IsWrittenBesideTheGolden) {
  const Outcome outcome = done({"golden", "noise", "stands.yaml"});
  EXPECT_THAT(outcome.out, StartsWith("sr1_minimum: noise of 0.1 s\n"));
  EXPECT_THAT(outcome.out, ContainsRegex("\n  1 of joints +rad +- +[0-9.]+e-1[0-9] +1e-07 +[0-9.]+e\\+0[0-9]\n"));
  EXPECT_THAT(outcome.out, ContainsRegex("\n  1 of output/joints +N·m +0 +- +0.002 +-\n"));
  EXPECT_THAT(outcome.out, HasSubstr("  last bits, pattern 1: within tolerance; the closed loop stays within its"));
  EXPECT_THAT(outcome.out, HasSubstr("  renderer of SSE2: not made: no camera of the scenario runs\n"));
  EXPECT_THAT(outcome.out, HasSubstr("  wrote golden/Robot.Stands.noise\n"));
  EXPECT_THAT(read_file(folder() / noise_file), HasSubstr("scenario: sr1_minimum\n"));
  EXPECT_FALSE(exists("rehearse-pending/noise/sr1_minimum"));
  const std::string first = read_file(folder() / noise_file);
  done({"golden", "noise", "stands.yaml"});
  EXPECT_EQ(read_file(folder() / noise_file), first) << "measured again, it is another file";
}

TEST_F(GoldenNoise, LeavesNothingBehindWhenItIsStopped) {
  const std::string script =
      "\"$@\" & until ls rehearse-pending/noise/*/run.mcap > /dev/null 2>&1; do sleep 0.02; done; kill -INT $!; wait "
      "$!";
  const Outcome outcome =
      run("/bin/sh", {"-c", script, "sh", command.string(), "golden", "noise", "stands.yaml", "--patterns", "500"});
  EXPECT_EQ(outcome.status, 130) << outcome.out;
  EXPECT_THAT(outcome.err, HasSubstr("rehearse golden: interrupted by SIGINT; incomplete results are removed"));
  EXPECT_TRUE(fs::is_empty(folder() / "rehearse-pending/noise"));
}

TEST_F(GoldenNoise, AnswersInJson) {
  const nlohmann::json report = done({"golden", "noise", "stands.yaml", "--json", "--patterns", "1"}).json();
  EXPECT_EQ(report["scenario"], "sr1_minimum");
  EXPECT_EQ(report["file"], noise_file);
  EXPECT_EQ(report["horizon"], nullptr);
  EXPECT_EQ(report["perturbations"][0]["within"], true);
  EXPECT_EQ(report["perturbations"].size(), 4u);
  EXPECT_GT(report["channels"].size(), 5u);
}

TEST_F(GoldenNoise, IsNotKeptOfARunThatIsNotItsGolden) {
  const std::string scenario = read_file(folder() / "stands.yaml");
  write("stands.yaml", scenario + "gravity: [0, 0, -9.9]\n");
  EXPECT_THAT(done({"golden", "noise", "stands.yaml"}).out,
              HasSubstr("not kept: the run differs from its golden: check it first\n"));
  write("stands.yaml", scenario);
  EXPECT_THAT(done({"golden", "noise", "stands.yaml", "--duration", "0.05"}).out,
              HasSubstr("not kept: it was measured over another duration\n"));
  EXPECT_FALSE(exists(noise_file));
}

TEST_F(GoldenNoise, IsNotMeasuredUnderCi) {
  const Outcome outcome = rehearse({"golden", "noise", "stands.yaml"}, "CI=true");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, StartsWith("error: goldens are only checked where CI is 'true'"));
}

TEST_F(GoldenNoise, RefusesAScenarioThatIsNotThere) {
  EXPECT_EQ(rehearse({"golden", "noise", "walks.yaml"}).status, 2);
  EXPECT_EQ(rehearse({"golden", "noise"}).status, 2);
}

TEST_F(GoldenNoise, LetsACheckSayWhichTolerancesLieBelowIt) {
  done({"golden", "noise", "stands.yaml"});
  EXPECT_THAT(done({"check", "stands.yaml", "--json"}).json()["remarks"], ::testing::IsEmpty());
  std::string scenario = read_file(folder() / "stands.yaml");
  const std::string before = "{channel: \"SR1/*/q\", atol: 1.0e-7}";
  ASSERT_NE(scenario.find(before), std::string::npos);
  write("stands.yaml", scenario.replace(scenario.find(before), before.size(), "{channel: \"SR1/*/q\", atol: 1.0e-18}"));
  const Outcome outcome = done({"check", "stands.yaml", "--simulate"});  // a proof needs no tolerance
  EXPECT_THAT(outcome.out,
              HasSubstr("\n  note: 1 tolerance lies below the measured noise, the most in /SR1/joints [rad]: "
                        "1e-18 is allowed, "));
  write(noise_file, "noise: 1\n");
  EXPECT_THAT(done({"check", "stands.yaml", "--simulate"}).out,
              HasSubstr("\n  note: the measured noise can't be read: golden/Robot.Stan"));
}

/// A process that isn't pinned computes sin() otherwise, and a controller that calls it commands other last bits.
TEST_F(Command, CheckOfAnotherArithmeticIsWithinTolerance) {
  const fs::path scenario = fixtures / "scenarios/arm_reach.yaml";
  done({"record", scenario.string(), "-o", "golden.mcap", "--quiet"});
  // without `rehearse`, which would pin it
  const fs::path simulator = command.parent_path() / "../libexec/rehearse/rehearse-simulate";
  const Outcome outcome = run(simulator, {"check", scenario.string(), "--golden", "golden.mcap", "--json"},
                              "REHEARSE_PIN=off GALLIUM_OVERRIDE_CPU_CAPS=sse4.1 LP_NUM_THREADS=1");
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  const nlohmann::json levels = outcome.json()["levels"];
  EXPECT_NE(levels["controller"], "differs");
  EXPECT_NE(levels["plant"], "differs");
}

}  // namespace
}  // namespace rehearse::test
