// rehearse audit: finds out whether a controller is a function of its inputs, and if not, what it depends on.
#include <fmt/format.h>
#include <rehearse/audit.h>
#include <rehearse/coverage.h>
#include <rehearse/report.h>

#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "audit_mode.h"
#include "base/replaceable.h"
#include "base/write_hint.h"
#include "command.h"
#include "control_times.h"
#include "core/golden/stale_report.h"
#include "core/guard/interruption.h"
#include "core/host/turn_order_file.h"
#include "coverage_text.h"
#include "instruction_check.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "scratch_folder.h"
#include "wings.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

struct AuditSettings {
  std::vector<std::string> subjects;  // one, or several with --coverage
  CoverageFiles coverage_files;
  std::string output;  // with --virtualise: output file of the recording
  bool json = false;
  bool verbose = false;
  bool judge = false;  // the counts of instructions are compared with those beside the recordings
  AuditOptions audit;
  AuditedReplay replay;  // the task of this process; without a folder: audit
};

const char* words_for(Factor factor) {
  switch (factor) {
    case Factor::nothing: return "nothing: run again as it is";
    case Factor::memory: return "content of fresh and freed memory";
    case Factor::addresses: return "addresses";
    case Factor::environment: return "environment variables";
    case Factor::machine: return "machine, terminal, user, order of lists";
    case Factor::folder: return "working folder";
    case Factor::locale: return "locale, with a decimal comma";
    case Factor::clock: return "date, and how fast time runs";
    case Factor::random: return "random numbers";
    case Factor::threads: return "schedule of threads";
    case Factor::again: return "an earlier run in the process";
    case Factor::recording: return "recorded in closed loop";
  }
  return "";
}

std::string outcome_of(const FactorResult& result) {
  if (!result.not_varied.empty()) return "not varied: " + result.not_varied;
  if (!result.first) return "same";
  return fmt::format("differs at tick {}, {} {}", result.first->tick, result.first->channel, result.first->element);
}

template <class Call>
std::string ticks_of(const Call& call) {
  if (call.last_tick < 0) return "before the run";
  if (call.first_tick == call.last_tick) return fmt::format("tick {}", call.first_tick);
  return fmt::format("ticks {} to {}", std::max<std::int64_t>(0, call.first_tick), call.last_tick);
}

void tell_controller(const ControllerAudit& controller, bool named, bool verbose) {
  if (named) fmt::print("{}\n", controller.controller);
  std::vector<TableRow> factors{{"varied", "commands"}};
  for (const FactorResult& result : controller.factors)
    factors.push_back({words_for(result.factor), outcome_of(result)});
  if (factors.size() > 1) print_table(factors);
  if (!controller.calls.empty()) {
    std::vector<TableRow> calls{{"asked the system", "in", "when", "times", "reached a command"}};
    for (const AuditedCall& call : controller.calls)
      calls.push_back({call.function, fmt::format("{}, {}()", call.place, call.phase), ticks_of(call),
                       std::to_string(call.count),
                       std::string(to_string(call.reached)) + (call.note.empty() ? "" : ": " + call.note)});
    print_table(calls);
  }
  for (const AuditedCode& code : controller.code)
    if (verbose || code.kind != "imported_source") fmt::print("  note: {}\n", code.sentence);
}

/// The costs of control() after tick 0, or, with `in_time`, those of all other calls.
void tell_costs(const ControllerAudit& controller, bool in_time, bool verbose) {
  std::vector<TableRow> rows{{in_time ? "in time" : "may take too long", "in", "when", "times"}};
  for (const AuditedCost& cost : controller.costs) {
    if (cost.breaks_realtime() == in_time) continue;
    rows.push_back({fmt::format("{} by {}", cost.cost, cost.function), fmt::format("{}, {}()", cost.place, cost.phase),
                    ticks_of(cost), std::to_string(cost.count)});
    for (std::size_t i = 0; verbose && i < cost.callers.size(); ++i)
      rows.push_back({"", "called by " + cost.callers[i], "", ""});
  }
  if (rows.size() > 1) print_table(rows);
}

void tell_realtime(const AuditSettings& settings, const AuditReport& report) {
  fmt::print("{}\n", report.verdict);
  for (const ControllerAudit& controller : report.controllers) {
    if (report.controllers.size() > 1) fmt::print("{}\n", controller.controller);
    tell_page_faults(controller.page_faults);
    tell_costs(controller, false, settings.verbose);
    tell_costs(controller, true, settings.verbose);
  }
  std::fflush(stdout);  // before related output on stderr
  tell_remarks(report.remarks, report.failure);
}

void tell_instructions(const AuditReport& report) {
  fmt::print("{}\n", report.verdict);
  for (const ControllerAudit& controller : report.controllers) {
    if (!controller.instructions || controller.instructions->lines.empty()) continue;
    const InstructionCounts& counts = *controller.instructions;
    if (report.controllers.size() > 1) fmt::print("{}\n", controller.controller);
    std::vector<TableRow> rows{{fmt::format("instructions at tick {}", counts.most.tick), "line", "function"}};
    for (const InstructionCounts::Line& line : counts.lines)
      rows.push_back({std::to_string(line.instructions), line.line.empty() ? "unknown" : line.line, line.function});
    print_table(rows);
    if (counts.calls.front().tick == 0)
      fmt::print("  tick 0, which may take its time: {} instructions\n", counts.calls.front().instructions);
  }
  std::fflush(stdout);  // before related output on stderr
  tell_remarks(report.remarks, report.failure);
}

void tell_orders(const AuditReport& report) {
  fmt::print("{}\n", report.verdict);
  if (const fs::path& file = report.orders->file; !file.empty())
    fmt::print(
        "it is the order in {}, which replay --order repeats; it was order {}, and is reduced to {} exchange{}\n",
        file.string(), report.orders->tried, report.orders->exchanges.size(),
        report.orders->exchanges.size() == 1 ? "" : "s");
  std::fflush(stdout);  // before related output on stderr
  tell_remarks(report.remarks, report.failure);
}

void tell(const AuditSettings& settings, const AuditReport& report) {
  if (report.orders) return tell_orders(report);
  if (settings.audit.realtime) return tell_realtime(settings, report);
  if (settings.audit.instructions) return tell_instructions(report);
  fmt::print("{}\n", report.verdict);
  for (const ControllerAudit& controller : report.controllers)
    tell_controller(controller, report.controllers.size() > 1, settings.verbose);
  for (const std::string& found : report.memory_errors) fmt::print("  valgrind: {}\n", found);
  std::fflush(stdout);  // before related output on stderr
  tell_remarks(report.remarks, report.failure);
}

/// Executes the task that a parent process gave to this process.
Exit run_replay(AuditSettings& settings) {
  settings.replay.trace = settings.subjects.front();
  settings.replay.until = settings.audit.until;
  settings.replay.host = settings.audit;
  const auto done = make_audited_replay(settings.replay);
  return done ? Exit::done : refuse(done.errors());
}

Result<void> keep_recording(const AuditSettings& settings) {
  std::error_code failed;
  fs::copy_file(recording_of_audit(settings.audit.scratch), settings.output, fs::copy_options::overwrite_existing,
                failed);
  if (failed)
    return error(fmt::format("can't write {}: {}", settings.output, failed.message()),
                 write_hint(settings.output, "name another file with -o"));
  return {};
}

/// Prints the report of --coverage, and writes its files.
Exit finish(const AuditSettings& settings, const CoverageReport& report) {
  const auto& [lcov, html] = settings.coverage_files;
  if (!lcov.empty())
    if (const auto written = write_text(lcov, to_lcov(report)); !written) return refuse(written.errors());
  if constexpr (has_viewing)
    if (!html.empty())
      if (const auto written = write_coverage_page(to_json(report), html); !written) return refuse(written.errors());
  if (settings.json)
    print(Json::parse(to_json(report)));
  else
    tell_coverage(report, settings.verbose);
  if constexpr (has_viewing)
    if (!html.empty() && !settings.json) fmt::print("in a browser: {}\n", report_link(html));
  return report.failure ? Exit::controller_failed : Exit::done;
}

Exit finish(const AuditSettings& settings, const AuditReport& report) {
  if (!settings.output.empty())
    if (const auto kept = keep_recording(settings); !kept) return refuse(kept.errors());
  if (settings.json)
    print(Json::parse(to_json(report)));
  else
    tell(settings, report);
  if (!settings.output.empty() && !settings.json)
    fmt::print("recorded in {}: replay and check give it the same time and random numbers\n", settings.output);
  if (report.failure || report.controller_refused) return Exit::controller_failed;
  if (settings.audit.instructions) return Exit::done;
  if (settings.audit.realtime) return report.realtime_safe.value_or(false) ? Exit::done : Exit::differs;
  return report.deterministic ? Exit::done : Exit::differs;
}

/// Fails before the replays if the page of --html can't be written.
Result<void> check_page(const std::string& html) {
  if (html.empty()) return {};
  if constexpr (!has_viewing) {
    return left_out("--html", "viewing");
  } else {
    REHEARSE_TRY(report_page());
    return check_replaceable(html, report_magic, "report");
  }
}

/// Calls `examine`, which is interrupted by signals, and finishes with its report.
template <class Examine>
Exit examine_and_finish(AuditSettings& settings, const Examine& examine) {
  const auto report = [&] {
    Progress progress("auditing");
    settings.audit.progress = [&](const std::string&, int done, int all) { progress.show(done, all); };
    return examine();
  }();
  if (interruption() != 0) throw Interrupted();
  if (!report) return refuse(report.errors());
  return finish(settings, *report);
}

Exit run_audit(AuditSettings& settings) {
  if (!settings.replay.folder.empty()) return run_replay(settings);
  const std::string& subject = settings.subjects.front();
  if (settings.subjects.size() > 1 && !settings.audit.coverage && !settings.judge)
    return refuse(error("only --coverage examines several recordings: this examines one", "name it alone"));
  if (settings.audit.orders > 0) {
    settings.audit.order_file =
        settings.output.empty() ? fs::path(subject).stem().string() + ".order.json" : settings.output;
    settings.output.clear();
    if (const auto allowed = check_replaceable(settings.audit.order_file, turn_order_magic, "order of threads");
        !allowed)
      return refuse(allowed.errors());
  }
  if (!settings.output.empty() && !settings.audit.virtualise)
    return refuse(error("-o is the recording that --virtualise makes", "add --virtualise, or use rehearse record"));
  const std::string kind = fs::path(subject).extension().string();
  if (!settings.output.empty() && kind != ".yaml" && kind != ".yml")
    return refuse(error("-o is a new recording, which needs a scenario; " + subject + " is a recording"));
  if (!settings.output.empty())
    if (const auto allowed = check_replaceable(settings.output, mcap_magic, "trace"); !allowed)
      return refuse(allowed.errors());
  if (const auto able = check_page(settings.coverage_files.html); !able) return refuse(able.errors());
  end_runs_on_signals();
  const ScratchFolder scratch = ScratchFolder::temporary();
  if (scratch.path().empty())
    return refuse(error("there is no folder for temporary files", "TMPDIR names one that can be written to"));
  std::error_code failed;
  settings.audit.scratch = scratch.path();
  settings.audit.auditor = fs::read_symlink("/proc/self/exe", failed);
  settings.audit.recorder = settings.audit.auditor.parent_path() / "rehearse-simulate";
  settings.audit.should_stop = [] { return interruption() != 0; };
  if (settings.audit.coverage)
    return examine_and_finish(settings, [&] {
      return coverage({settings.subjects.begin(), settings.subjects.end()}, settings.audit);
    });
  if (settings.judge) return check_instructions(settings.subjects, settings.audit, settings.json);
  return examine_and_finish(settings, [&] { return audit(subject, settings.audit); });
}

std::function<Exit()> declare_audit(CLI::App& options) {
  const auto settings = std::make_shared<AuditSettings>();
  options
      .add_option("SCENARIO_OR_TRACE", settings->subjects,
                  "a YAML file, which is recorded first, or a recording, whose inputs are used; with --coverage also "
                  "several")
      ->required()
      ->type_name("");
  add_number(options, "--until", "end there [s]", 0.0, longest_time,
             [=](double until) { settings->audit.until = until; });
  add_integer(options, "--repeat", "replays under each change (1)", 1, 1000,
              [=](std::int64_t repeat) { settings->audit.repeat = static_cast<int>(repeat); });
  options.add_flag("--valgrind", settings->audit.valgrind, "one more replay under valgrind's memcheck; it is slow");
  options
      .add_flag("--realtime", settings->audit.realtime,
                "instead: list allocations, locks, system calls and exceptions of control(), with their lines")
      ->excludes(options.get_option("--valgrind"));
  options
      .add_flag("--instructions", settings->audit.instructions,
                "instead: count the instructions of each control() under valgrind, and list its most expensive lines")
      ->excludes(options.get_option("--valgrind"))
      ->excludes(options.get_option("--realtime"));
  options
      .add_flag("--coverage", settings->audit.coverage,
                "instead: list the lines of the controllers that the recordings never execute, by debug information")
      ->excludes(options.get_option("--valgrind"))
      ->excludes(options.get_option("--realtime"))
      ->excludes(options.get_option("--instructions"));
  add_coverage_files(options, settings->coverage_files);
  add_integer(options, "--orders",
              "instead: replay in so many other orders of the controllers' threads; an order that changes a command is "
              "reduced to few exchanges, and written",
              1, 1'000'000, [=](std::int64_t orders) { settings->audit.orders = static_cast<int>(orders); })
      ->excludes(options.get_option("--valgrind"))
      ->excludes(options.get_option("--realtime"))
      ->excludes(options.get_option("--instructions"))
      ->excludes(options.get_option("--coverage"));
  options.add_flag("--virtualise", settings->audit.virtualise,
                   "give the controllers simulated time and seeded random numbers instead of the system's");
  options
      .add_option("-o,--output", settings->output,
                  "with --virtualise: the trace to write; with --orders: the file of an order (NAME.order.json)")
      ->type_name("FILE");
  add_integer(options, "--seed", "of the random numbers that replace the system's, and of --orders (1)", 0,
              std::numeric_limits<std::uint32_t>::max(),
              [=](std::int64_t seed) { settings->audit.seed = static_cast<std::uint64_t>(seed); });
  options.add_flag(
      "-v,--verbose", settings->verbose,
      "also list functions that its library could call, and didn't; with --realtime the callers of each place, with "
      "--coverage all lines");
  add_host_options(options, settings->audit);
  add_json_flag(options, settings->json);
  // options for child processes: in no group, so that --help doesn't list them
  options.add_option("--replay-into", settings->replay.folder)->group("");
  options.add_option("--passes", settings->replay.passes)->group("");
  options.add_option("--padding", settings->replay.padding)->group("");
  options.add_option("--stack-fill", settings->replay.stack_fill)->group("");
  options.add_option("--order", settings->replay.order)->group("");
  options.add_flag("--costs", settings->replay.costs)->group("");
  options.add_flag("--executed", settings->replay.coverage)->group("");
  options.add_flag("--judge", settings->judge)->group("");
  options.add_flag("--profile", settings->replay.instructions)->group("");
  return [settings] { return run_audit(*settings); };
}

}  // namespace

extern const Verb audit_verb{"audit",
                             "  rehearse audit fixtures/scenarios/sr1_minimum.yaml\n"
                             "  rehearse audit walk.mcap --controller Walker=build/MyWalker.so --valgrind\n"
                             "  rehearse audit walk.mcap --realtime\n"
                             "  rehearse audit walk.mcap --instructions\n"
                             "  rehearse audit golden/*.mcap --coverage\n"
                             "  rehearse audit walk.yaml --virtualise -o walk.mcap\n",
                             declare_audit};

}  // namespace rehearse::tool
