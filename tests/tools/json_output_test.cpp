// --json: stdout has one object and nothing else, whatever the controller prints.
#include "command.h"

#include <gmock/gmock.h>

#include <sstream>

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;

class JsonOutput : public Command {
 protected:
  JsonOutput() {
    fs::create_directory(folder() / "golden");
    fs::create_directory(folder() / "scenarios");
    const std::string scenario = read_file(pendulum(PRINTS));
    for (const char* name : {"a", "b"})
      write(std::string("scenarios/") + name + ".yaml", scenario + "golden: P." + name + "\n");
    fs::remove(folder() / "pendulum.yaml");
    EXPECT_EQ(rehearse({"record", "scenarios/a.yaml", "-o", "run.mcap", "--checkpoints", "0.01"}).status, 0);
  }

  /// The verb's only object. What the controller prints must be on stderr.
  nlohmann::json object_of(std::vector<std::string> arguments, const std::string& environment = "") const {
    arguments.emplace_back("--json");
    SCOPED_TRACE(::testing::PrintToString(arguments));
    const Outcome outcome = rehearse(arguments, environment);
    EXPECT_THAT(outcome.err, HasSubstr("cout in control"));
    EXPECT_THAT(outcome.err, HasSubstr("printf at load"));
    return outcome.json();
  }
  void expect_lines(std::vector<std::string> arguments) const {
    arguments.emplace_back("--json");
    SCOPED_TRACE(::testing::PrintToString(arguments));
    std::istringstream lines(rehearse(arguments).out);
    int count = 0;
    for (std::string line; std::getline(lines, line); ++count)
      EXPECT_FALSE(nlohmann::json::parse(line, nullptr, false).is_discarded()) << line;
    EXPECT_GT(count, 0);
  }
};

TEST_F(JsonOutput, OfVerbsThatRunControllersIsOneObject) {
  EXPECT_EQ(object_of({"record", "scenarios/a.yaml", "-o", "other.mcap"})["ticks"], 50);
  EXPECT_EQ(object_of({"record", "scenarios/a.yaml", "-o", "other.mcap"}, "REHEARSE_SUPERVISE=off")["ticks"], 50);
  EXPECT_EQ(object_of({"record", "scenarios/a.yaml", "-o", "other.mcap", "--verify"})["schema"], 1);
  EXPECT_EQ(object_of({"record", "--from-checkpoint", "run.mcap@0.02s", "-o", "branch.mcap"})["schema"], 1);
  EXPECT_EQ(object_of({"replay", "run.mcap"})["equal"], true);
  EXPECT_EQ(object_of({"replay", "run.mcap", "--tick", "12"})["schema"], 1);
  EXPECT_EQ(object_of({"check"}, "REHEARSE_GOLDEN=new")["schema"], 1);
  EXPECT_EQ(object_of({"check", "-j1", "--simulate"})["equal"], true);
  EXPECT_EQ(object_of({"check", "-j2", "--simulate"})["equal"], true);
  EXPECT_EQ(object_of({"check", "scenarios/a.yaml"})["equal"], true);
  EXPECT_EQ(object_of({"golden", "noise", "scenarios/a.yaml"})["schema"], 1);
}

TEST_F(JsonOutput, OfSeriesIsAnObjectALine) {
  expect_lines({"cat", "run.mcap"});
  expect_lines({"replay", "run.mcap", "--watch", "*"});
  expect_lines({"replay", "run.mcap", "--when", "Pendulum/hinge/q > 0.1"});
}

TEST_F(JsonOutput, OfAProcessThatAControllerEndsIsItsErrors) {
  write("scenarios/c.yaml", read_file(pendulum(MISBEHAVING, "exit_group 12")) + "golden: P.c\n");
  for (const std::vector<std::string>& verb :
       std::vector<std::vector<std::string>>{{"record", "pendulum.yaml", "-o", "failed.mcap"},
                                             {"replay", "failed.mcap"},
                                             {"check", "scenarios/c.yaml"},
                                             {"check", "-j2", "scenarios/c.yaml", "scenarios/c.yaml"}}) {
    SCOPED_TRACE(::testing::PrintToString(verb));
    std::vector<std::string> as_json = verb;
    as_json.emplace_back("--json");
    const Outcome outcome = rehearse(as_json);
    EXPECT_EQ(outcome.status, 3);
    EXPECT_THAT(outcome.json()["errors"][0]["message"].get<std::string>(),
                HasSubstr("controller 'Pendulum/Swing' ended the process with exit status 0 in control() at tick 12"));
  }
}

TEST_F(JsonOutput, ReachesStdoutThoughAControllerClosesAllDescriptors) {
  pendulum(MISBEHAVING, "raw_close 12");
  const Outcome outcome = rehearse({"record", "pendulum.yaml", "-o", "run.mcap", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["ticks"], 50);
}

}  // namespace
}  // namespace rehearse::test
