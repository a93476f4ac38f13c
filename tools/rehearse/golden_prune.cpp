// rehearse golden prune: goldens that nobody names any more.
#include <fmt/format.h>

#include <memory>

#include "golden_verbs.h"
#include "options.h"
#include "terminal.h"

namespace rehearse::tool {
namespace {

struct Settings {
  bool yes = false;
  bool json = false;
};

/// Both files are there; whether they are what their names say, remove() looks at.
bool is_pair(const GoldenStore& store, const GoldenEntry& entry) {
  std::error_code ignored;
  return store.has(entry.name) && std::filesystem::is_regular_file(store.digest_file(entry.name), ignored);
}

bool asked_and_agreed() {
  fmt::print("remove them? [y]es [n]o ");
  const bool yes = read_key("yn") == 'y';
  fmt::print("{}\n", yes ? "yes" : "no");
  return yes;
}

/// Orphans of which both files are there, by name.
std::vector<std::string> tell_orphans(const GoldenStore& store, const std::vector<GoldenEntry>& entries, bool aloud) {
  std::vector<std::string> names;
  for (const GoldenEntry& entry : entries) {
    if (!entry.orphan()) continue;
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

Exit prune(const Settings& settings) {
  if (auto may = check_may_decide(); !may) return refuse(may.errors());
  auto store = open_store();
  if (!store) return refuse(store.errors());
  const auto entries = list_goldens(*store, {store->folder() / ".."});
  if (!entries) return refuse(entries.errors());
  const std::vector<std::string> orphans = tell_orphans(*store, *entries, !settings.json);
  bool remove = settings.yes && !orphans.empty();
  if (!orphans.empty() && !settings.yes && !settings.json) {
    if (somebody_is_there())
      remove = asked_and_agreed();
    else
      fmt::print("--yes removes them\n");
  }
  std::vector<std::string> removed;
  Diagnostics problems;
  for (const std::string& name : remove ? orphans : std::vector<std::string>()) {
    if (auto done = store->remove(name); !done)
      problems.insert(problems.end(), done.errors().begin(), done.errors().end());
    else
      removed.push_back(name);
  }
  if (settings.json)
    print({{"orphans", orphans}, {"removed", removed}, {"problems", json_of(problems)}});
  else if (orphans.empty())
    fmt::print("nothing to remove\n");
  else if (remove)
    fmt::print("removed {}\n", count_text(std::ssize(removed), "golden"));
  if (!problems.empty()) return settings.json ? Exit::bad_input : refuse(problems);
  return removed.size() == orphans.size() ? Exit::done : Exit::differs;
}

}  // namespace

std::function<Exit()> declare_golden_prune(CLI::App& options) {
  const auto settings = std::make_shared<Settings>();
  options.add_flag("--yes", settings->yes, "remove them without asking");
  add_json_flag(options, settings->json);
  return [settings] { return prune(*settings); };
}

}  // namespace rehearse::tool
