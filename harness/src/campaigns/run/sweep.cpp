// The work on a campaign: cases are given to workers, and their results are appended.
#include <fmt/format.h>
#include <rehearse/sweep.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "campaigns/plan/campaign_folder.h"
#include "campaigns/plan/finished_cases.h"
#include "campaigns/plan/result_lines.h"
#include "case_run.h"
#include "core/golden/run_folder.h"
#include "core/guard/interruption.h"
#include "core/guard/worker_pool.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr const char* trace_name = "run.mcap";
constexpr const char* new_campaign =
    "begin another campaign in a new folder, and compare: rehearse sweep report NEW --against OLD";
// these begin answers of workers that aren't results
const std::string refusal = "refused: ", hindrance = "hindered: ";

Diagnostic interrupted() { return error("interrupted: nothing was judged"); }

/// The result of a case whose worker has ended.
CaseResult lost_case(std::int64_t number, const WorkerPool::Answer& answer, const CampaignOptions& options) {
  if (answer.exceeded == WorkerPool::Answer::Limit::time)
    return ended_case(number, CaseVerdict::hung, fmt::format("the case took longer than {} s", options.case_limit));
  if (answer.exceeded == WorkerPool::Answer::Limit::memory)
    return ended_case(number, CaseVerdict::crashed,
                      options.host.memory_limit > 0.0
                          ? fmt::format("the case took more than {:.0f} MB of memory", options.host.memory_limit)
                          : "the case took more than four fifths of the available memory");
  return ended_case(number, CaseVerdict::crashed, fmt::format("the process of the case ended {}", answer.end));
}

WorkerPool::Setup workers(const CampaignOptions& options, std::size_t size, const fs::path& folder) {
  return {WorkerPool::Kind::bare, size, {options.case_limit, options.host.memory_limit * 1e6}, folder};
}

Result<CaseRun> timed_case(const fs::path& file, const std::string& text, const CampaignOptions& options,
                           const fs::path& trace, const Simulation& simulation) {
  const Clock::time_point begin = Clock::now();
  auto run = run_case(file, text, options, trace, simulation);
  if (run) run->result.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  return run;
}

/// The environment prevented a case in two processes. The case has no result, so that it is run again.
Diagnostic hindered(const Campaign& campaign, std::int64_t number, const std::string& why) {
  return error_in(
      campaign.folder().string(), fmt::format("case {} can't be run here: {}", number, why),
      fmt::format("it has no result; remove the cause, then: rehearse sweep resume {}", campaign.folder().string()));
}

/// Keeps the trace of a failure if its case is among the lowest of its verdict. All kept traces are found by the names
/// of their files, because other processes may keep traces there, too.
void keep_trace(const Campaign& campaign, const CaseResult& result, const fs::path& trace) {
  std::error_code ignored;
  if (result.passed() || !fs::exists(trace, ignored)) return;
  const fs::path kept = kept_trace_file(campaign.folder(), result);
  std::map<std::int64_t, fs::path> by_case{{result.number, kept}};
  for (fs::directory_iterator entry(kept.parent_path(), ignored), end; !ignored && entry != end;
       entry.increment(ignored))
    if (const auto number = case_of_kept_trace(entry->path(), result.verdict)) by_case[*number] = entry->path();
  fs::rename(trace, kept, ignored);
  const auto most = static_cast<std::size_t>(campaign.options().keep);
  for (; by_case.size() > most; by_case.erase(std::prev(by_case.end())))
    fs::remove(std::prev(by_case.end())->second, ignored);
}

/// The cases of one process.
class Work {
 public:
  Work(const Campaign& campaign, const SweepOptions& options, ResultFile& file, WorkerPool& pool)
      : campaign_(campaign), options_(options), file_(file), pool_(pool), done_(campaign) {}

  Result<void> run();
  bool ended_by_failures() const { return progress_.failed >= options_.most_failures; }

 private:
  enum class Phase { first, again };
  Result<void> read_results();
  std::deque<std::int64_t> queue_of(Phase phase);
  Result<void> run_queue(Phase phase);
  Result<void> take(const WorkerPool::Answer& answer, Phase phase);
  CaseResult result_of(const WorkerPool::Answer& answer) const;
  bool goes_on();

  const Campaign& campaign_;
  const SweepOptions& options_;
  ResultFile& file_;
  WorkerPool& pool_;
  FinishedCases done_;
  std::deque<std::int64_t> queue_;
  std::set<std::int64_t> lost_;  // cases whose worker ended once
  SweepProgress progress_;
  Clock::time_point begin_ = Clock::now();
};

Result<void> Work::read_results() {
  return campaign_.read_results([&](const CaseResult& result) {
    if (!result.again && !result.passed() && !done_.first[static_cast<std::size_t>(result.number)]) ++progress_.failed;
    done_.take(result);
  });
}

std::deque<std::int64_t> Work::queue_of(Phase phase) {
  const bool again = phase == Phase::again;
  const Slice slice = options_.slice.value_or(Slice{});
  std::deque<std::int64_t> queue;
  for (std::int64_t number = again ? slice.first_second_run() : slice.first_case(); number < campaign_.options().cases;
       number += slice.count) {
    if (again && !campaign_.runs_twice(number)) continue;
    ++progress_.all;
    const bool is_done = (again ? done_.again : done_.first)[static_cast<std::size_t>(number)];
    progress_.done += is_done ? 1 : 0;
    if (!is_done) options_.backwards ? queue.push_front(number) : queue.push_back(number);
  }
  return queue;
}

bool Work::goes_on() {
  progress_.seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
  return interruption() == 0 && !ended_by_failures() && (!options_.progress || options_.progress(progress_));
}

CaseResult Work::result_of(const WorkerPool::Answer& answer) const {
  if (answer.text)
    if (auto result = result_of_line(*answer.text)) {
      result->number = answer.job;
      return *result;
    }
  return lost_case(answer.job, answer, campaign_.options());
}

Result<void> Work::take(const WorkerPool::Answer& answer, Phase phase) {
  // something outside of the case may have ended its process
  if (!answer.text && !answer.exceeded && lost_.insert(answer.job).second) {
    queue_.push_front(answer.job);
    return {};
  }
  if (answer.text && answer.text->starts_with(hindrance)) {
    if (!lost_.insert(answer.job).second) return hindered(campaign_, answer.job, answer.text->substr(hindrance.size()));
    queue_.push_front(answer.job);
    return {};
  }
  if (answer.text && answer.text->starts_with(refusal))
    return error_in(campaign_.folder().string(), answer.text->substr(refusal.size()), new_campaign);
  CaseResult result = result_of(answer);
  result.again = phase == Phase::again;
  if (phase == Phase::first && answer.text) keep_trace(campaign_, result, answer.folder / trace_name);
  REHEARSE_TRY(file_.append(result));
  ++progress_.done;
  ++progress_.here;
  if (!result.passed() && !result.again) ++progress_.failed;
  return {};
}

Result<void> Work::run_queue(Phase phase) {
  for (;;) {
    if (!goes_on()) {
      queue_.clear();
      return {};
    }
    while (!queue_.empty() && pool_.has_room()) {
      const std::int64_t number = queue_.front();
      queue_.pop_front();
      REHEARSE_TRY(pool_.give(number));
    }
    if (pool_.is_idle() && queue_.empty()) return {};
    const auto answer = REHEARSE_TRY(pool_.wait());
    if (!answer) continue;
    REHEARSE_TRY(take(*answer, phase));
  }
}

Result<void> Work::run() {
  REHEARSE_TRY(read_results());
  const std::deque<std::int64_t> again = queue_of(Phase::again);
  queue_ = queue_of(Phase::first);
  REHEARSE_TRY(run_queue(Phase::first));
  if (!goes_on() || !pool_.is_idle()) return {};
  pool_.renew_all();  // in processes that haven't run them
  lost_.clear();
  queue_ = again;
  return run_queue(Phase::again);
}

}  // namespace

Result<CaseRun> run_alone(const Campaign& campaign, const std::string& text, const fs::path& file,
                          const fs::path& trace, const Simulation& simulation) {
  return run_alone(campaign.folder(), campaign.options(), text, file, trace, simulation);
}

Result<CaseRun> run_alone(const fs::path& campaign, const CampaignOptions& options, const std::string& text,
                          const fs::path& file, const fs::path& trace, const Simulation& simulation) {
  const auto scratch = REHEARSE_TRY(RunFolder::make(campaign / "running"));
  WorkerPool pool(workers(options, 1, scratch.path()), [&](std::int64_t, const fs::path& folder) {
    const auto run = timed_case(file, text, options, folder / trace_name, simulation);
    if (!run) return WorkerPool::Made{hindrance + run.errors().front().message};
    const Json answer{
        {"result", json_of_result(run->result)}, {"expectations", run->expectations}, {"libraries", run->libraries}};
    return WorkerPool::Made{answer.dump(-1, ' ', false, Json::error_handler_t::replace)};
  });
  REHEARSE_TRY(pool.give(0));
  std::optional<WorkerPool::Answer> answer;
  while (!answer && interruption() == 0) {
    answer = REHEARSE_TRY(pool.wait());
  }
  if (!answer) return interrupted();
  if (answer->text && answer->text->starts_with(hindrance))
    return error_in(file.string(), "it can't be run here: " + answer->text->substr(hindrance.size()));
  CaseRun run;
  const Json object = answer->text ? Json::parse(*answer->text, nullptr, false) : Json();
  if (object.is_object()) {
    run.result = result_of_json(object.at("result")).value_or(CaseResult{});
    run.expectations = object.at("expectations").get<std::vector<std::string>>();
    run.libraries = object.at("libraries").get<std::map<std::string, std::string>>();
  } else {
    run.result = lost_case(-1, *answer, options);
  }
  run.result.number = -1;
  if (trace.empty()) return run;
  std::error_code failed;
  const fs::path made = answer->folder / trace_name;
  if (fs::exists(made, failed)) {
    fs::create_directories(trace.parent_path().empty() ? fs::path(".") : trace.parent_path(), failed);
    fs::rename(made, trace, failed);
    if (failed) fs::copy_file(made, trace, fs::copy_options::overwrite_existing, failed);
    if (failed) return error_in(trace.string(), fmt::format("it can't be written: {}", failed.message()));
  }
  return run;
}

namespace {

/// The controllers whose libraries aren't those with which the campaign began. `now`: those of the nominal run.
std::vector<std::string> changed_libraries(const Campaign& campaign, const std::map<std::string, std::string>& now) {
  std::vector<std::string> changed;
  for (const auto& [controller, library] : campaign.libraries())
    if (const auto found = now.find(controller); found == now.end() || found->second != library)
      changed.push_back(controller);
  return changed;
}

/// The same for the run of a case. `now` is empty if the run has no recording. A case may vary a library.
std::vector<std::string> changed_in_case(const Campaign& campaign, const std::map<std::string, std::string>& now) {
  const bool varies_libraries = std::ranges::any_of(
      campaign.scenario().variations, [](const Variation& variation) { return variation.path.ends_with(".library"); });
  return now.empty() || varies_libraries ? std::vector<std::string>() : changed_libraries(campaign, now);
}

std::string change_of(const std::string& controller) {
  return fmt::format("the controller {} has changed since the campaign began", controller);
}

}  // namespace

Result<TextRun> run_text(const Campaign& campaign, const std::string& text, const fs::path& trace,
                         const Simulation& simulation) {
  auto run = REHEARSE_TRY(run_alone(campaign, text, campaign.scenario().file, trace, simulation));
  return TextRun{std::move(run.result), changed_in_case(campaign, run.libraries)};
}

namespace {

/// Results of different controllers, models or programs must not be counted together.
Result<void> check_nominal(const Campaign& campaign, const Simulation& simulation) {
  const auto now =
      REHEARSE_TRY(run_alone(campaign, campaign.scenario().text, campaign.scenario().file, {}, simulation));
  if (const auto changed = changed_libraries(campaign, now.libraries); !changed.empty())
    return error_in(campaign.folder().string(), change_of(changed.front()), new_campaign);
  if (now.result.repeats(campaign.nominal())) return {};
  return error_in(
      campaign.folder().string(), "the nominal run has changed since the campaign began",
      "something that it depends on has changed, or it doesn't repeat itself: rehearse audit; begin another "
      "campaign in a new folder");
}

/// The answer of a worker to a case, which is its last: each run begins in a process that has run no controller.
WorkerPool::Made made_case(const Campaign& campaign, std::int64_t number, const fs::path& trace,
                           const Simulation& simulation) {
  const auto text = campaign.text_of(number);
  if (!text) return {line_of(ended_case(number, CaseVerdict::invalid, text.errors().front().message))};
  auto run = timed_case(campaign.scenario().file, *text, campaign.options(), trace, simulation);
  if (!run) return {hindrance + run.errors().front().message, true};
  if (const auto changed = changed_in_case(campaign, run->libraries); !changed.empty())
    return {refusal + change_of(changed.front()), true};
  run->result.number = number;
  return {line_of(run->result), true};
}

}  // namespace

Result<Campaign> create_campaign(const fs::path& scenario, const fs::path& folder, const CampaignOptions& options,
                                 const Simulation& simulation) {
  auto loaded = REHEARSE_TRY(Scenario::load(scenario));
  auto campaign = CampaignFolder::begin(std::move(loaded), folder, options);
  if (!campaign) return campaign;
  REHEARSE_TRY(CampaignFolder::check_bounds(*campaign));
  REHEARSE_TRY(CampaignFolder::check_unused(folder));
  const auto lock = REHEARSE_TRY(CampaignLock::take(folder, false));
  auto nominal = run_alone(*campaign, campaign->scenario().text, scenario, {}, simulation);
  if (!nominal || nominal->result.verdict == CaseVerdict::invalid) {
    std::error_code ignored;
    fs::remove(folder / "lock", ignored);
    fs::remove(folder, ignored);
    if (!nominal) return nominal.errors();
    return error_in(scenario.string(), "the scenario can't run with its nominal values: " + nominal->result.sentence);
  }
  REHEARSE_TRY(CampaignFolder::write_new(*campaign, nominal->result, nominal->libraries, nominal->expectations));
  return campaign;
}

Result<void> run_cases(Campaign& campaign, const SweepOptions& options, const Simulation& simulation) {
  const fs::path& own_folder = campaign.folder();
  REHEARSE_TRY(CampaignLock::take(own_folder, options.slice.has_value()));
  auto file = REHEARSE_TRY(ResultFile::open(result_file(own_folder, options.slice)));
  if (!CampaignFolder::take_new(campaign)) REHEARSE_TRY(check_nominal(campaign, simulation));
  REHEARSE_TRY(set_ending_failures(own_folder, 0));
  const auto scratch = REHEARSE_TRY(RunFolder::make(own_folder / "running"));
  std::error_code ignored;
  fs::create_directories(trace_folder(own_folder), ignored);
  WorkerPool pool(workers(campaign.options(), std::max<std::size_t>(options.jobs, 1), scratch.path()),
                  [&](std::int64_t number, const fs::path& folder) {
                    return made_case(campaign, number, folder / trace_name, simulation);
                  });
  Work work(campaign, options, file, pool);
  if (auto done = work.run(); !done || !work.ended_by_failures()) return done;
  return set_ending_failures(own_folder, options.most_failures);
}

}  // namespace rehearse
