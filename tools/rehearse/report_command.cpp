// rehearse report: writes an HTML page of a run for a browser, with its golden.
#include <fmt/format.h>
#include <rehearse/report.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "command.h"
#include "options.h"
#include "output.h"
#include "output_file.h"
#include "progress.h"
#include "viewing/report/call_stack.h"

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
  HostOptions host;  // of the replay in gdb
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

Exit run_report(ReportSettings& settings) {
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
  options
      .add_option("--max-size", settings->megabytes,
                  "about the largest size of the data in MB; a longer run is shown in part (28)")
      ->type_name("MB")
      ->check(CLI::Range(1.0, 2000.0));
  add_host_options(options, settings->host);
  options.get_option("--controller")->needs("--call-stack");
  options.get_option("--call-limit")->needs("--call-stack");
  add_json_flag(options, settings->json);
  return [settings] { return run_report(*settings); };
}

}  // namespace

const Verb report_verb{"report",
                       "  rehearse report walk.mcap\n"
                       "  rehearse report today.mcap golden/SR1.Stands.mcap -o stands.html\n"
                       "  rehearse report long.mcap --from 12 --until 20 --topics '/SR1/*'\n",
                       declare_report};

}  // namespace rehearse::tool
