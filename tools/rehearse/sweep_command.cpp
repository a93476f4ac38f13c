// rehearse sweep: runs many variations of a scenario, and reports, repeats and shrinks them.
#include <fmt/format.h>
#include <rehearse/campaign_report.h>
#include <rehearse/golden.h>
#include <rehearse/report.h>
#include <rehearse/session.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "campaigns/slurm/slurm.h"
#include "command.h"
#include "core/guard/interruption.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "scenario_text.h"
#include "side_by_side.h"
#include "sweep.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

std::string resume_advice(const std::string& folder) { return fmt::format("rehearse sweep resume {}", folder); }

/// "2/8" as a slice.
Result<Slice> slice_of(const std::string& text) {
  const std::size_t slash = text.find('/');
  Slice slice;
  constexpr std::int64_t most = 1'000'000;
  if (slash == std::string::npos)
    return error(fmt::format("--slice: '{}' is not I/N", text), "as 2/8, the second of eight");
  slice.index = parse_integer("--slice", text.substr(0, slash), 1, most);
  slice.count = parse_integer("--slice", text.substr(slash + 1), 1, most);
  if (slice.index > slice.count)
    return error(fmt::format("--slice: there is no slice {} of {}", slice.index, slice.count));
  return slice;
}

Exit exit_of(const CampaignSummary& summary) {
  if (!summary.unrepeated.empty() || !summary.never_tried().empty()) return Exit::differs;
  switch (summary.answer()) {
    case ClaimAnswer::passes: return Exit::done;
    case ClaimAnswer::fails: return Exit::differs;
    case ClaimAnswer::undecided: break;
  }
  return Exit::odd;
}

void tell_verdicts(const CampaignSummary& summary) {
  std::vector<TableRow> rows{{"verdict", "cases"}};
  for (std::size_t i = 0; i < case_verdict_count; ++i) {
    if (summary.verdicts[i] == 0) continue;
    const auto& [reason, count] = summary.reasons[i];
    std::string cases = fmt::format("{}", summary.verdicts[i]);
    if (count > 0) cases += ": " + plain_text(reason);
    if (count > 1) cases += fmt::format(", and {}", count_text(count - 1, "other reason"));
    rows.push_back({std::string(to_string(static_cast<CaseVerdict>(i))), cases});
  }
  if (summary.missing > 0) rows.push_back({"missing", fmt::format("{}", summary.missing)});
  print_table(rows);
}

/// The matrix of faults by expectations. An expectation is a column with its number.
void tell_faults(const CampaignSummary& summary) {
  if (summary.faults.empty()) return;
  const std::vector<FaultCell>& columns = summary.faults.front().cells;
  std::vector<TableRow> rows{{"fault", "cases"}};
  for (std::size_t i = 0; i < columns.size(); ++i) rows[0].push_back(fmt::format("({})", i + 1));
  for (const FaultRow& fault : summary.faults) {
    TableRow& row = rows.emplace_back(TableRow{plain_text(to_string(fault.fault)), fmt::format("{}", fault.cases)});
    for (const FaultCell& cell : fault.cells) row.push_back(plain_text(to_string(cell)));
  }
  print_table(rows);
  for (std::size_t i = 0; i < columns.size(); ++i) fmt::print("({}) {}\n", i + 1, plain_text(columns[i].expectation));
}

void tell_errors(const CampaignSummary& summary) {
  if (const std::string sentence = error_sentence(summary); !sentence.empty()) fmt::print("{}\n", sentence);
}

void tell_unrepeated(const CampaignSummary& summary) {
  if (summary.unrepeated.empty()) return;
  fmt::print(stderr,
             "error: case {} gave different bits in another process (to find the cause: rehearse audit, on a "
             "recording by rehearse sweep case)\n",
             summary.unrepeated.front());
}

std::int64_t passing(const std::vector<KeptFailure>& kept) {
  return std::ranges::count_if(kept, [](const KeptFailure& failure) { return failure.result.passed(); });
}

bool all_pass(const std::optional<std::vector<KeptFailure>>& kept) {
  return !kept || passing(*kept) == static_cast<std::int64_t>(kept->size());
}

Json json_of(const std::vector<KeptFailure>& kept) {
  Json list = Json::array();
  for (const auto& [file, result] : kept)
    list.push_back(
        {{"file", file.string()}, {"verdict", std::string(to_string(result.verdict))}, {"sentence", result.sentence}});
  return list;
}

/// Runs the failures that the project keeps, and names those that fail again.
Exit run_kept(const Campaign& campaign, SweepSettings& settings) {
  auto kept = run_kept_failures(campaign, simulation());
  if (!kept && interruption() != 0) return static_cast<Exit>(128 + interruption());
  if (!kept) return refuse(kept.errors());
  settings.kept = *std::move(kept);
  if (!settings.kept->empty() && !settings.json)
    fmt::print("kept failures: {} of {} pass\n", passing(*settings.kept), settings.kept->size());
  std::fflush(stdout);
  for (const auto& [file, result] : *settings.kept)
    if (!result.passed())
      fmt::print(stderr, "{}: error: this kept failure fails again: {}: {}\n", file.string(), to_string(result.verdict),
                 plain_text(result.sentence));
  return Exit::done;
}

/// Writes the report and prints the summary.
Exit finish(const Campaign& campaign, const SweepSettings& settings, const Campaign* against) {
  const auto summary = write_campaign_report(campaign, against, settings.margin);
  if (!summary) return refuse(summary.errors());
  const fs::path page = campaign.folder() / "report.html";
  if (settings.json) {
    Json object = Json::parse(to_json(*summary));
    object["report"] = page.string();
    if (settings.kept) object["kept_failures"] = json_of(*settings.kept);
    print(object);
  } else {
    tell_verdicts(*summary);
    fmt::print("{}\n", verdict(*summary));
    tell_faults(*summary);
    tell_errors(*summary);
    if (campaign.nominal().verdict != CaseVerdict::passed)
      fmt::print("the nominal scenario fails: {}\n", plain_text(campaign.nominal().sentence));
    if (summary->missing > 0) fmt::print("go on: {}\n", resume_advice(settings.folder));
    if (against)
      for (const std::string& difference : differences(*against, campaign))
        fmt::print("differs from {}: {}\n", settings.against, plain_text(difference));
    fmt::print("report: {}\n", page.string());
  }
  std::fflush(stdout);
  tell_unrepeated(*summary);
  return all_pass(settings.kept) ? exit_of(*summary) : Exit::differs;
}

Exit work_on(Campaign& campaign, SweepSettings& settings) {
  settings.sweep.jobs = settings.jobs > 0 ? static_cast<std::size_t>(settings.jobs) : processors();
  {
    Progress progress("sweeping");
    settings.sweep.progress = [&](const SweepProgress& now) {
      const double rate = now.seconds > 0.0 ? static_cast<double>(now.here) / now.seconds : 0.0;
      progress.set_text(fmt::format("{} of {}, {} failed, {:.3g} cases/s", now.done, now.all, now.failed, rate));
      progress.show(now.here, now.here + now.all - now.done);
      return true;
    };
    if (auto worked = run_cases(campaign, settings.sweep, simulation()); !worked) return refuse(worked.errors());
  }
  if (interruption() == 0) return Exit::done;
  fmt::print(stderr, "interrupted; the results so far are kept ({})\n", resume_advice(settings.folder));
  return static_cast<Exit>(128 + interruption());
}

Exit submit(const Campaign& campaign, const SweepSettings& settings) {
  const auto submitted = submit_to_slurm(campaign, settings.slurm);
  if (!submitted) return refuse(submitted.errors());
  fmt::print("{}\nits state: rehearse sweep status {}\n", *submitted, settings.folder);
  return Exit::done;
}

Exit work_and_finish(Campaign& campaign, SweepSettings& settings) {
  if (const Exit kept = run_kept(campaign, settings); kept != Exit::done) return kept;
  const Exit worked = work_on(campaign, settings);
  return worked == Exit::done ? finish(campaign, settings, nullptr) : worked;
}

Result<fs::path> golden_of(const std::string& file) {
  const auto scenario = REHEARSE_TRY(Scenario::load(file));
  if (scenario.golden.empty()) return error_in(file, "--golden: the scenario names no golden");
  const auto folder = REHEARSE_TRY(find_golden_folder(file));
  const fs::path trace = GoldenStore(folder).trace_file(scenario.golden);
  std::error_code ignored;
  if (!fs::exists(trace, ignored)) return error_in(trace.string(), "the golden doesn't exist");
  return fs::absolute(trace, ignored);
}

/// Libraries that are named by a path are found from any folder.
void make_libraries_absolute(HostOptions& host) {
  std::error_code ignored;
  for (auto& [controller, library] : host.libraries)
    if (library.find('/') != std::string::npos) library = fs::absolute(library, ignored).string();
}

/// Words after -- without --slurm are mistakes.
Result<void> check_slurm_options(const SweepSettings& settings) {
  if (settings.in_slurm || settings.slurm.sbatch.empty()) return {};
  return error(fmt::format("'{}' is no option of sweep", settings.slurm.sbatch.front()),
               "options after -- are those of sbatch, with --slurm");
}

Exit run_new(SweepSettings& settings) {
  if (settings.scenario.empty())
    return refuse(error("rehearse sweep: SCENARIO is required", "or resume, work, status, report, case, shrink"));
  if (settings.folder.empty()) return refuse(error("-o is required", "expected -o DIR, a new folder"));
  if (const auto allowed = check_slurm_options(settings); !allowed) return refuse(allowed.errors());
  end_runs_on_signals();
  make_libraries_absolute(settings.campaign.host);
  if (settings.golden) {
    auto golden = golden_of(settings.scenario);
    if (!golden) return refuse(golden.errors());
    settings.campaign.golden = *std::move(golden);
  }
  if (!settings.search.expectation.empty()) return run_search(settings);
  auto campaign = create_campaign(settings.scenario, settings.folder, settings.campaign, simulation());
  if (!campaign) return refuse(campaign.errors());
  tell_warnings(campaign->scenario());
  if (settings.in_slurm) return submit(*campaign, settings);
  if (!settings.plan) return work_and_finish(*campaign, settings);
  fmt::print("{}: {}\n", campaign->folder().string(), count_text(campaign->options().cases, "case"));
  if (const auto claim = summary_of(*campaign); claim && claim->claim)
    fmt::print("{}\n", plan_sentence(*claim->claim, campaign->options().cases));
  return Exit::done;
}

Exit run_resume(SweepSettings& settings) {
  end_runs_on_signals();
  if (const auto allowed = check_slurm_options(settings); !allowed) return refuse(allowed.errors());
  auto campaign = Campaign::open(settings.folder);
  if (!campaign) return refuse(campaign.errors());
  if (settings.in_slurm) return submit(*campaign, settings);
  if (const auto free = check_slurm_queue(*campaign); !free) return refuse(free.errors());
  return work_and_finish(*campaign, settings);
}

Exit run_work(SweepSettings& settings) {
  end_runs_on_signals();
  auto slice = slice_of(settings.slice);
  if (!slice) return refuse(slice.errors());
  settings.sweep.slice = *slice;
  if (settings.jobs == 0) settings.jobs = 1;
  auto campaign = Campaign::open(settings.folder);
  return campaign ? work_on(*campaign, settings) : refuse(campaign.errors());
}

Exit run_status(SweepSettings& settings) {
  const auto campaign = Campaign::open(settings.folder);
  if (!campaign) return refuse(campaign.errors());
  const auto summary = summary_of(*campaign);
  if (!summary) return refuse(summary.errors());
  const auto queue = is_in_slurm(*campaign) ? slurm_queue(*campaign) : Result<SlurmQueue>(SlurmQueue{});
  if (!queue) fmt::print(stderr, "warning: {}\n", to_string(queue.errors()));
  if (settings.json) {
    Json object = Json::parse(to_json(*summary));
    if (is_in_slurm(*campaign) && queue) object["slurm"] = {{"running", queue->running}, {"waiting", queue->waiting}};
    print(object);
  } else {
    tell_verdicts(*summary);
    fmt::print("{}\n", verdict(*summary));
    tell_errors(*summary);
    if (is_in_slurm(*campaign) && queue) fmt::print("{}\n", to_string(*queue));
    const bool is_at_work = queue && queue->running + queue->waiting > 0;
    if (summary->missing > 0 && !is_at_work)
      fmt::print("go on: {}{}\n", resume_advice(settings.folder), is_in_slurm(*campaign) ? " --slurm" : "");
  }
  std::fflush(stdout);
  tell_unrepeated(*summary);
  return Exit::done;
}

Exit run_report(SweepSettings& settings) {
  const auto campaign = Campaign::open(settings.folder);
  if (!campaign) return refuse(campaign.errors());
  if (settings.against.empty()) return finish(*campaign, settings, nullptr);
  const auto against = Campaign::open(settings.against);
  return against ? finish(*campaign, settings, &*against) : refuse(against.errors());
}

using Settings = std::shared_ptr<SweepSettings>;

void add_jobs(CLI::App& options, const Settings& settings) {
  add_integer(options, "-j,--jobs", "worker processes (one for each processor)", 1, 1024,
              [settings](std::int64_t jobs) { settings->jobs = jobs; });
}

CLI::App& declare_sub(CLI::App& options, const Settings& settings, const char* name, const char* help) {
  CLI::App& sub = *options.add_subcommand(name, help);
  if (std::string_view(name) == "case" || std::string_view(name) == "shrink") {
    sub.add_option_function<std::string>(
           "K",
           [settings](const std::string& text) {
             settings->number = parse_integer("K", text, 0, std::numeric_limits<std::int64_t>::max());
           },
           "number of the case")
        ->required()
        ->type_name("");
  }
  sub.add_option("DIR", settings->folder, "the campaign's folder")->required()->type_name("");
  if (std::string_view(name) != "work") add_json_flag(sub, settings->json);
  return sub;
}

void add_slurm(CLI::App& options, const Settings& settings) {
  options.add_flag("--slurm", settings->in_slurm, "run the cases as array jobs of Slurm; after --: options of sbatch");
  add_integer(options, "--tasks", "tasks of Slurm (each has 30 s of work, at most 1000)", 1, 1'000'000,
              [settings](std::int64_t tasks) { settings->slurm.tasks = tasks; });
  options.get_option("--tasks")->needs("--slurm");
  for (const char* option : {"--jobs", "--until-failures"}) options.get_option("--slurm")->excludes(option);
  options.add_option("SBATCH", settings->slurm.sbatch, "options of sbatch, after --")->type_name("");
}

/// The end of the work before its last case.
void add_until_failures(CLI::App& options, const Settings& settings) {
  add_integer(options, "--until-failures", "end when so many cases have failed (run all)", 1, 1'000'000'000,
              [settings](std::int64_t failures) { settings->sweep.most_failures = failures; });
}

void add_search(CLI::App& options, const Settings& settings) {
  options
      .add_option("--towards", settings->search.expectation,
                  "steer the parameters in rounds of --cases towards the failure of an expectation")
      ->type_name("TEXT");
  options.add_option("--over", settings->search.over, "of --towards: the parameters to steer (all with a range)")
      ->type_name("NAME")
      ->delimiter(',');
  add_integer(options, "--rounds", "of --towards: at most (6)", 1, 1000,
              [settings](std::int64_t rounds) { settings->search.rounds = static_cast<int>(rounds); });
  add_integer(options, "--estimate", "of --towards: cases that estimate the probability of a violation (none)", 1,
              100'000'000, [settings](std::int64_t cases) { settings->search.estimate = cases; });
  for (const char* option : {"--over", "--rounds", "--estimate"}) options.get_option(option)->needs("--towards");
}

void declare_new(CLI::App& options, const Settings& settings) {
  options.add_option("SCENARIO", settings->scenario, "a YAML file with vary:")->type_name("");
  options.add_option("-o,--output", settings->folder, "the folder of the campaign, a new one")->type_name("DIR");
  add_integer(options, "--cases", "how many (all combinations of the grids)", 1, 100'000'000,
              [settings](std::int64_t cases) { settings->campaign.cases = cases; });
  add_integer(options, "--seed", "of the campaign's values (0)", 0, std::numeric_limits<std::int64_t>::max(),
              [settings](std::int64_t seed) { settings->campaign.seed = static_cast<std::uint64_t>(seed); });
  options.add_flag("--plan", settings->plan, "write the plan, and run no case");
  options.add_flag("--golden", settings->golden, "compare each case with the scenario's golden, too");
  add_integer(options, "--keep", "how many traces to keep of each kind of failure (3)", 0, 1'000'000,
              [settings](std::int64_t keep) { settings->campaign.keep = static_cast<int>(keep); });
  add_number(options, "--case-limit", "wall time of a case [s]; a longer one counts as hung (600)", 0.1, 1e6,
             [settings](double limit) { settings->campaign.case_limit = limit; });
  add_host_options(options, settings->campaign.host);
  add_jobs(options, settings);
  add_until_failures(options, settings);
  add_search(options, settings);
  add_slurm(options, settings);
  options.get_option("--plan")->excludes("--slurm")->excludes("--towards");
  options.get_option("--towards")->excludes("--slurm");
  add_json_flag(options, settings->json);
}

std::function<Exit()> declare_sweep(CLI::App& options) {
  const auto settings = std::make_shared<SweepSettings>();
  declare_new(options, settings);
  options.require_subcommand(0, 1);
  std::vector<std::pair<CLI::App*, Exit (*)(SweepSettings&)>> subs;
  const auto declare = [&](const char* name, const char* help, Exit (*run)(SweepSettings&)) -> CLI::App& {
    CLI::App& sub = declare_sub(options, settings, name, help);
    subs.emplace_back(&sub, run);
    return sub;
  };
  CLI::App& resume = declare("resume", "run the cases that have no result", run_resume);
  add_jobs(resume, settings);
  add_until_failures(resume, settings);
  add_slurm(resume, settings);
  CLI::App& work = declare("work", "run a slice of the cases, as a task of a cluster does", run_work);
  work.add_option("--slice", settings->slice, "the Ith of N slices")->required()->type_name("I/N");
  add_jobs(work, settings);
  declare("status", "count the results so far", run_status);
  CLI::App& report = declare("report", "write report.html, report.md, report.json and results.csv", run_report);
  report.add_option("--against", settings->against, "a campaign with the same plan, before a change")->type_name("DIR");
  constexpr double least_margin = 1e-6;
  add_number(report, "--margin", "of --against: the share that passes must not be smaller by so much (no claim)",
             least_margin, 1.0 - least_margin, [settings](double margin) { settings->margin = margin; });
  report.get_option("--margin")->needs("--against");
  declare("case", "record a case again", run_case_again)
      .add_option("-o,--output", settings->output, "the trace to write (DIR/traces/case-K.mcap)")
      ->type_name("TRACE");
  CLI::App& shrinking =
      declare("shrink", "find the smallest change of the nominal scenario that fails like a case", run_shrink);
  shrinking.add_option("-o,--output", settings->output, "the scenario to write (DIR/shrunk-K.yaml)")->type_name("FILE");
  add_integer(shrinking, "--budget", "runs at most (500)", 1, 1'000'000,
              [settings](std::int64_t budget) { settings->shrink.budget = static_cast<int>(budget); });
  return [settings, subs] {
    for (const auto& [sub, run] : subs)
      if (sub->parsed()) return run(*settings);
    return run_new(*settings);
  };
}

}  // namespace

Simulation simulation() { return {record, run_plant, describe_plant, record_from}; }

extern const Verb sweep_verb{"sweep",
                             "  rehearse sweep fixtures/campaigns/push.yaml --cases 200 -o pushed\n"
                             "  rehearse sweep status pushed\n"
                             "  rehearse sweep case 17 pushed\n"
                             "  rehearse sweep shrink 17 pushed -o smallest.yaml\n"
                             "  rehearse sweep report after --against before\n",
                             declare_sweep};

}  // namespace rehearse::tool
