// ProjectChecks: the verdicts of a project's scenarios, kept true while its files change. Internal.
//
// 1. A file changes: all scenarios wait, and what still runs is ended.
// 2. cmake builds the project, unless only scenarios and goldens have changed. A failed build ends here.
// 3. `rehearse check` judges each scenario in a process of its own: first the one that is looked at, then those that
//    didn't pass. What the change can't reach is proved, which takes a tenth of a second.
// 4. A scenario that didn't pass and is looked at is checked once more, with its report, which takes seconds.
// Nothing is built and no controller is loaded before the owner of the project has allowed it, once.
#pragma once

#include <rehearse/diagnostic.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/guard/child_process.h"
#include "source_watch.h"

namespace rehearse {

struct ProjectChecksOptions {
  std::filesystem::path project;  // its folder
  std::filesystem::path command;  // the program rehearse
  std::filesystem::path allowed;  // the file that lists the projects whose owners have allowed it; empty: none is kept
  std::size_t jobs = 1;           // scenarios to check at a time
};

class ProjectChecks {
 public:
  using Json = nlohmann::ordered_json;

  static Result<ProjectChecks> open(ProjectChecksOptions options);

  /// Looks at files and processes, and goes on. True if state() has changed.
  bool step();
  /// All that a page shows: {project, allowed, build, scenarios, waiting}.
  Json state() const;

  /// The owner allows the project's code to be built and run.
  Result<void> allow();
  /// Checks this scenario before others from now on, and makes its report if it fails.
  Result<void> look_at(const std::string& file);
  /// Builds the project, and checks all scenarios.
  void check_all();
  /// Decides on the run that waits as that golden, as `rehearse golden accept` and `reject` do.
  Result<void> decide(const std::string& golden, bool is_accepted);
  /// The report of the last check of a scenario; fails if it has none.
  Result<std::filesystem::path> report_of(const std::string& file) const;
  /// Ends all that runs.
  void stop();

 private:
  using Clock = std::chrono::steady_clock;
  enum class Phase { unknown, waits, checking, judged };

  struct Scenario {
    std::string file, golden;  // relative to the project
    Phase phase = Phase::unknown;
    Json result = nullptr;  // of the last check
    std::filesystem::path report = {};
    bool wants_report = false;  // it failed, and its report isn't being made yet

    bool has_passed() const { return result.is_object() && result.value("state", "") == "passed"; }
  };
  struct Job {
    std::string file;
    RunningProgram program;
    Clock::time_point begin;
    std::uint64_t changes = 0;  // of files, before it began
    bool makes_report = false;
  };
  struct Build {
    std::filesystem::path folder = {};  // empty: the project has none
    bool is_wanted = false, has_failed = false;
    double seconds = 0.0;  // that the last one took [s]
    std::string output = {};
    std::optional<Job> job = {};
  };

  explicit ProjectChecks(ProjectChecksOptions options, SourceWatch watch);

  void list_scenarios();
  void let_all_wait();
  void take_changes(const std::vector<std::filesystem::path>& files);
  bool take_build();
  bool take_checks();
  bool start_build();
  bool start_checks();
  Scenario* find(const std::string& file);
  Scenario* next();
  Scenario* next_report();
  /// Starts a check of the scenario. Fails if there is no process for it.
  Result<void> start_check(const Scenario& scenario, bool makes_report);
  void take_verdict(Scenario& scenario, int status, const Job& job);
  void take_answer(Scenario& scenario, const Json& checked);
  bool is_reported(const Scenario& scenario) const;
  Json json_of(const Scenario& scenario) const;
  ChildProcess command(std::vector<std::string> words) const;

  ProjectChecksOptions options_;
  SourceWatch watch_;
  bool is_allowed_ = false;
  Build build_;
  std::vector<Scenario> scenarios_;
  std::vector<Job> jobs_;
  std::set<std::string> looked_at_;  // files of scenarios
  std::uint64_t changes_ = 0;        // of files, so far
};

}  // namespace rehearse
