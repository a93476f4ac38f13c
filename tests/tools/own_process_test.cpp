// Runs and replays of check, record --verify, replay (of logs, too), golden noise and branches begin in a process that
// has run no controller.
#include <gmock/gmock.h>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

class OwnProcesses : public Command {
 protected:
  OwnProcesses() {
    fs::create_directories(folder() / "golden");
    fs::create_directories(folder() / "scenarios");
  }
  /// A scenario with a golden, under this controller.
  void add(const std::string& name, const std::string& library, const std::string& options = "") const {
    const std::string pendulum = read_file(Command::pendulum(library, options));
    write("scenarios/" + name + ".yaml", pendulum + "golden: P." + name + "\n");
  }
  /// A scenario with a camera, and `more` lines.
  void add_eye(const std::string& scenario, const std::string& more = "") const {
    write("eye.urdf",
          "<robot name=\"Eye\"><link name=\"WALL\"/><gazebo reference=\"WALL\"><sensor name=\"Lens\" type=\"camera\">"
          "<update_rate>100</update_rate><camera><horizontal_fov>1</horizontal_fov>"
          "<image><width>16</width><height>12</height></image></camera></sensor></gazebo></robot>");
    write(scenario,
          more + "rehearse: 1\nduration: 0.05\nbodies:\n  - {name: Eye, model: " + (folder() / "eye.urdf").string() +
              ", position: [2, 0, 1]}\n  - {name: Ball, sphere: {radius: 0.1}, mass: 1, position: [0, 0, 1]}\n" +
              "cameras: [Eye/Lens]\n");
  }
};

/// Controllers that depend on the runs before theirs in one process, and on nothing else: a static counter, and rand()
/// without a seed.
class FirstRuns : public OwnProcesses, public ::testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override { add("a", GetParam()); }
  const std::string scenario_ = "scenarios/a.yaml";
};

TEST_P(FirstRuns, AreAlikeForRecordAndItsVerification) {
  EXPECT_THAT(done({"record", scenario_, "--verify"}).out, HasSubstr("the recording repeats itself, bit for bit"));
  EXPECT_EQ(done({"record", scenario_, "-o", "b.mcap", "--verify", "--json"}).json()["repeats_itself"], true);
  EXPECT_EQ(done({"diff", "a.mcap", "b.mcap", "--json"}).json()["equal"], true);
}

TEST_P(FirstRuns, AreAlikeForEachKindOfCheck) {
  const Outcome written = rehearse({"check", scenario_}, "REHEARSE_GOLDEN=new");
  EXPECT_EQ(written.status, 0) << written.out << written.err;
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--simulate"}, {}, {"--simulate", "-j1"}, {"--level", "controller"}, {"-j2"}}) {
    std::vector<std::string> words{"check", scenario_, "--json"};
    words.insert(words.end(), options.begin(), options.end());
    EXPECT_EQ(done(words).json()["equal"], true) << (options.empty() ? "proved" : options[0]);
  }
}

TEST_P(FirstRuns, AreAlikeForAReplayAndItsFile) {
  done({"record", scenario_});
  EXPECT_EQ(done({"replay", "a.mcap", "-o", "again.mcap", "--json"}).json()["equal"], true);
  EXPECT_EQ(done({"diff", "a.mcap", "again.mcap", "--json"}).json()["equal"], true);
  done({"replay", "again.mcap"});
}

TEST_P(FirstRuns, AreAlikeForTwoBranches) {
  done({"record", scenario_});
  for (const char* name : {"one.mcap", "two.mcap"}) {
    const Outcome branch = done({"record", "--from-checkpoint", "a.mcap@tick:20", "-o", name});
    EXPECT_THAT(branch.out, HasSubstr("repeat their commands bit for bit"));
  }
  EXPECT_EQ(done({"diff", "one.mcap", "two.mcap", "--json"}).json()["equal"], true);
}

/// A second run would leave the tolerances at once.
TEST_P(FirstRuns, AreAlikeForAllPerturbationsOfAMeasurementOfNoise) {
  EXPECT_EQ(rehearse({"check", scenario_}, "REHEARSE_GOLDEN=new").status, 0);
  const nlohmann::json noise = done({"golden", "noise", scenario_, "--json"}).json();
  EXPECT_EQ(noise["not_kept"], "");
  for (const nlohmann::json& perturbation : noise["perturbations"]) {
    EXPECT_EQ(perturbation["within"], true) << perturbation;
    EXPECT_EQ(perturbation["horizon"], nullptr) << perturbation;
  }
}

TEST_P(FirstRuns, AreAlikeForTestsWithGoogleTest) {
  pendulum(GetParam());
  const std::vector<std::string> of_pendulum{"--gtest_filter=Pendulum.*:Replay.*"};
  for (const char* environment : {"REHEARSE_GOLDEN=new", "REHEARSE_PROOF=off", "REHEARSE_PROOF=on"}) {
    const Outcome outcome = run(FIRST_RUNS, of_pendulum, environment);
    EXPECT_EQ(outcome.status, 0) << environment << "\n" << outcome.out << outcome.err;
  }
}

/// The log of a pendulum: a recording of this controller.
class LogOfAPendulum : public OwnProcesses {
 protected:
  LogOfAPendulum(const char* library = COUNTS_RUNS) : library_(library) {
    add("a", library_);
    done({"record", "scenarios/a.yaml", "-o", "log.mcap"});
  }
  Outcome replay(const std::string& rest_of_map) const {
    write("map.yaml", "rehearse_map: 1\ntime_step: 0.001\nbody: Pendulum\njoints: /Pendulum/joints\ncommands: " +
                          commands_ + "\n" + rest_of_map);
    return rehearse({"replay", "log.mcap", "--controller", library_, "--model",
                     (fixtures / "models/pendulum.urdf").string(), "--map", "map.yaml", "--json"});
  }
  const std::string library_, commands_ = "/Pendulum/Swing/output/joints";
};

TEST_F(LogOfAPendulum, HasOneForEachControllerThatStartsInIt) {
  const nlohmann::json report = replay("restart: [0.0195, 0.0295]\n").json();
  EXPECT_EQ(report["equal"], true) << report;
  ASSERT_EQ(report["after_restarts"].size(), 2u);
  for (const nlohmann::json& part : report["after_restarts"]) EXPECT_EQ(part["equal"], true) << part;
}

class LogOfDraws : public LogOfAPendulum {
 protected:
  LogOfDraws() : LogOfAPendulum(DRAWS) {}
};

/// The map lets the controller start with the first command, which is recorded only from tick 15 on. Its numbers
/// agree if it starts before: in a process that has drawn none.
TEST_F(LogOfDraws, HasOneForEachOtherReadingOfTheMap) {
  done({"filter", "log.mcap", "--exclude", commands_, "-o", "inputs.mcap"});
  done({"filter", "log.mcap", "--topics", commands_, "--from", "0.0145", "-o", "commands.mcap"});
  fs::remove(folder() / "log.mcap");
  done({"merge", "inputs.mcap", "commands.mcap", "-o", "log.mcap"});
  const Outcome outcome = replay("start: " + commands_ + "\n");
  EXPECT_EQ(outcome.status, 4) << outcome.err;
  EXPECT_EQ(outcome.json()["cause"]["lines"], nlohmann::json{"start: first"}) << outcome.out;
  EXPECT_EQ(outcome.json()["cause"]["different"], 0);
}

/// The level plant draws, too: a process that has drawn pictures can't fork one that draws.
TEST_F(OwnProcesses, DrawThePicturesOfAllRunsOfACheck) {
  for (const char* name : {"a", "b"})
    add_eye(std::string("scenarios/") + name + ".yaml", std::string("golden: Eye.") + name + "\n");
  const std::vector<std::string> all{"check", "scenarios/a.yaml", "scenarios/b.yaml", "-j1", "--simulate"};
  EXPECT_EQ(rehearse(all, "REHEARSE_GOLDEN=new").status, 0);
  const Outcome simulated = rehearse(all);
  EXPECT_EQ(simulated.status, 0) << simulated.out << simulated.err;
  EXPECT_THAT(simulated.out, HasSubstr("b: equal bit for bit"));
}

TEST_F(OwnProcesses, DrawThePicturesOfTestsWhoseProcessHasDrawn) {
  add_eye("eye.yaml");
  const Outcome outcome = run(FIRST_RUNS, {"--gtest_filter=Eye.*"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, HasSubstr("[  FAILED  ] Eye.IsRed"));
  EXPECT_THAT(outcome.out, HasSubstr("[       OK ] Eye.SeesAfterThisProcessHasDrawn")) << outcome.err;
  EXPECT_TRUE(exists("traces/index.html"));
}

INSTANTIATE_TEST_SUITE_P(Of, FirstRuns, ::testing::Values(COUNTS_RUNS, DRAWS),
                         [](const auto& info) { return fs::path(info.param).stem().string().substr(0, 6); });

TEST_F(OwnProcesses, AreThoseOfAllRunsOfACheck) {
  for (const char* name : {"a", "b", "c"}) add(name, COUNTS_RUNS);
  const Outcome written = rehearse({"check", "-j1"}, "REHEARSE_GOLDEN=new");
  EXPECT_EQ(written.status, 0) << written.out << written.err;
  for (const char* jobs : {"-j1", "-j2"}) {
    const nlohmann::json simulated = done({"check", "--simulate", "--json", jobs}).json();
    EXPECT_EQ(simulated["equal"], true) << simulated;
    EXPECT_EQ(simulated["proved"], false);
  }
  done({"check", "-j1"});
  EXPECT_EQ(done({"check", "--json", "-j1"}).json()["proved"], true);
  EXPECT_EQ(done({"check", "--simulate", "--json", "scenarios/a.yaml"}).json()["equal"], true);
}

/// Past the C library, or inside of it: the process can't go on.
TEST_F(OwnProcesses, ThatAControllerEndsAreReportedWithTheirTick) {
  add("a", MISBEHAVING, "exit_group 12");
  for (const char* jobs : {"-j1", "-j2"}) {
    const Outcome outcome = rehearse({"check", jobs, "scenarios/a.yaml", "scenarios/a.yaml"});
    EXPECT_EQ(outcome.status, 3);
    EXPECT_THAT(outcome.err, ContainsRegex("controller 'Pendulum/Swing' ended the process .* in control\\(\\) at tick "
                                           "12 \\(0.012 s\\)"));
  }
}

}  // namespace
}  // namespace rehearse::test
