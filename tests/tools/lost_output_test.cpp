// Output that can't be written is an error: stdout is a full disk, or closed.
#include "command.h"

#include <gmock/gmock.h>

#include <sstream>

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;

constexpr const char* full_disk = "> /dev/full";
constexpr const char* closed = ">&-";

class LostOutput : public Command {
 protected:
  /// The errors of the verb with its stdout redirected; it must end with status 2.
  std::string refused(const std::vector<std::string>& arguments, const char* redirection) const {
    std::vector<std::string> words{"-c", std::string("\"$@\" ") + redirection, "bash", command.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const Outcome outcome = run("bash", words, "REHEARSE_CALL_STACK=never");
    EXPECT_EQ(outcome.status, 2) << arguments[0];
    return outcome.err;
  }
  void expect_error(const std::vector<std::string>& arguments) const {
    SCOPED_TRACE(::testing::PrintToString(arguments));
    EXPECT_THAT(refused(arguments, full_disk), HasSubstr("error: can't write to stdout: No space left on device"));
    EXPECT_THAT(refused(arguments, closed), HasSubstr("error: can't write to stdout: Bad file descriptor"));
  }
};

TEST_F(LostOutput, OfEachVerbsHelp) {
  expect_error({"--help"});
  expect_error({"--version"});
  std::istringstream lines(rehearse({"--help"}).out);
  int verbs = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("  ") || line.size() < 3 || line[2] == ' ') continue;
    expect_error({line.substr(2, line.find(' ', 2) - 2), "--help"});
    ++verbs;
  }
  EXPECT_GT(verbs, 20);
}

TEST_F(LostOutput, OfVerbsThatRead) {
  done({"record", box_scenario.string(), "-o", "run.mcap"});
  fs::create_directory(folder() / "golden");
  fs::copy_file(folder() / "run.mcap", folder() / "golden/run.mcap");
  expect_error({"info", "run.mcap"});
  expect_error({"info", "run.mcap", "--json"});
  expect_error({"cat", "run.mcap"});
  expect_error({"diff", "run.mcap", "run.mcap"});
  expect_error({"diff", "run.mcap", "run.mcap", "--json"});
  expect_error({"golden", "list"});
  expect_error({"inspect", (fixtures / "models/pendulum.urdf").string(), "--json"});
  expect_error({"doctor", "--json"});
}

TEST_F(LostOutput, OfVerbsThatRunControllers) {
  pendulum(MISBEHAVING, "none");
  done({"record", "pendulum.yaml", "-o", "run.mcap"});
  for (const std::vector<std::string>& verb :
       std::vector<std::vector<std::string>>{{"record", "pendulum.yaml", "-o", "other.mcap"},
                                             {"replay", "run.mcap"},
                                             {"check", "pendulum.yaml", "--golden", "run.mcap"},
                                             {"check", "pendulum.yaml", "--golden", "run.mcap", "--simulate"},
                                             {"audit", "run.mcap"}}) {
    expect_error(verb);
    std::vector<std::string> as_json = verb;
    as_json.push_back("--json");
    expect_error(as_json);
  }
  EXPECT_EQ(done({"info", "other.mcap", "--json"}).json()["ticks"], 50);
}

}  // namespace
}  // namespace rehearse::test
