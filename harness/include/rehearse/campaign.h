// Campaign: many runs of a scenario with other values of its varied parameters (`vary:`), each judged.
//
// A campaign is a folder: campaign.json (scenario, seed, options), plan.csv (the table of cases) and result lines.
// Everything but the result lines is immutable. A value is a function of the campaign's seed, the number of the case
// and the name of the parameter. So a case is the same wherever it runs, and a new parameter changes no values of the
// others.
//
// Cases run in worker processes, many in each. This library doesn't simulate: the caller passes a Simulation.
#pragma once

#include <rehearse/check.h>
#include <rehearse/diagnostic.h>
#include <rehearse/run_options.h>
#include <rehearse/scenario.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

enum class CaseVerdict {
  passed,
  violated,  // an expectation is violated
  differs,   // beyond the golden's tolerances
  failed,    // a controller threw, refused to take part, or tried to end the process
  crashed,   // a signal in a controller, or the end of the process
  hung,      // a call, or the whole case, exceeded its limit of wall time
  exploded,  // a position or velocity is no longer finite
  invalid,   // the scenario can't run with these values
};
inline constexpr std::size_t case_verdict_count = 8;

/// "passed", "violated", ...
std::string_view to_string(CaseVerdict verdict);

/// The result of one case. All members but `seconds` are functions of the case.
struct CaseResult {
  std::int64_t number = 0;  // from 0 on; -1: the nominal scenario
  CaseVerdict verdict = CaseVerdict::passed;
  std::string sentence;              // why it didn't pass; empty if it did
  std::string reason;                // the kind of failure: the expectation, or the sentence without its digits
  std::optional<std::int64_t> tick;  // the first tick that fails; none: passed, or the failure has no tick
  std::string hash;                  // of all messages of the run; empty: there was no run to its end
  std::int64_t ticks = 0;            // simulated
  std::vector<std::optional<double>> margins;  // by expectation, as ExpectationResult::margin
  double seconds = 0.0;                        // wall time [s]
  bool again = false;                          // the second run of a case that the plan runs twice

  bool passed() const { return verdict == CaseVerdict::passed; }
  /// True if a run repeats this one: everything but the wall time is equal.
  bool repeats(const CaseResult& other) const;
};

/// The normal distribution that replaces the distribution of a parameter, within its bounds. For a parameter with
/// log_uniform it is the distribution of the logarithm, from which a uniform one with the same deviation is made.
struct SteeredParameter {
  std::string name;
  double mean = 0.0, stddev = 1.0;
};

struct CampaignOptions {
  std::int64_t cases = 0;  // 0: all combinations of the grids, or all rows of the files
  std::uint64_t seed = 0;
  std::filesystem::path golden;           // every case is compared with it; empty: no comparison
  int keep = 3;                           // number of traces kept of each kind of failure, of the lowest cases
  double case_limit = 600.0;              // wall time of a case; a longer case counts as hung [s]
  std::vector<SteeredParameter> steered;  // by a search; empty: all distributions are those of the scenario
  HostOptions host;
};

/// The state of the work on a campaign.
struct SweepProgress {
  std::int64_t done = 0, all = 0, failed = 0;
  double seconds = 0.0;   // wall time since the work began [s]
  std::int64_t here = 0;  // number of cases since then
};

/// One of `count` equal parts of a campaign: the cases whose number divided by `count` leaves index - 1. It also
/// contains the second runs of the cases of the previous slice, so that another process makes them, perhaps on another
/// machine.
struct Slice {
  std::int64_t index = 1, count = 1;  // index from 1 on

  std::int64_t first_case() const { return index - 1; }
  std::int64_t first_second_run() const { return (index + count - 2) % count; }
};

struct SweepOptions {
  std::size_t jobs = 1;        // worker processes
  std::optional<Slice> slice;  // none: the whole campaign
  bool backwards = false;      // cases in the opposite order; results don't depend on it
  std::int64_t most_failures =
      std::numeric_limits<std::int64_t>::max();  // the work ends when so many cases have failed
  /// Called after each case; null: not. False ends the work, which can be resumed.
  std::function<bool(const SweepProgress&)> progress;
};

/// A campaign's folder.
class Campaign {
 public:
  /// Runs the nominal scenario once, and writes the plan into the folder, which must be empty or new. Fails if the
  /// scenario varies nothing, if a bound of a distribution is no valid value, or if the nominal scenario can't run.
  static Result<Campaign> create(const std::filesystem::path& scenario, const std::filesystem::path& folder,
                                 const CampaignOptions& options, const Simulation& simulation);
  /// Fails if the folder is no campaign, if its plan was changed, or if the scenario or a model has changed since.
  static Result<Campaign> open(const std::filesystem::path& folder);

  const std::filesystem::path& folder() const { return folder_; }
  const Scenario& scenario() const { return scenario_; }
  const CampaignOptions& options() const { return options_; }
  const CaseResult& nominal() const { return nominal_; }
  const std::vector<std::string>& expectations() const { return expectations_; }  // as text
  const std::string& digest() const { return digest_; }                           // of plan.csv

  /// The values of a case by variation, as text.
  std::vector<std::string> values_of(std::int64_t number) const;
  /// True if the plan runs the case a second time, in another process.
  bool runs_twice(std::int64_t number) const;
  /// The text of a case's scenario.
  Result<std::string> text_of(std::int64_t number) const;
  /// Fails if there is no such case.
  Result<void> check_number(std::int64_t number) const;

  /// Runs all cases that have no result. Fails if another process works here, if the nominal run differs from that in
  /// the plan, or if results can't be written.
  Result<void> work(const SweepOptions& options, const Simulation& simulation);

  /// Calls `take` for each result line, except for incomplete lines of a killed process.
  Result<void> read_results(const std::function<void(const CaseResult&)>& take) const;

  /// Of `count` slices, the indices (from 1 on) of those in which a case or a second run has no result.
  Result<std::vector<std::int64_t>> unfinished_slices(std::int64_t count) const;

  /// Runs a scenario with this text in a process of its own, and judges it. `trace`: the file of the recording; empty:
  /// it is not kept. Fails if a signal interrupts it.
  Result<CaseResult> run_text(const std::string& text, const std::filesystem::path& trace,
                              const Simulation& simulation) const;

  /// The values with those of linked parameters computed again. Empty values are nominal.
  std::vector<std::string> with_links(std::vector<std::string> values) const;

 private:
  friend class CampaignFiles;
  Campaign() = default;
  Result<void> check_nominal(const Simulation& simulation) const;
  /// Fails if one of these controller libraries has changed since the campaign began.
  Result<void> check_libraries(const std::map<std::string, std::string>& now) const;

  std::filesystem::path folder_;
  Scenario scenario_;
  CampaignOptions options_;
  CaseResult nominal_;
  std::map<std::string, std::string> libraries_;  // of controllers, with their hashes
  std::vector<std::string> expectations_;
  std::string digest_;
  std::shared_ptr<const class CaseValues> values_;
  bool is_new_ = false;  // made by this process, which has just run the nominal scenario
};

// Statistics of shares.

struct Interval {
  double low = 0.0, high = 1.0;
};

/// The interval of a share with 95 % confidence: E. B. Wilson, Probable Inference, the Law of Succession, and
/// Statistical Inference, Journal of the American Statistical Association 22 (1927), pp. 209-212. L. D. Brown, T. T.
/// Cai, A. DasGupta, Interval Estimation for a Binomial Proportion, Statistical Science 16 (2001) recommend it.
Interval wilson_interval(std::int64_t passed, std::int64_t all);

/// The probability of these numbers of flips in the two directions, or of more unequal ones, if both directions were
/// equally likely: Q. McNemar, Note on the sampling error of the difference between correlated proportions or
/// percentages, Psychometrika 12 (1947), with the exact binomial distribution, two-sided.
double mcnemar_exact(std::int64_t one_way, std::int64_t other_way);

/// Rank correlation of two lists of equal length, -1 to 1; equal values have their mean rank. C. Spearman, The proof
/// and measurement of association between two things, American Journal of Psychology 15 (1904). NaN if one of the lists
/// has only one value.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b);

// Reports.

/// The results of a campaign, counted.
struct CampaignSummary {
  std::int64_t cases = 0;  // of the plan
  std::array<std::int64_t, case_verdict_count> verdicts{};
  std::int64_t missing = 0;              // cases without a result
  std::int64_t repeated = 0;             // cases that ran twice
  std::vector<std::int64_t> unrepeated;  // cases whose second run differed; at most 100 of them

  std::int64_t passed() const { return verdicts[0]; }
  std::int64_t judged() const { return cases - missing; }
  std::int64_t failed() const { return judged() - passed(); }
  Interval interval() const { return wilson_interval(passed(), judged()); }
};

Result<CampaignSummary> summary_of(const Campaign& campaign);

/// A sentence, without a full stop: "981 of 1000 cases pass: 98.1 % (97.1 % to 98.8 %)".
std::string verdict(const CampaignSummary& summary);

/// A JSON object: verdict, cases, verdicts (counts by name), missing, share and interval of those that pass, repeated,
/// unrepeated.
std::string to_json(const CampaignSummary& summary);

/// Writes report.html, report.md, report.json and results.csv into the campaign's folder. `against`: a campaign with
/// the same plan, before a change; null: none. Fails if the plans differ, or a file can't be written.
Result<CampaignSummary> write_campaign_report(const Campaign& campaign, const Campaign* against = nullptr);

// Searching for rare failures.

struct SearchOptions {
  std::string expectation;         // its text, or a part of it that no other expectation has
  std::vector<std::string> over;   // parameters that are steered; empty: all with uniform, log_uniform or normal
  int rounds = 6;                  // at most
  std::int64_t most_failures = 1;  // the search ends after the round in which this many cases of all rounds violate it
};

/// A campaign of a search.
struct SearchRound {
  std::filesystem::path folder;
  CampaignSummary summary;
  double least_margin = 0.0;                  // of the expectation
  std::int64_t violations = 0;                // cases that violate it
  std::optional<std::int64_t> first_failure;  // the lowest number of these cases
};

/// Runs rounds, each a campaign in `folder`/round-1 and so on. After a round parameters are steered towards the tenth
/// of its cases with the smallest margins. Their new mean and deviation are 0.9 times those of these cases plus 0.1
/// times those of the round. This is the cross-entropy method: R. Rubinstein, The Cross-Entropy Method for
/// Combinatorial and Continuous Optimization, Methodology and Computing in Applied Probability 1 (1999). The round is a
/// part of the seed. Called again with the same arguments it continues. Shares of failures refer to the steered
/// distributions.
Result<std::vector<SearchRound>> search(const std::filesystem::path& scenario, const std::filesystem::path& folder,
                                        const CampaignOptions& options, const SearchOptions& search,
                                        const SweepOptions& sweep, const Simulation& simulation);

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
  bool finished = false;  // false: the budget was spent, or the search was interrupted
  std::string scenario;   // its text, whose paths are relative to the campaign's scenario
};

/// Sets parameters of a failing case back to nominal as long as it fails for the same reason (delta debugging: A.
/// Zeller, R. Hildebrandt, Simplifying and Isolating Failure-Inducing Input, IEEE Transactions on Software Engineering
/// 28 (2002)), bisects the others towards nominal, then cuts the duration. Fails if the case passes.
Result<Shrunk> shrink(const Campaign& campaign, std::int64_t number, const ShrinkOptions& options,
                      const Simulation& simulation);

/// Writes the shrunk scenario with comments on the values that differ, and its recording beside it (.mcap). Its paths
/// of models and libraries are relative to its folder. Fails if the written scenario doesn't fail like the case.
/// Without Simulation::record it is written and not recorded.
Result<void> write_shrunk(const Campaign& campaign, const Shrunk& shrunk, const std::filesystem::path& file,
                          const Simulation& simulation);

}  // namespace rehearse
