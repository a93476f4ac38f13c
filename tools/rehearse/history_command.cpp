// rehearse history: how the margins of a project's expectations go on over its commits.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "command.h"
#include "options.h"
#include "output.h"
#include "viewing/history/history.h"
#include "viewing/history/history_page.h"
#include "viewing/history/trends.h"

namespace rehearse::tool {
namespace {

struct HistorySettings {
  std::string file;
  std::string html;  // a page to write; empty: none
  TrendOptions trends;
  bool fail_on_drift = false;
  bool json = false;
};

Exit run_history(const HistorySettings& settings) {
  const auto history = read_history(settings.file);
  if (!history) return refuse(history.errors());
  if (history->lines.empty()) {
    if (!history->bad.empty()) return refuse(history->bad);
    return refuse(error_in(settings.file, "the history has no line", "rehearse check --history FILE appends them"));
  }
  const Trends trends = trends_of(history->lines, settings.trends);
  if (!settings.html.empty())
    if (const auto written = write_history_page(trends, settings.html); !written) return refuse(written.errors());
  if (settings.json) {
    Json object = json_of(trends);
    object["errors"] = json_of(history->bad);
    print(object);
  } else {
    const TextColor color = trends.drifts() || !trends.flaky.empty() ? TextColor::red : TextColor::green;
    fmt::print("{}\n{}", colored(verdict(trends), color), text_of(trends));
    if (!settings.html.empty()) fmt::print("wrote {}\n", settings.html);
  }
  std::fflush(stdout);  // before related output on stderr
  std::fputs(to_string(history->bad).c_str(), stderr);
  if (!history->bad.empty()) return Exit::bad_input;
  return settings.fail_on_drift && trends.drifts() ? Exit::differs : Exit::done;
}

std::function<Exit()> declare_history(CLI::App& options) {
  const auto settings = std::make_shared<HistorySettings>();
  options.add_option("FILE", settings->file, "a history, as rehearse check --history appends it")
      ->required()
      ->type_name("");
  options.add_option("--html", settings->html, "write one page for a browser, too")->type_name("FILE");
  add_integer(options, "--last", "judge the margins of so many commits, the newest (20)", 2, 1'000'000,
              [=](std::int64_t last) { settings->trends.last = static_cast<std::size_t>(last); });
  add_number(options, "--significance", "the probability that a history without drift is said to drift (0.05)", 1e-12,
             0.5, [=](double significance) { settings->trends.significance = significance; });
  add_number(options, "--least-change", "changes of a margin below this share of it are no drift and no jump (0.01)",
             0.0, 1e6, [=](double share) { settings->trends.least_change = share; });
  options.add_flag("--fail-on-drift", settings->fail_on_drift,
                   "fail (status 1) if a margin drifts towards a violation");
  add_json_flag(options, settings->json);
  return [settings] { return run_history(*settings); };
}

}  // namespace

extern const Verb history_verb{"history",
                               "  rehearse check --history history.jsonl --date 2026-11-27\n"
                               "  rehearse history history.jsonl\n"
                               "  rehearse history history.jsonl --fail-on-drift --html build/history.html\n",
                               declare_history};

}  // namespace rehearse::tool
