// Rounds of campaigns that are steered towards the failure of an expectation.
#include <fmt/format.h>
#include <rehearse/shrink.h>

#include <algorithm>
#include <cmath>

#include "base/names.h"
#include "campaigns/plan/campaign_folder.h"
#include "campaigns/plan/case_values.h"
#include "campaigns/statistics/case_table.h"
#include "core/guard/interruption.h"
#include "likelihood_ratio.h"
#include "steering.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr double own_share = 0.2;  // of the values of each parameter, for the estimate of a probability

/// The indices of the parameters that are steered.
Result<std::vector<std::size_t>> steered_variations(const Scenario& scenario, const std::vector<std::string>& over) {
  std::vector<std::string> names;
  for (const Variation& variation : scenario.variations)
    if (can_be_steered(variation)) names.push_back(variation.name);
  for (const std::string& name : over)
    if (std::ranges::find(names, name) == names.end())
      return error_in(scenario.file, fmt::format("no parameter '{}' can be steered", name),
                      name_hint(name, names, "parameters") + "; whole numbers and lists can't be steered");
  if (names.empty())
    return error_in(scenario.file, "no parameter can be steered", "expected one with uniform, log_uniform or normal");
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < scenario.variations.size(); ++i) {
    const Variation& variation = scenario.variations[i];
    const bool is_named = over.empty() || std::ranges::find(over, variation.name) != over.end();
    if (can_be_steered(variation) && is_named) indices.push_back(i);
  }
  return indices;
}

Result<std::size_t> find_expectation(const Campaign& campaign, const std::string& text) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < campaign.expectations().size(); ++i) {
    if (campaign.expectations()[i] == text) return i;
    if (campaign.expectations()[i].find(text) != std::string::npos) found.push_back(i);
  }
  if (found.size() == 1) return found.front();
  return error_in(campaign.scenario().file,
                  fmt::format("{} has '{}'", found.empty() ? "no expectation" : "more than one expectation", text),
                  name_hint(text, campaign.expectations(), "expectations"));
}

class Search {
 public:
  Search(const fs::path& scenario, const CampaignOptions& options, const SearchOptions& search,
         const SweepOptions& sweep, const Simulation& simulation)
      : scenario_(scenario), options_(options), search_(search), sweep_(sweep), simulation_(simulation) {}

  Result<SearchRound> run_round(const fs::path& folder);
  /// After the last round.
  Result<FailureProbability> estimate(const fs::path& folder);

 private:
  /// All cases of a campaign that was begun here.
  Result<Campaign> run_campaign(const fs::path& folder);
  Result<Campaign> begin(const fs::path& folder) const;
  Result<void> steer_by(const Campaign& campaign, std::size_t expectation, const std::vector<std::size_t>& indices,
                        SearchRound& round);

  const fs::path scenario_;
  CampaignOptions options_;  // of the next round
  const SearchOptions& search_;
  const SweepOptions& sweep_;
  const Simulation& simulation_;
};

Result<Campaign> Search::begin(const fs::path& folder) const {
  std::error_code ignored;
  if (!fs::exists(facts_file(folder), ignored)) return create_campaign(scenario_, folder, options_, simulation_);
  auto campaign = Campaign::open(folder);
  if (!campaign) return campaign;
  if (are_same(campaign->options(), options_)) return campaign;
  return error_in(folder.string(), "the round was begun with other options",
                  "name those with which the search began, or a new folder");
}

Result<void> Search::steer_by(const Campaign& campaign, std::size_t expectation,
                              const std::vector<std::size_t>& indices, SearchRound& round) {
  const auto table = REHEARSE_TRY(CaseTable::of(campaign));
  const std::vector<double>& margins = table.margins[expectation];
  for (std::size_t i = table.size(); i-- > 0;) {
    if (!(margins[i] < 0.0)) continue;
    ++round.violations;
    round.first_failure = static_cast<std::int64_t>(i);
  }
  const std::vector<std::size_t> elite = elite_of(margins);
  if (elite.size() < least_elite)
    return error_in(round.folder.string(),
                    fmt::format("{} cases have a margin of '{}'", elite.size(), search_.expectation),
                    fmt::format("expected at least {}; expectations of events have none", least_elite));
  round.least_margin = margins[elite.front()];
  options_.steered.clear();
  for (const std::size_t i : indices) {
    std::vector<double> values;
    for (const std::size_t number : elite) values.push_back(table.values[i][number]);
    options_.steered.push_back(steered_by(campaign.scenario().variations[i], campaign.options().steered, values));
  }
  ++options_.seed;
  return {};
}

Result<Campaign> Search::run_campaign(const fs::path& folder) {
  auto campaign = REHEARSE_TRY(begin(folder));
  REHEARSE_TRY(find_expectation(campaign, search_.expectation));
  REHEARSE_TRY(steered_variations(campaign.scenario(), search_.over));
  REHEARSE_TRY(run_cases(campaign, sweep_, simulation_));
  if (interruption() != 0) return error("interrupted; the same command continues");
  return campaign;
}

Result<SearchRound> Search::run_round(const fs::path& folder) {
  auto campaign = REHEARSE_TRY(run_campaign(folder));
  const auto expectation = find_expectation(campaign, search_.expectation);
  const auto indices = steered_variations(campaign.scenario(), search_.over);
  auto summary = REHEARSE_TRY(write_campaign_report(campaign));
  SearchRound round{folder, std::move(summary), 0.0, 0, {}};
  REHEARSE_TRY(steer_by(campaign, *expectation, *indices, round));
  return round;
}

Result<FailureProbability> Search::estimate(const fs::path& folder) {
  options_.cases = search_.estimate;
  options_.own_share = own_share;
  const auto campaign = REHEARSE_TRY(run_campaign(folder));
  REHEARSE_TRY(write_campaign_report(campaign));
  const auto table = REHEARSE_TRY(CaseTable::of(campaign));
  FailureProbability found =
      failure_probability(campaign.scenario().variations, {options_.steered, own_share}, table.values,
                          table.margins[*find_expectation(campaign, search_.expectation)]);
  found.folder = folder;
  return found;
}

}  // namespace

Result<SearchResult> search(const fs::path& scenario, const fs::path& folder, const CampaignOptions& options,
                            const SearchOptions& search, const SweepOptions& sweep, const Simulation& simulation) {
  std::error_code ignored;
  if (fs::exists(facts_file(folder), ignored))
    return error_in(folder.string(), "there is a campaign in this folder", "name a new folder for the search");
  Search rounds(scenario, options, search, sweep, simulation);
  SearchResult made;
  std::int64_t failures = 0;
  while (made.rounds.size() < static_cast<std::size_t>(search.rounds) && failures < search.most_failures) {
    auto round = REHEARSE_TRY(rounds.run_round(folder / fmt::format("round-{}", made.rounds.size() + 1)));
    failures += round.violations;
    made.rounds.push_back(std::move(round));
  }
  if (search.estimate == 0) return made;
  made.probability = REHEARSE_TRY(rounds.estimate(folder / "estimate"));
  return made;
}

}  // namespace rehearse
