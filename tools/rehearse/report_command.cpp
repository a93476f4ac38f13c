// rehearse report: writes an HTML page of a run for a browser, with its golden.
#include <fmt/format.h>
#include <rehearse/report.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command.h"
#include "core/guard/child_process.h"
#include "core/guard/interruption.h"
#include "options.h"
#include "output.h"
#include "output_file.h"
#include "progress.h"
#include "viewing/report/call_stack.h"
#include "wings.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

struct ReportSettings {
  std::string trace, golden, report;  // golden, report: empty if not given
  std::string tolerances;             // a file; empty: those of the golden's scenario
  std::string scenario;
  ReportOptions options;
  TimeSpan span;
  bool json = false;
  std::optional<double> megabytes;
  bool call_stack = false;
  bool coverage = false;
  HostOptions host;  // of the replay in gdb, and of that for the coverage
};

Json json_of_report(const fs::path& file, const ReportSummary& summary) {
  return {{"file", file.string()},
          {"link", report_link(file, summary.first_tick)},
          {"verdict", summary.verdict},
          {"state", summary.state},
          {"first_tick", summary.first_tick ? Json(*summary.first_tick) : Json()},
          {"begin", summary.begin},
          {"end", summary.end},
          {"bytes", summary.bytes},
          {"data_bytes", summary.data_bytes},
          {"omitted", summary.omitted}};
}

/// The coverage of the run, made by `rehearse audit --coverage`, which prints its errors. `exit`: its status.
Result<std::string> coverage_of(const ReportSettings& settings, Exit& exit) {
  const auto program = REHEARSE_TRY(program_of_wing("audit", "--coverage"));
  std::vector<std::string> words{program.string(), "audit", settings.trace, "--coverage", "--json"};
  for (const auto& [name, library] : settings.host.libraries)
    words.push_back(fmt::format("--controller={}={}", name, library));
  words.push_back(fmt::format("--call-limit={}", settings.host.call_limit));
  if (settings.host.memory_limit > 0.0) words.push_back(fmt::format("--memory-limit={}", settings.host.memory_limit));
  if (settings.options.until) words.push_back(fmt::format("--until={}", *settings.options.until));
  const auto output =
      REHEARSE_TRY(output_of({std::move(words), environment_with({}), {}, ChildProcess::Errors::shown}));
  if (interruption() != 0) throw Interrupted();
  exit = static_cast<Exit>(output.status.value_or(static_cast<int>(Exit::bad_input)));
  return output.text;
}

/// Checks options that only a replay needs.
Result<void> check_usage(const ReportSettings& settings, const CLI::App& options) {
  for (const char* option : {"--controller", "--call-limit", "--memory-limit"})
    if (options.count(option) > 0 && !settings.call_stack && !settings.coverage)
      return error(fmt::format("{} is of a replay, and this report needs none", option),
                   "--call-stack and --coverage replay the recording");
  return {};
}

Exit run_report(ReportSettings& settings, const CLI::App& options) {
  if (const auto usable = check_usage(settings, options); !usable) return refuse(usable.errors());
  if (!settings.tolerances.empty()) {
    auto rules = load_tolerances(settings.tolerances);
    if (!rules) return refuse(rules.errors());
    settings.options.tolerances = *std::move(rules);
  }
  const auto span = seconds_in(settings.span, settings.trace);
  if (!span) return refuse(span.errors());
  settings.options.from = span->from;
  settings.options.until = span->until;
  const fs::path file =
      settings.report.empty() ? fs::path(settings.trace).stem().concat(".html") : fs::path(settings.report);
  auto output = OutputFile::open(file.string(), settings.json);
  if (!output) return refuse(output.errors());
  settings.options.scenario = settings.scenario;
  if (settings.megabytes) settings.options.max_size = static_cast<std::uintmax_t>(1e6 * *settings.megabytes);
  std::optional<fs::path> golden;
  if (!settings.golden.empty()) golden = settings.golden;
  if (settings.call_stack)
    settings.options.call_stack = [&](const std::string& controller, const std::string& command, std::int64_t tick) {
      return call_stack_at(settings.trace, controller, command, tick, settings.host);
    };
  if (settings.coverage) {
    Exit audited = Exit::done;
    auto coverage = coverage_of(settings, audited);
    if (!coverage) return refuse(coverage.errors());
    if (audited != Exit::done && audited != Exit::controller_failed) return audited;
    settings.options.coverage = *std::move(coverage);
  }
  const auto written = [&] {
    StoppableProgress progress("reporting");
    settings.options.progress = [&](std::int64_t done, std::int64_t all) { progress.show(done, all); };
    return write_report(settings.trace, golden, output->path(), settings.options);
  }();
  if (!written) return refuse(written.errors());
  if (settings.json) {
    print(json_of_report(file, *written));
  } else {
    fmt::print("{}\n", written->verdict);
    if (output->path() == file)
      fmt::print("{}, {}\n", report_link(file, written->first_tick), file_size_text(written->bytes));
    std::fflush(stdout);
  }
  for (const std::string& sentence : written->omitted) fmt::print(stderr, "{}: note: {}\n", settings.trace, sentence);
  return send(*output, Exit::done);
}

std::function<Exit()> declare_report(CLI::App& options) {
  const auto settings = std::make_shared<ReportSettings>();
  options.add_option("TRACE", settings->trace, "the run")->required()->type_name("");
  options.add_option("GOLDEN", settings->golden, "the trace with the expected values, which are shown beside it")
      ->type_name("");
  options
      .add_option("-o,--output", settings->report,
                  "the file; - is stdout (TRACE's name with .html, in the working directory)")
      ->type_name("HTML");
  add_time_span(options, settings->span, "only what was recorded from this time on",
                "only what was recorded before this time");
  options
      .add_option("--topics", settings->options.topics,
                  "only series and pictures of topics that match one of these patterns; * stands for any text")
      ->type_name("GLOB")
      ->allow_extra_args(false);
  options
      .add_option("--tolerances", settings->tolerances, "YAML with a list of tolerances (those of GOLDEN's scenario)")
      ->type_name("FILE");
  options
      .add_option("--scenario", settings->scenario,
                  "the file TRACE was recorded from, beside which meshes are looked for (above TRACE, and here)")
      ->type_name("FILE");
  options.add_flag("--call-stack", settings->call_stack,
                   "with the source line that writes the command that differs first: replays TRACE in gdb, a minute "
                   "at most");
  options.add_flag("--coverage", settings->coverage,
                   "with the controllers' sources, and the tick in which each line runs first: replays TRACE");
  options
      .add_option("--max-size", settings->megabytes,
                  "about the largest size of the data in MB; a longer run is shown in part (28)")
      ->type_name("MB")
      ->check(CLI::Range(1.0, 2000.0));
  add_host_options(options, settings->host);
  add_json_flag(options, settings->json);
  return [settings, &options] { return run_report(*settings, options); };
}

}  // namespace

extern const Verb report_verb{"report",
                              "  rehearse report walk.mcap\n"
                              "  rehearse report today.mcap golden/SR1.Stands.mcap -o stands.html\n"
                              "  rehearse report walk.mcap --coverage\n"
                              "  rehearse report long.mcap --from 12 --until 20 --topics '/SR1/*'\n",
                              declare_report};

}  // namespace rehearse::tool
