// rehearse golden review: shows the pending runs one after the other; on a terminal a person decides.
#include <fmt/format.h>
#include <rehearse/compare.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "golden_verbs.h"
#include "options.h"
#include "terminal.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t plots_shown = 2, plots_in_detail = 8;
constexpr std::size_t most_in_full = 4;  // runs that are shown with tables and plots where nobody decides

struct GoldenReviewSettings {
  std::vector<std::string> names;
  bool json = false;
};

/// A pending run and its comparison with the golden.
struct Waiting {
  std::string name;
  std::optional<Trace> golden, run;
  std::optional<Comparison> comparison;
  Diagnostics problems;  // the reasons why there is no comparison; empty if there is no golden yet
};

Waiting waiting_run(const GoldenStore& store, const std::string& name) {
  Waiting waiting;
  waiting.name = name;
  const auto load = [&](const fs::path& file) -> std::optional<Trace> {
    auto trace = Trace::load(file);
    const auto known = trace ? check_version(*trace) : Result<void>(trace.errors());
    if (known) return *std::move(trace);
    waiting.problems.insert(waiting.problems.end(), known.errors().begin(), known.errors().end());
    return std::nullopt;
  };
  waiting.run = load(store.pending_file(name));
  if (store.has(name)) waiting.golden = load(store.trace_file(name));
  if (!waiting.run || !waiting.golden) return waiting;
  const auto rules = tolerances_of(*waiting.run);
  waiting.comparison = compare(*waiting.golden, *waiting.run, rules ? *rules : std::vector<ToleranceRule>());
  return waiting;
}

/// The PNG files that a check wrote beside the run.
std::vector<std::string> pictures_of(const GoldenStore& store, const std::string& name) {
  std::vector<std::string> files;
  std::error_code ignored;
  const fs::path folder = store.pending_file(name).parent_path();
  for (fs::directory_iterator entry(folder.empty() ? "." : folder, ignored), end; !ignored && entry != end;
       entry.increment(ignored)) {
    const std::string file = entry->path().filename().string();
    if (file.starts_with(name + ".") && file.ends_with(".png")) files.push_back(entry->path().string());
  }
  std::ranges::sort(files);
  return files;
}

std::string verdict_of(const GoldenStore& store, const Waiting& waiting) {
  if (waiting.comparison) {
    std::string judged = store.pending_verdict(waiting.name);
    return judged.empty() ? verdict(*waiting.comparison) : judged;
  }
  if (!waiting.problems.empty()) return "can't be compared: " + waiting.problems[0].message;
  return fmt::format("there is no golden {} yet: this run would be the first", store.trace_file(waiting.name).string());
}

void show(const GoldenStore& store, const Waiting& waiting, std::size_t place, std::size_t all) {
  fmt::print("{}/{}  {}\n", place, all, waiting.name);
  fmt::print("golden {}, run {}\n", store.trace_file(waiting.name).string(), store.pending_file(waiting.name).string());
  for (const Diagnostic& problem : waiting.problems) fmt::print("{}\n", in_lines(to_string(problem)));
  fmt::print("{}\n", in_lines(verdict_of(store, waiting)));
  if (waiting.run && !waiting.golden && waiting.problems.empty())
    fmt::print("  {} ticks, {:.6g} s, {} channels\n", waiting.run->ticks(), waiting.run->duration(),
               waiting.run->channels().size());
  if (waiting.comparison)
    fmt::print("{}{}", table(*waiting.comparison),
               worst_plots(*waiting.golden, *waiting.run, *waiting.comparison, plots_shown));
  for (const std::string& picture : pictures_of(store, waiting.name))
    fmt::print("expected, actual and difference: {}\n", picture);
}

void show_details(const GoldenStore& store, const Waiting& waiting) {
  if (waiting.golden) {
    const std::string history = history_text(history_of(waiting.golden->metadata()));
    fmt::print("the golden was accepted\n{}", history.empty() ? "  before acceptances were recorded\n" : history);
  }
  if (!waiting.comparison) return;
  fmt::print("changes\n");
  for (const ChannelComparison& channel : waiting.comparison->channels) {
    Comparison alone;
    alone.channels = {channel};
    for (const std::string& line : moved_lines(alone)) fmt::print("  {}\n", line);
  }
  for (const std::string& remark : waiting.comparison->remarks) fmt::print("  note: {}\n", in_lines(remark, 8));
  fmt::print("{}", worst_plots(*waiting.golden, *waiting.run, *waiting.comparison, plots_in_detail));
  fmt::print("more: rehearse diff {} {}\n", store.trace_file(waiting.name).string(),
             store.pending_file(waiting.name).string());
}

/// Three short lines, for one of many runs.
void show_briefly(const GoldenStore& store, const Waiting& waiting, std::size_t place, std::size_t all) {
  fmt::print("{}/{}  {}\n{}\n", place, all, waiting.name, in_lines(headline(verdict_of(store, waiting))));
  fmt::print("all of it: rehearse golden review {}\n", waiting.name);
}

/// Executes a decision and prints the result. Returns false if the run remains pending.
bool decide(GoldenStore& store, const std::string& name, char key) {
  if (key == 'a') {
    const auto accepted = store.accept_pending(name);
    if (!accepted) return refuse(accepted.errors()), false;
    if (accepted->changed)
      fmt::print("accepted: look at {} and commit both files\n", store.digest_file(name).string());
    else
      fmt::print("the golden is this run already: nothing was changed\n");
  } else {
    if (auto gone = store.reject(name); !gone) return refuse(gone.errors()), false;
    fmt::print("rejected: the golden stays as it is\n");
  }
  return true;
}

enum class Next { decided, skipped, quit };

Next ask(GoldenStore& store, const Waiting& waiting) {
  for (;;) {
    fmt::print("\n[a]ccept [r]eject [s]kip [d]etails [q]uit ");
    const char key = read_key("arsdq");
    fmt::print("{}\n", key == '\0' ? 'q' : key);
    if (key == 'd')
      show_details(store, waiting);
    else if (key == 's')
      return Next::skipped;
    else if (key == 'a' || key == 'r')
      return decide(store, waiting.name, key) ? Next::decided : Next::skipped;
    else
      return Next::quit;
  }
}

void tell_commands(const std::string& name) {
  fmt::print(
      "\n"
      "accept it: rehearse golden accept {0}\n"
      "a part:    rehearse golden accept {0} --channel GLOB --from S --until S\n"
      "reject it: rehearse golden reject {0}\n",
      name);
}

Json json_of_waiting(const GoldenStore& store, const Waiting& waiting) {
  Json object{{"name", waiting.name},
              {"golden", waiting.golden ? Json(store.trace_file(waiting.name).string()) : Json(nullptr)},
              {"run", store.pending_file(waiting.name).string()},
              {"verdict", verdict_of(store, waiting)},
              {"moved", waiting.comparison ? Json(moved_lines(*waiting.comparison)) : Json::array()},
              {"pictures", pictures_of(store, waiting.name)},
              {"problems", json_of(waiting.problems)}};
  return object;
}

Exit review(const GoldenReviewSettings& settings) {
  auto store = open_store();
  if (!store) return refuse(store.errors());
  const std::vector<std::string> waiting = store->pending();
  std::vector<std::string> names = settings.names.empty() ? waiting : settings.names;
  for (const std::string& name : names)
    if (!std::ranges::binary_search(waiting, name))
      return refuse(error(fmt::format("no run waits as '{}'", name), "rehearse golden review shows all that wait"));
  if (settings.json) {
    Json runs = Json::array();
    for (const std::string& name : names) runs.push_back(json_of_waiting(*store, waiting_run(*store, name)));
    print({{"waiting", runs}});
    return names.empty() ? Exit::done : Exit::differs;
  }
  if (names.empty()) fmt::print("nothing waits\n");
  const bool asks = somebody_is_there() && check_may_decide().ok();
  const bool are_many = !asks && settings.names.empty() && names.size() > most_in_full;
  std::size_t left = names.size();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Waiting run = waiting_run(*store, names[i]);
    if (i > 0) fmt::print("\n");
    if (are_many) {
      show_briefly(*store, run, i + 1, names.size());
      continue;
    }
    show(*store, run, i + 1, names.size());
    if (!asks) {
      tell_commands(run.name);
      continue;
    }
    const Next next = ask(*store, run);
    if (next == Next::quit) break;
    left -= next == Next::decided ? 1 : 0;
  }
  if (are_many) tell_commands("NAME");
  if (asks && left > 0) fmt::print("{} on\n", left == 1 ? "1 run waits" : fmt::format("{} runs wait", left));
  return left == 0 ? Exit::done : Exit::differs;
}

}  // namespace

std::function<Exit()> declare_golden_review(CLI::App& options) {
  const auto settings = std::make_shared<GoldenReviewSettings>();
  options.add_option("NAME", settings->names, "only these (all that wait)")->type_name("");
  add_json_flag(options, settings->json);
  return [settings] { return review(*settings); };
}

}  // namespace rehearse::tool
