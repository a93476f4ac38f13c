// The search for rare failures of a scenario, and the smallest change of it that fails.
#pragma once

#include <rehearse/campaign_report.h>
#include <rehearse/sweep.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

// Searching for rare failures.

struct SearchOptions {
  std::string expectation;         // its text, or a part of it that no other expectation has
  std::vector<std::string> over;   // parameters that are steered; empty: all with uniform, log_uniform or normal
  int rounds = 6;                  // at most
  std::int64_t most_failures = 1;  // the search ends after the round in which this many cases of all rounds violate it
  std::int64_t estimate = 0;       // cases after the search, which estimate the probability of a violation; 0: none
};

/// A campaign of a search.
struct SearchRound {
  std::filesystem::path folder;
  CampaignSummary summary;
  double least_margin = 0.0;                  // of the expectation
  std::int64_t violations = 0;                // cases that violate it
  std::optional<std::int64_t> first_failure;  // the lowest number of these cases
};

/// The probability that a case of the scenario's own distributions violates an expectation.
struct FailureProbability {
  double estimate = 0.0;
  Interval interval;            // with 95 % confidence
  std::int64_t cases = 0;       // of the campaign that estimates it
  std::int64_t violations = 0;  // those of them that violate it
  /// False: by their weights they are fewer than ten, and the interval is that of their number alone.
  bool has_enough_violations = false;
  std::filesystem::path folder = {};  // of this campaign
};

struct SearchResult {
  std::vector<SearchRound> rounds;
  std::optional<FailureProbability> probability;  // none: SearchOptions::estimate is 0
};

/// Runs rounds, each a campaign in `folder`/round-1 and so on. After a round parameters are steered towards the tenth
/// of its cases with the smallest margins: their new mean is 0.9 times that of these cases plus 0.1 times that of the
/// round, and their deviation, likewise, that of these cases from the mean of the round. This is a cross-entropy method
/// (R. Rubinstein, The Cross-Entropy Method for Combinatorial and Continuous Optimization, Methodology and Computing in
/// Applied Probability 1 (1999)) with the deviation of an evolution strategy, which doesn't shrink on the way. The
/// round is a part of the seed. Called again with the same arguments it continues. Shares of failures refer to the
/// steered distributions.
///
/// The probability of a violation is estimated after the search by a campaign in `folder`/estimate, with the
/// distributions of the next round for four in five values of each parameter, and the scenario's own for the others, so
/// that a parameter which was steered without need keeps its range. The cases are weighted by their likelihood ratios
/// (importance sampling with defensive mixtures: T. Hesterberg, Weighted Average Importance Sampling and Defensive
/// Mixture Distributions, Technometrics 37 (1995)). The interval holds for the part of the failures to which the search
/// led: of a failure in two directions, as beyond either end of a range, it may lack one. A case without a margin of
/// the expectation, as after a crash, doesn't count as a violation.
Result<SearchResult> search(const std::filesystem::path& scenario, const std::filesystem::path& folder,
                            const CampaignOptions& options, const SearchOptions& search, const SweepOptions& sweep,
                            const Simulation& simulation);

// Shrinking.

struct ShrinkOptions {
  int budget = 500;  // runs at most
  /// Called after each run with the number of runs, and the number of parameters that still differ; null: not. False
  /// ends the search, and the best so far is kept.
  std::function<bool(int runs, std::size_t differing)> progress;
};

/// The smallest change of the nominal scenario that was found to fail like a case.
struct Shrunk {
  std::int64_t number = 0;           // of the case
  CaseResult result;                 // of the shrunk scenario
  std::vector<std::string> values;   // by variation; empty: nominal
  std::vector<std::size_t> differs;  // indices of the variations that differ from nominal
  double duration = 0.0;             // [s]
  int runs = 0;
  bool finished = false;             // false: the budget was spent, or the search was interrupted
  std::vector<std::string> changed;  // controllers whose libraries have changed since the campaign began, by BODY/NAME
  std::string scenario;              // its text, whose paths are relative to the campaign's scenario
};

/// Sets parameters of a failing case back to nominal as long as it fails for the same reason (delta debugging: A.
/// Zeller, R. Hildebrandt, Simplifying and Isolating Failure-Inducing Input, IEEE Transactions on Software Engineering
/// 28 (2002)), and bisects the others towards nominal. Repeats both until nothing changes, then cuts the duration.
/// Fails if the case passes.
Result<Shrunk> shrink(const Campaign& campaign, std::int64_t number, const ShrinkOptions& options,
                      const Simulation& simulation);

/// Writes the shrunk scenario with comments on the values that differ, and its recording beside it (.mcap). Its paths
/// of models and libraries are relative to its folder. Fails if the written scenario doesn't fail like the case.
/// Without Simulation::record it is written and not recorded.
Result<void> write_shrunk(const Campaign& campaign, const Shrunk& shrunk, const std::filesystem::path& file,
                          const Simulation& simulation);

}  // namespace rehearse
