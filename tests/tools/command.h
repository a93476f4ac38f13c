// Functions for tests of the command: run it as a user does, in a folder for the test alone, and check all its results.
#pragma once

#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/files.h"
#include "support/shell.h"

namespace rehearse::test {

namespace fs = std::filesystem;

inline const fs::path fixtures = FIXTURES_DIR;
inline const fs::path sr1_scenario = fixtures / "scenarios/sr1_minimum.yaml";
inline const fs::path box_scenario = fixtures / "scenarios/drop_box.yaml";
inline const fs::path command = REHEARSE_COMMAND;

/// The result of a command.
struct Outcome {
  int status = -1;  // -1: a signal ended it
  std::string out;
  std::string err;

  /// Its stdout as JSON; fails the test and returns null if it isn't JSON.
  nlohmann::json json() const {
    const nlohmann::json object = nlohmann::json::parse(out, nullptr, false);
    EXPECT_FALSE(object.is_discarded()) << "not JSON: " << out;
    return object.is_discarded() ? nlohmann::json() : object;
  }
};

/// A test with an empty folder in which its commands run.
class Command : public ::testing::Test {
 protected:
  Command() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string(test->test_suite_name()) + "." + test->name();
    for (char& c : name)
      if (c == '/') c = '_';
    folder_ = fs::path(::testing::TempDir()) / ("rehearse_" + std::to_string(getpid())) / name;
    fs::create_directories(folder_);
    // the test must not depend on the machine's environment
    for (const char* variable :
         {"CI", "REHEARSE_GOLDEN", "REHEARSE_GOLDEN_DIR", "REHEARSE_PENDING", "REHEARSE_CONTROLLER_PATH"})
      unsetenv(variable);
  }
  ~Command() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
    for (const char* stream : {".stdout", ".stderr"}) fs::remove(folder_.string() + stream, ignored);
    fs::remove(folder_.parent_path(), ignored);  // it stays while other tests of the process use it
  }

  const fs::path& folder() const { return folder_; }

  /// `environment`: as "CI=true REHEARSE_GOLDEN=new".
  Outcome run(const fs::path& program, const std::vector<std::string>& arguments,
              const std::string& environment = "") const {
    std::string line = "cd " + quoted(folder_.string()) + " && " + environment + " " + quoted(program.string());
    for (const std::string& argument : arguments) line += " " + quoted(argument);
    const fs::path out = folder_.string() + ".stdout", err = folder_.string() + ".stderr";
    const int ended =
        std::system((line + " > " + quoted(out.string()) + " 2> " + quoted(err.string()) + " < /dev/null").c_str());
    return {WIFEXITED(ended) ? WEXITSTATUS(ended) : -1, read_file(out), read_file(err)};
  }
  /// Without call stacks in reports, for which gdb is started, unless `environment` states otherwise.
  Outcome rehearse(const std::vector<std::string>& arguments, const std::string& environment = "") const {
    return run(command, arguments, "REHEARSE_CALL_STACK=never " + environment);
  }

  /// Runs a command that must succeed.
  Outcome done(const std::vector<std::string>& arguments) const {
    Outcome outcome = rehearse(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    EXPECT_EQ(outcome.err, "");
    return outcome;
  }

  /// The largest memory of the command and its processes [kB]. A shell starts it, because the number that the system
  /// reports of a process includes the memory of the one that started it, and this test is larger than the command.
  long memory_of(const std::vector<std::string>& arguments) const {
    std::vector<std::string> words{"sh", "-c", "cd \"$0\"; \"$@\" > /dev/null &", folder_.string(), command.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    EXPECT_EQ(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);  // the command becomes a child of this process
    pid_t started = 0;
    EXPECT_EQ(posix_spawnp(&started, "sh", nullptr, nullptr, pointers.data(), environ), 0);
    int status = 0;
    EXPECT_EQ(waitpid(started, &status, 0), started);
    rusage used{};
    EXPECT_GT(wait4(-1, &status, 0, &used), 0);
    EXPECT_EQ(status, 0);
    EXPECT_EQ(prctl(PR_SET_CHILD_SUBREAPER, 0), 0);
    return used.ru_maxrss;
  }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  bool exists(const std::string& name) const { return fs::exists(folder_ / name); }
  bool is_empty() const { return fs::is_empty(folder_); }

  /// 50 ms of a pendulum that is released at 20 degrees, without cameras, under one controller.
  fs::path pendulum(const std::string& library, const std::string& options = "") const {
    return write("pendulum.yaml", "rehearse: 1\nduration: 0.05\nbodies:\n  - name: Pendulum\n    model: " +
                                      (fixtures / "models/pendulum.urdf").string() +
                                      "\n    joints: {hinge: 20 deg}\n    controllers:\n      - name: Swing\n" +
                                      "        library: " + library + "\n        options: \"" + options + "\"\n");
  }
  /// 100 ms of SR1 without cameras.
  fs::path sr1_without_cameras() const {
    std::string text = read_file(sr1_scenario);
    const auto set = [&](const std::string& key, const std::string& value) {
      const std::size_t at = text.find(key + ": ");
      ASSERT_NE(at, std::string::npos) << key;
      text.replace(at, text.find('\n', at) - at, key + ": " + value);
    };
    set("model", (fixtures / "models/sr1.urdf").string());
    set("cameras", "[]");
    set("duration", "0.1");
    return write("sr1.yaml", text);
  }

 private:
  fs::path folder_;
};

}  // namespace rehearse::test
