// Variations of a scenario in tests.
#include <fmt/format.h>
#include <rehearse/campaign_report.h>
#include <rehearse/gtest.h>
#include <rehearse/sweep.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include "test_recordings.h"

namespace rehearse::internal {
namespace {

namespace fs = std::filesystem;

template <class T>
T checked(Result<T> result) {
  if (!result) throw std::runtime_error(to_string(result.errors()));
  return *std::move(result);
}

/// A folder without the campaign of an earlier run of the test.
fs::path new_folder(const std::string& test) {
  fs::path folder = fs::path(test_folders().output) / "campaigns" / test;
  std::error_code ignored;
  if (fs::exists(folder / "campaign.json", ignored)) fs::remove_all(folder, ignored);
  return folder;
}

/// A line for each kind of failure, the most frequent first.
std::string failures_of(const Campaign& campaign) {
  struct Kind {
    std::int64_t count = 0;
    CaseResult first;
  };
  std::map<std::string, Kind> kinds;
  const auto read = campaign.read_results([&](const CaseResult& result) {
    if (result.passed() || result.again) return;
    Kind& kind = kinds[result.reason];
    if (kind.count++ == 0 || result.number < kind.first.number) kind.first = result;
  });
  if (!read) throw std::runtime_error(to_string(read.errors()));
  std::vector<Kind> order;
  for (auto& [reason, kind] : kinds) order.push_back(std::move(kind));
  std::ranges::stable_sort(order, [](const Kind& a, const Kind& b) { return a.count > b.count; });
  std::string text;
  for (const Kind& kind : order)
    text +=
        fmt::format("\n{} {}: {}\n  the first: rehearse sweep shrink {} {}", kind.count, to_string(kind.first.verdict),
                    kind.first.sentence, kind.first.number, campaign.folder().string());
  return text;
}

/// True if the rate of a campaign may be judged.
bool is_sound(const SweepResult& result) {
  return result.repeats && result.never_tried.empty() && result.failing_again.empty();
}

std::vector<std::string> kept_failures_of(const Campaign& campaign, const Simulation& runs) {
  std::vector<std::string> failing;
  for (const auto& [file, run] : checked(run_kept_failures(campaign, runs)))
    if (!run.passed())
      failing.push_back(fmt::format("{}: {}: {}", file.string(), to_string(run.verdict), run.sentence));
  return failing;
}

TestVerdict refusal(const SweepResult& result, const std::string& reason = "") {
  std::string again;
  for (const std::string& failure : result.failing_again) again += "\na kept failure fails again: " + failure;
  return {false, fmt::format("{}{}{}{}\nreport: {}", result.verdict, reason, again, result.failures,
                             (fs::path(result.folder) / "report.html").string())};
}

}  // namespace

SweepResult sweep_for_test(const std::string& scenario, const SweepCases& cases, const std::string& test) {
  CampaignOptions options;
  options.cases = cases.cases;
  options.seed = cases.seed;
  options.case_limit = cases.case_limit;
  const Simulation runs = simulation();
  Campaign campaign = checked(create_campaign(fixture_path(scenario), new_folder(test), options, runs));
  std::vector<std::string> failing_again = kept_failures_of(campaign, runs);
  SweepOptions sweeping;
  sweeping.jobs = static_cast<std::size_t>(cases.jobs > 0 ? cases.jobs : std::max(1L, sysconf(_SC_NPROCESSORS_ONLN)));
  if (const auto worked = run_cases(campaign, sweeping, runs); !worked)
    throw std::runtime_error(to_string(worked.errors()));
  const CampaignSummary summary = checked(write_campaign_report(campaign));
  SweepResult result;
  result.cases = summary.judged();
  result.passed = summary.passed();
  result.low = summary.interval().low;
  result.high = summary.interval().high;
  result.verdict = verdict(summary);
  result.failures = failures_of(campaign);
  result.repeats = summary.unrepeated.empty();
  result.passes = summary.answer() == ClaimAnswer::passes;
  result.undecided = summary.answer() == ClaimAnswer::undecided;
  result.never_tried = summary.never_tried();
  result.failing_again = std::move(failing_again);
  result.folder = campaign.folder().string();
  return result;
}

TestVerdict judge_pass_rate(const SweepResult& result, double rate) {
  if (!is_sound(result)) return refusal(result);
  if (result.high >= rate) return {true, ""};
  return refusal(result,
                 fmt::format("; its upper bound, {:.4g} %, is below {:.4g} %", 100.0 * result.high, 100.0 * rate));
}

TestVerdict judge_claims(const SweepResult& result) {
  return is_sound(result) && result.passes ? TestVerdict{true, ""} : refusal(result);
}

}  // namespace rehearse::internal
