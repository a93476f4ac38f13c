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

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr double elite_share = 0.1;
constexpr std::size_t least_elite = 4;
constexpr double weight = 0.9;                 // of the elite's distribution; the rest is that of the round
constexpr double least_share_of_range = 1e-3;  // of the deviation
constexpr double own_share = 0.2;              // of the values of each parameter, for the estimate of a probability

bool is_logarithmic(const Variation& variation) { return variation.distribution == Distribution::log_uniform; }

bool can_be_steered(const Variation& variation) {
  return variation.distribution <= Distribution::normal && !variation.integer;
}

struct Moments {
  double mean = 0.0, stddev = 0.0;
};

Moments moments_of(const std::vector<double>& values) {
  Moments moments;
  for (const double value : values) moments.mean += value / static_cast<double>(values.size());
  for (const double value : values)
    moments.stddev += (value - moments.mean) * (value - moments.mean) / static_cast<double>(values.size());
  moments.stddev = std::sqrt(moments.stddev);
  return moments;
}

/// The distribution to which the options steer a parameter; null: its own.
const SteeredParameter* find_steered(const CampaignOptions& options, const std::string& name) {
  const auto found = std::ranges::find(options.steered, name, &SteeredParameter::name);
  return found == options.steered.end() ? nullptr : &*found;
}

/// The moments of the round's distribution, before truncation.
Moments moments_of(const Variation& variation, const CampaignOptions& round) {
  if (const SteeredParameter* parameter = find_steered(round, variation.name))
    return {parameter->mean, parameter->stddev};
  if (variation.distribution == Distribution::normal) return {variation.mean, variation.stddev};
  const bool logarithmic = is_logarithmic(variation);
  const double low = logarithmic ? std::log(variation.low) : variation.low;
  const double high = logarithmic ? std::log(variation.high) : variation.high;
  return {0.5 * (low + high), (high - low) / std::sqrt(12.0)};
}

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

/// The cases with the smallest margins. If more violate the expectation, all that do: the parameters aren't steered
/// past the boundary of the failure, where most of its probability is.
std::vector<std::size_t> elite_of(const std::vector<double>& margins) {
  std::vector<std::size_t> cases;
  for (std::size_t i = 0; i < margins.size(); ++i)
    if (!std::isnan(margins[i])) cases.push_back(i);
  std::ranges::stable_sort(cases, [&](std::size_t a, std::size_t b) { return margins[a] < margins[b]; });
  const auto share = static_cast<std::size_t>(elite_share * static_cast<double>(cases.size()));
  const auto violating =
      static_cast<std::size_t>(std::ranges::count_if(cases, [&](std::size_t number) { return margins[number] < 0.0; }));
  cases.resize(std::min(cases.size(), std::max({share, least_elite, violating})));
  return cases;
}

SteeredParameter steered(const Variation& variation, const CampaignOptions& round, const std::vector<double>& elite) {
  const Moments now = moments_of(elite), before = moments_of(variation, round);
  const bool logarithmic = is_logarithmic(variation);
  const double range = logarithmic ? std::log(variation.high / variation.low) : variation.high - variation.low;
  const double stddev = weight * now.stddev + (1.0 - weight) * before.stddev;
  return {variation.name, weight * now.mean + (1.0 - weight) * before.mean,
          std::max(stddev, least_share_of_range * range)};
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
    const Variation& variation = campaign.scenario().variations[i];
    std::vector<double> values;
    for (const std::size_t number : elite)
      values.push_back(is_logarithmic(variation) ? std::log(table.values[i][number]) : table.values[i][number]);
    options_.steered.push_back(steered(variation, campaign.options(), values));
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
  const std::vector<Variation>& variations = campaign.scenario().variations;
  std::vector<Variation> own;
  std::vector<SteeredVariation> steered;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < variations.size(); ++i) {
    const SteeredParameter* parameter = find_steered(options_, variations[i].name);
    if (parameter == nullptr) continue;
    indices.push_back(i);
    own.push_back(variations[i]);
    steered.push_back(steer(variations[i], *parameter));
  }
  const std::vector<double>& margins = table.margins[*find_expectation(campaign, search_.expectation)];
  std::vector<double> ratios;
  for (std::size_t number = 0; number < table.size(); ++number) {
    if (!(margins[number] < 0.0)) continue;
    std::vector<double> values;
    for (const std::size_t i : indices) values.push_back(table.values[i][number]);
    ratios.push_back(likelihood_ratio(own, steered, values, own_share));
  }
  const double least_share_of_density = std::pow(own_share, static_cast<double>(own.size()));
  FailureProbability found = failure_probability(ratios, search_.estimate, least_share_of_density);
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
