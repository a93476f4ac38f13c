// rehearse golden accept and reject: accepts or rejects runs without a terminal.
#include <fmt/format.h>
#include <rehearse/session.h>

#include <memory>
#include <utility>

#include "core/check/own_run.h"
#include "core/guard/own_process.h"
#include "core/guard/supervise.h"
#include "golden_verbs.h"
#include "options.h"

namespace rehearse::tool {
namespace {

struct GoldenAcceptSettings {
  std::vector<std::string> names;
  bool all = false;
  bool json = false;
  Selection selection;    // of accept
  TimeSpan span;          // likewise
  Reexecution again;      // of accept
  std::string recording;  // of accept: the run, instead of the one that waits; empty: that one
};

Json json_of_accepted(const GoldenStore& store, const std::string& name, const Accepted& accepted) {
  return {{"name", name},
          {"golden", store.trace_file(name).string()},
          {"digest", store.digest_file(name).string()},
          {"changed", accepted.changed},
          {"whole", accepted.whole},
          {"verdict", accepted.moved ? Json(accepted.verdict) : Json(nullptr)},
          {"moved", accepted.moved ? Json(moved_lines(*accepted.moved)) : Json::array()}};
}

/// Processes the goldens one after the other, whether or not others fail. `decide` returns the golden's JSON object.
Exit decide_all(const GoldenAcceptSettings& settings, const char* done_word,
                const std::function<Result<Json>(GoldenStore&, const std::string&)>& decide) {
  if (auto may = check_may_decide(); !may) return refuse(may.errors());
  if (auto chosen = check_choice(settings.names, settings.all); !chosen) return refuse(chosen.errors());
  auto store = open_store();
  if (!store) return refuse(store.errors());
  const std::vector<std::string> names = settings.all ? store->pending() : settings.names;
  if (names.empty() && !settings.json) fmt::print("nothing waits\n");
  Json done = Json::array(), refused = Json::array();
  Exit worst = Exit::done;
  for (const std::string& name : names) {
    auto decided = decide(*store, name);
    if (decided) {
      done.push_back(*std::move(decided));
      continue;
    }
    worst = Exit::bad_input;
    refused.push_back({{"name", name}, {"findings", json_of(decided.errors())}});
    std::fflush(stdout);
    if (!settings.json) refuse(decided.errors());
  }
  if (settings.json) print({{done_word, done}, {"refused", refused}});
  return worst;
}

/// Adds the scenarios that name the golden.
Reexecution again_for(const GoldenAcceptSettings& settings, const GoldenStore& store, const std::string& name) {
  Reexecution again = settings.again;
  again.replay = own_replay;
  if (settings.selection.is_all() && settings.span.is_all()) return again;  // no run is executed again
  const auto owners = find_golden_owners(store.folder(), {store.folder() / ".."});
  if (const auto known = owners.find(name); known != owners.end())
    again.scenarios.assign(known->second.scenarios.begin(), known->second.scenarios.end());
  return again;
}

Result<Accepted> accept_waiting(const GoldenAcceptSettings& settings, GoldenStore& store, const std::string& name) {
  const auto span = REHEARSE_TRY(seconds_in(settings.span, store.pending_file(name).string()));
  Selection selection = settings.selection;
  selection.from = span.from.value_or(0.0);
  selection.until = span.until;
  return store.accept_pending(name, selection, again_for(settings, store, name));
}

Exit accept(const GoldenAcceptSettings& settings) {
  if (!settings.recording.empty() && settings.names.size() != 1)
    return refuse(error("--recording becomes one golden: state its name alone",
                        "rehearse golden accept Suite.Test "
                        "--recording " +
                            settings.recording));
  supervise_process();
  begin_own_processes();
  return decide_all(settings, "accepted", [&](GoldenStore& store, const std::string& name) -> Result<Json> {
    const auto accepted = REHEARSE_TRY(settings.recording.empty() ? accept_waiting(settings, store, name)
                                                                  : store.accept(name, settings.recording));
    if (!settings.json) tell_accepted(store, name, accepted);
    return json_of_accepted(store, name, accepted);
  });
}

Exit reject(const GoldenAcceptSettings& settings) {
  return decide_all(settings, "rejected", [&](GoldenStore& store, const std::string& name) -> Result<Json> {
    REHEARSE_TRY(store.reject(name));
    if (!settings.json) fmt::print("rejected {}: the golden stays as it is\n", name);
    return Json(name);
  });
}

std::shared_ptr<GoldenAcceptSettings> declare_names(CLI::App& options) {
  const auto settings = std::make_shared<GoldenAcceptSettings>();
  options.add_option("NAME", settings->names, "Suite.Test, one or more")->type_name("");
  options.add_flag("--all", settings->all, "all runs that wait");
  add_json_flag(options, settings->json);
  return settings;
}

}  // namespace

void tell_accepted(const GoldenStore& store, const std::string& name, const Accepted& accepted) {
  const std::string golden = store.trace_file(name).string();
  if (!accepted.changed) {
    fmt::print("{} is this run already: nothing was changed\n", golden);
    return;
  }
  fmt::print("accepted {}{}\n", golden, accepted.whole ? "" : ", in part: the run waits on");
  if (accepted.moved)
    fmt::print("{}\n{}", accepted.verdict, table(*accepted.moved));
  else
    fmt::print("there was no readable golden before it\n");
  fmt::print("look at {} and commit both files\n", store.digest_file(name).string());
}

std::function<Exit()> declare_golden_accept(CLI::App& options) {
  const auto settings = declare_names(options);
  options
      .add_option("--channel", settings->selection.channels,
                  "only these channels or series, * for any text; only if a run can produce the result")
      ->type_name("GLOB")
      ->allow_extra_args(false);
  add_time_span(options, settings->span, "only from this time on", "only up to this time");
  options
      .add_option(
          "--recording", settings->recording,
          "this recording becomes the golden, instead of a run that waits: a robot's flight, for EXPECT_REPLAYS")
      ->type_name("FILE")
      ->excludes(options.get_option("--all"), options.get_option("--channel"), options.get_option("--from"),
                 options.get_option("--until"));
  add_host_options(options, settings->again.host);
  settings->again.run_plant = own_plant(run_plant);
  return [settings] { return accept(*settings); };
}

std::function<Exit()> declare_golden_reject(CLI::App& options) {
  const auto settings = declare_names(options);
  return [settings] { return reject(*settings); };
}

}  // namespace rehearse::tool
