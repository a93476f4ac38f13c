// Sweep: campaigns of a falling box and of a controller that misbehaves, from the command line.
#pragma once

#include "command.h"
#include "falling_box.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace rehearse::test {

using ::testing::HasSubstr;

inline constexpr int bad_input = 2;

class Sweep : public Command {
 protected:
  /// A box that falls 20 ms; the lower ones reach the floor.
  fs::path box(const std::string& more = "", const std::string& name = "box.yaml") const {
    return write(name, falling_box("0.02", "above: 0.3", "0.6") + more);
  }
  /// The pendulum under a controller that misbehaves by `deeds`.
  fs::path deeds(const std::string& deeds) const {
    std::string text = read_file(pendulum(MISBEHAVING, "none"));
    return write("deeds.yaml",
                 text + "vary:\n  deed: {path: bodies.Pendulum.controllers.Swing.options, grid: [" + deeds + "]}\n");
  }
  std::map<std::string, std::string> verdicts(const std::string& campaign) const {
    std::map<std::string, std::string> by_first_value;
    std::istringstream stream(read_file(folder() / campaign / "results.csv"));
    std::string line;
    std::getline(stream, line);
    while (std::getline(stream, line)) {
      std::istringstream cells(line);
      std::string number, value, verdict;
      std::getline(cells, number, ',');
      std::getline(cells, value, ',');
      std::getline(cells, verdict, ',');
      by_first_value[value] = verdict;
    }
    return by_first_value;
  }
  /// Runs a command that can't write larger files [bytes], as on a full disk.
  Outcome with_small_files(rlim_t size, const std::vector<std::string>& words) const {
    const pid_t child = fork();
    if (child == 0) {
      if (chdir(folder().c_str()) != 0) _exit(9);
      std::signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{size, size};
      setrlimit(RLIMIT_FSIZE, &limit);
      const int log = open("log", O_WRONLY | O_CREAT | O_TRUNC, 0666);
      dup2(log, STDOUT_FILENO);
      dup2(log, STDERR_FILENO);
      std::vector<char*> arguments{const_cast<char*>("rehearse")};
      for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
      arguments.push_back(nullptr);
      execv(command.c_str(), arguments.data());
      _exit(9);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return {WEXITSTATUS(status), "", read_file(folder() / "log")};
  }
  std::string results(const std::string& campaign) const { return read_file(folder() / campaign / "results.csv"); }
  /// How often each case has a result line that isn't a second run.
  std::map<int, int> counts(const std::string& campaign) const {
    std::map<int, int> counts;
    std::istringstream stream(read_file(folder() / campaign / "results.jsonl"));
    for (std::string line; std::getline(stream, line);) {
      const auto object = nlohmann::json::parse(line, nullptr, false);
      if (!object.is_discarded() && !object.value("again", false)) ++counts[object["case"].get<int>()];
    }
    return counts;
  }
};

}  // namespace rehearse::test
