// rehearse golden prune: removes goldens that no test and no scenario names any more. The names in tests are known only
// from a run of the tests.
#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <memory>
#include <set>

#include "core/golden/run_folder.h"
#include "core/guard/child_process.h"
#include "golden_verbs.h"
#include "options.h"
#include "terminal.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

struct GoldenPruneSettings {
  std::vector<std::string> tests;  // programs
  bool no_tests = false;
  bool yes = false;
  bool json = false;
};

/// The environment of test programs: as a person starts them by hand, with `own` variables besides.
std::vector<std::string> environment_of_tests(const EnvironmentChanges& own) {
  EnvironmentChanges changes = own;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view text = *variable;
    if (text.starts_with("REHEARSE_") || text.starts_with("GTEST_"))
      changes.emplace(text.substr(0, text.find('=')), std::nullopt);
  }
  return environment_with(changes);
}

/// The test names in the output of --gtest_list_tests, in the form in which goldens are named.
std::set<std::string> names_listed(const fs::path& listing) {
  std::set<std::string> names;
  std::string suite;
  std::ifstream stream(listing);
  for (std::string line; std::getline(stream, line);) {
    const std::string word = line.substr(0, line.find(" #"));  // the test's parameters follow
    if (!word.starts_with("  ")) {
      suite = word;
      while (suite.ends_with(' ')) suite.pop_back();
      continue;
    }
    std::string name = suite + word.substr(2);
    std::ranges::replace(name, '/', '-');
    names.insert(name);
  }
  return names;
}

/// The goldens that the tests of a program name: those with which a run compares, and those that have the name of a
/// test, which may have ended before the comparison.
Result<std::set<std::string>> named_by_tests(const std::string& program, const GoldenStore& store,
                                             const fs::path& scratch) {
  const fs::path listing = scratch / "tests.txt", pending = scratch / "pending";
  const auto listed = REHEARSE_TRY(run_to_end({{program, "--gtest_list_tests"}, environment_of_tests({}), listing}));
  std::set<std::string> names = names_listed(listing);
  if (listed != 0 || names.empty())
    return error(fmt::format("{} lists no tests", program), "name programs that GoogleTest made");
  const auto ran = REHEARSE_TRY(run_to_end(
      {{program, "--gtest_also_run_disabled_tests=0"},
       environment_of_tests({{"REHEARSE_PENDING", fs::absolute(pending).string()}, {"REHEARSE_REPORT", "never"}}),
       scratch / "run.txt"}));
  if (ran != 0 && ran != 1)
    return error(fmt::format("{} ended with status {} before all its tests had run", program, ran),
                 "mend it first: the goldens of its tests are unknown");
  for (const auto& [name, owners] : reported_golden_owners(GoldenStore(store.folder(), pending))) names.insert(name);
  return names;
}

Result<std::set<std::string>> named_by_all_tests(const GoldenPruneSettings& settings, const GoldenStore& store) {
  std::set<std::string> names;
  if (settings.tests.empty()) return names;
  auto scratch = REHEARSE_TRY(RunFolder::make(store.where_runs_wait()));
  for (const std::string& program : settings.tests) {
    const auto named = REHEARSE_TRY(named_by_tests(program, store, scratch.path()));
    names.insert(named.begin(), named.end());
  }
  return names;
}

/// True if both files exist; remove() checks their contents.
bool is_pair(const GoldenStore& store, const GoldenEntry& entry) {
  std::error_code ignored;
  return store.has(entry.name) && fs::is_regular_file(store.digest_file(entry.name), ignored);
}

/// True if the last commit contains the file in its present state.
bool is_committed(const fs::path& file, const fs::path& scratch) {
  const std::string folder = file.has_parent_path() ? file.parent_path().string() : ".",
                    name = file.filename().string();
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"/usr/bin/git", "-C", folder, "ls-files", "--error-unmatch", "--", name},
        {"/usr/bin/git", "-C", folder, "diff", "--quiet", "HEAD", "--", name}}) {
    const auto ended = run_to_end({words, environment_with({}), scratch / "git.txt"});
    if (!ended || *ended != 0) return false;
  }
  return true;
}

bool asked_and_agreed() {
  fmt::print("remove them? [y]es [n]o ");
  const bool yes = read_key("yn") == 'y';
  fmt::print("{}\n", yes ? "yes" : "no");
  return yes;
}

/// Orphaned goldens of which both files exist, by name.
std::vector<std::string> tell_orphans(const GoldenStore& store, const std::vector<GoldenEntry>& entries,
                                      const std::map<std::string, GoldenOwners>& scenarios,
                                      const std::set<std::string>& tests, bool aloud) {
  std::vector<std::string> names;
  for (const GoldenEntry& entry : entries) {
    const auto owners = scenarios.find(entry.name);
    if (tests.contains(entry.name) || (owners != scenarios.end() && !owners->second.scenarios.empty())) continue;
    const bool pair = is_pair(store, entry);
    if (pair) names.push_back(entry.name);
    if (!aloud) continue;
    if (pair)
      fmt::print("{} and its digest, {}: no test and no scenario names it\n", store.trace_file(entry.name).string(),
                 file_size_text(entry.bytes));
    else
      fmt::print("{}: left alone, because only one of its two files is there\n", entry.name);
  }
  return names;
}

struct Removal {
  std::vector<std::string> removed, moved;
  Diagnostics problems;
};

/// Removes files that git has stored, and moves all others to a folder.
Removal remove_all(GoldenStore& store, const std::vector<std::string>& names, const fs::path& pruned) {
  Removal done;
  const auto scratch = RunFolder::make(store.where_runs_wait());
  if (!scratch) return {{}, {}, scratch.errors()};
  for (const std::string& name : names) {
    const bool committed =
        is_committed(store.trace_file(name), scratch->path()) && is_committed(store.digest_file(name), scratch->path());
    if (auto gone = store.remove(name, committed ? fs::path() : pruned); !gone)
      done.problems.insert(done.problems.end(), gone.errors().begin(), gone.errors().end());
    else
      (committed ? done.removed : done.moved).push_back(name);
  }
  return done;
}

void tell(const Removal& done, const fs::path& pruned) {
  if (!done.removed.empty()) fmt::print("removed {}, which git has\n", count_text(std::ssize(done.removed), "golden"));
  if (!done.moved.empty())
    fmt::print("moved {} to {}\n", count_text(std::ssize(done.moved), "golden"), pruned.string());
}

Exit prune(const GoldenPruneSettings& settings) {
  if (auto may = check_may_decide(); !may) return refuse(may.errors());
  auto store = open_store();
  if (!store) return refuse(store.errors());
  if (settings.tests.empty() != settings.no_tests)
    return refuse(error("only a run of the tests shows the goldens that they name",
                        "--tests PROGRAM runs one, repeatable; --no-tests if there are none"));
  const auto tests = named_by_all_tests(settings, *store);
  if (!tests) return refuse(tests.errors());
  const std::vector<fs::path> sources{store->folder() / ".."};
  const auto entries = list_goldens(*store, sources);
  if (!entries) return refuse(entries.errors());
  const std::vector<std::string> orphans =
      tell_orphans(*store, *entries, find_golden_owners(store->folder(), sources), *tests, !settings.json);
  bool remove = settings.yes && !orphans.empty();
  if (!orphans.empty() && !settings.yes && !settings.json) {
    if (somebody_is_there())
      remove = asked_and_agreed();
    else
      fmt::print("--yes removes them\n");
  }
  const fs::path pruned = store->where_runs_wait().parent_path() / "pruned-goldens";
  const Removal done = remove ? remove_all(*store, orphans, pruned) : Removal();
  if (settings.json)
    print({{"orphans", orphans},
           {"removed", done.removed},
           {"moved", done.moved},
           {"folder", done.moved.empty() ? Json(nullptr) : Json(pruned.string())},
           {"problems", json_of(done.problems)}});
  else if (orphans.empty())
    fmt::print("nothing to remove\n");
  else
    tell(done, pruned);
  if (!done.problems.empty()) return settings.json ? Exit::bad_input : refuse(done.problems);
  return done.removed.size() + done.moved.size() == orphans.size() ? Exit::done : Exit::differs;
}

}  // namespace

std::function<Exit()> declare_golden_prune(CLI::App& options) {
  const auto settings = std::make_shared<GoldenPruneSettings>();
  options
      .add_option("--tests", settings->tests,
                  "run this test program to find the goldens of its tests; all test programs have to be named")
      ->type_name("PROGRAM")
      ->allow_extra_args(false);
  options.add_flag("--no-tests", settings->no_tests, "there are no test programs: only scenarios name goldens");
  options.add_flag("--yes", settings->yes, "remove them without asking");
  add_json_flag(options, settings->json);
  return [settings] { return prune(*settings); };
}

}  // namespace rehearse::tool
