// The results of a campaign, counted and reported.
#pragma once

#include <rehearse/campaign.h>

#include <array>
#include <compare>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rehearse {

// Statistics of shares.

struct Interval {
  double low = 0.0, high = 1.0;
};

/// The two-sided exact interval of a share, by default with 95 % confidence: C. J. Clopper, E. S. Pearson, The Use of
/// Confidence or Fiducial Limits Illustrated in the Case of the Binomial, Biometrika 26 (1934), pp. 404-413. Each of
/// its ends is on the wrong side of the true share with a probability of 2.5 % at most, for every number of cases and
/// every share, if the cases are independent and each passes with the same probability. Cases of `plan: random` are.
Interval exact_interval(std::int64_t passed, std::int64_t all, double confidence = 0.95);

/// The two-sided interval of the share that passes, by default with 95 % confidence, if the work ended with a failure
/// (--until-failures): the exact one of inverse sampling, from the binomial distribution. `failed`: at least 1, of
/// `all` cases.
Interval inverse_interval(std::int64_t failed, std::int64_t all, double confidence = 0.95);

/// The claim that a share of all possible cases passes (`pass_rate`).
struct ClaimedRate {
  double at_least = 1.0;     // above 0 and below 1
  double confidence = 0.95;  // of the two-sided interval that decides
};

enum class ClaimAnswer {
  passes,     // the interval is at or above the bound
  fails,      // the interval is below the bound
  undecided,  // the interval contains the bound
};

/// "passes", "fails" or "undecided".
std::string_view to_string(ClaimAnswer answer);

ClaimAnswer answer_of(const ClaimedRate& claim, const Interval& interval);

/// The least number of cases whose exact interval decides the claim, in either direction, if this share of them
/// passes. None: no number does, because the share is the bound itself, or too close to it for 10^9 cases.
std::optional<std::int64_t> deciding_cases(const ClaimedRate& claim, double share);

/// A sentence, without a full stop, on the cases that a claim needs, for a plan of `cases`: "at least 95 % pass, with
/// 95 % confidence, needs 72 cases if all pass, and 317 if 97.5 % pass".
std::string plan_sentence(const ClaimedRate& claim, std::int64_t cases);

/// The cases that have a result in two campaigns with the same plan, before and after a change.
struct PairedCases {
  std::int64_t all = 0;
  std::int64_t broken = 0;  // passed before, fail now
  std::int64_t mended = 0;  // failed before, pass now

  /// The share that passes now, less the share that passed before. NaN: there are no pairs.
  double difference() const;
};

/// The two-sided interval of the difference of the shares that pass, -1 to 1, from the score test of paired
/// proportions: T. Tango, Equivalence test and confidence interval for the difference in proportions for the
/// paired-sample design, Statistics in Medicine 17 (1998), pp. 891-908.
Interval paired_interval(const PairedCases& pairs, double confidence = 0.95);

/// The claim that a change lowers the share that passes by less than a margin (--margin).
struct NonInferiority {
  double margin = 0.01;      // above 0 and below 1
  double confidence = 0.95;  // of the two-sided interval that decides
};

/// Passes if the interval of the difference is above -margin, and fails if it is below.
ClaimAnswer answer_of(const NonInferiority& claim, const PairedCases& pairs);

/// The number of pairs that would decide the claim, beyond these, if the shares of flips stay. None: it is decided, or
/// no number does.
std::optional<std::int64_t> more_pairs(const NonInferiority& claim, const PairedCases& pairs);

/// A phrase on the flips, the difference and its interval, and on the answer to a claim: "12 cases passed before and
/// fail now, 3 failed before and pass now: the share that passes changes by -0.9 % (-1.7 % to -0.2 %); not inferior,
/// with a margin of 2 % and 95 % confidence".
std::string comparison_sentence(const PairedCases& pairs, const std::optional<NonInferiority>& claim);

/// The quantile of sorted values, in proportion between the two values around it. The median of an even number of
/// values (share 0.5) is the mean of the two in the middle. NaN if there are none.
double quantile_of_sorted(const std::vector<double>& sorted, double share);

/// The probability of these numbers of flips in the two directions, or of more unequal ones, if both directions were
/// equally likely: Q. McNemar, Note on the sampling error of the difference between correlated proportions or
/// percentages, Psychometrika 12 (1947), with the exact binomial distribution, two-sided.
double mcnemar_exact(std::int64_t one_way, std::int64_t other_way);

/// Rank correlation of two lists of equal length, -1 to 1; equal values have their mean rank. C. Spearman, The proof
/// and measurement of association between two things, American Journal of Psychology 15 (1904). NaN if one of the lists
/// has only one value.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b);

/// The association of two kinds of words, 0 to 1, from the number of cases by row and column: H. Cramér, Mathematical
/// Methods of Statistics (1946), section 21.9. NaN if cases are in one row or in one column only.
double cramers_v(const std::vector<std::vector<std::int64_t>>& counts);

/// An estimated share of a variance.
struct FirstOrderIndex {
  double share = 0.0;  // 0 to 1
  Interval interval;   // with 95 % confidence
};

/// The share of the variance of the outputs that an input explains alone: Sobol's first-order index, the variance of
/// the mean output at each input, over the variance of the outputs. I. M. Sobol', Sensitivity estimates for nonlinear
/// mathematical models, Mathematical Modelling and Computational Experiment 1 (1993). It is estimated from pairs, as by
/// E. Plischke, E. Borgonovo, C. L. Smith, Global sensitivity measures from given data, European Journal of Operational
/// Research 226 (2013): from the means within parts of the inputs, as many as the root of the number of pairs, or a
/// part for each value if there are fewer. T. L. Kelley's correction, An Unbiased Correlation Ratio Measure,
/// Proceedings of the National Academy of Sciences 21 (1935), removes its bias; below 0 it is 0.
///
/// Within a part the input has an effect, too, as that of a threshold. So the upper end of the interval begins with the
/// variance between neighbours within parts (J. von Neumann, Distribution of the Ratio of the Mean Square Successive
/// Difference to the Variance, The Annals of Mathematical Statistics 12 (1941)), if it is smaller. The two largest of
/// their differences, between different inputs, don't count: they may be thresholds. Both ends are extended by the
/// standard error of a ratio, 1.96 times, which assumes independent pairs.
///
/// The interval doesn't see an effect in a part of the inputs in which hardly any pair lies.
///
/// None if the outputs are all equal, or with fewer than two pairs for each part.
std::optional<FirstOrderIndex> first_order_index(const std::vector<double>& inputs, const std::vector<double>& outputs);

// Reports.

/// The range of a varied number of a fault in the cases that violate an expectation.
struct ViolatingRange {
  std::string key;              // of the fault: "effort"
  double from = 0.0, to = 0.0;  // in the unit of the key
};

/// "effort 0.2 to 0.31", "effort 0.2" if both ends are equal.
std::string to_string(const ViolatingRange& range);

/// How an expectation did in the cases with one fault.
struct FaultCell {
  std::string expectation;                    // as text
  std::int64_t holds = 0;                     // cases
  std::int64_t violated = 0;                  // cases
  std::int64_t unjudged = 0;                  // cases that ended before, or whose verdict is about something else
  std::optional<double> least_margin;         // in the unit of the expectation; none: it has no margin
  std::vector<ViolatingRange> violated_with;  // of the fault's varied numbers; empty: none vary, or no case violates it

  bool survives() const { return holds > 0 && violated == 0 && unjudged == 0; }
};

/// An entry of `faults` with one choice of its varied words.
struct CaseFault {
  std::string owner;       // the kind of its part: sensor, encoder, actuator, link or controller
  std::string body, part;  // names
  std::string fault;       // its kind: "weak"
  /// Other varied words that this kind reads, by their keys.
  std::vector<std::pair<std::string, std::string>> words = {};

  friend auto operator<=>(const CaseFault&, const CaseFault&) = default;
};

/// "actuator Dog/RL_KNEE weak".
std::string to_string(const CaseFault& fault);

/// The cases of a campaign with one fault.
struct FaultRow {
  CaseFault fault;
  std::int64_t cases = 0;
  std::vector<FaultCell> cells;  // by expectation
};

/// "holds in 8", "violated in 2 of 8: effort 0.2 to 0.31", "not judged".
std::string to_string(const FaultCell& cell);

/// The results of a campaign, counted.
struct CampaignSummary {
  std::int64_t cases = 0;  // of the plan
  std::array<std::int64_t, case_verdict_count> verdicts{};
  /// By verdict, the most frequent reason (CaseResult::reason), and the number of reasons.
  std::array<std::pair<std::string, std::size_t>, case_verdict_count> reasons{};
  std::int64_t missing = 0;               // cases without a result
  std::int64_t repeated = 0;              // cases that ran twice
  std::vector<std::int64_t> unrepeated;   // cases whose second run differed; at most 100 of them
  std::int64_t with_errors = 0;           // cases whose controllers wrote numbers that aren't finite, or error lines
  std::int64_t passed_with_errors = 0;    // those of them that pass
  std::optional<ClaimedRate> claim = {};  // of the scenario; none: every case must pass
  /// The number of cases that reached each condition of `sometimes`, by its name.
  std::vector<std::pair<std::string, std::int64_t>> reached = {};
  std::int64_t until_failures = 0;        // the work ended with this failure; 0: it didn't end with a failure
  std::optional<PairedCases> pairs = {};  // with the campaign before a change; none: it isn't compared
  std::optional<NonInferiority> non_inferiority = {};  // of the pairs; none: nothing is claimed of them
  std::vector<FaultRow> faults = {};                   // faults by expectations; empty: the scenario varies no fault

  std::int64_t passed() const { return verdicts[0]; }
  std::int64_t judged() const { return cases - missing; }
  std::int64_t failed() const { return judged() - passed(); }
  /// The share of all cases that pass, estimated. If the work ended with failure K, 1 - (K - 1) / (cases - 1): J. B. S.
  /// Haldane, On a method of estimating frequencies, Biometrika 33 (1945). NaN: no estimate, as with K = 1.
  double share() const;
  double confidence() const;        // of the claim, else 0.95
  Interval interval() const;        // with this confidence
  ClaimAnswer rate_answer() const;  // to the claim; without one it fails with the first case
  /// To all claims: the worse answer. A campaign with a claim of non-inferiority and without one on the rate may have
  /// cases that fail.
  ClaimAnswer answer() const;
  /// The number of cases that would decide the claim, beyond those with a result, if their share that passes stays.
  /// None: it is decided, or no number does.
  std::optional<std::int64_t> more_cases() const;
  /// The conditions of `sometimes` that no case reached, if all cases have a result.
  std::vector<std::string> never_tried() const;
};

Result<CampaignSummary> summary_of(const Campaign& campaign);

/// A sentence, without a full stop: "981 of 1000 cases pass: 98.1 % (97.1 % to 98.8 %)".
std::string verdict(const CampaignSummary& summary);

/// "at least 95 % pass, with 95 % confidence", or that this is false, or undecided; of a summary with a claim.
std::string claim_sentence(const CampaignSummary& summary);

/// A sentence, without a full stop, on cases with errors of controllers; empty: there are none.
std::string error_sentence(const CampaignSummary& summary);

/// A JSON object: claim (null, or at_least, confidence, answer, more_cases), non_inferiority (null, or margin,
/// confidence, difference, interval, answer, more_cases), reached (cases by condition), verdict,
/// cases, verdicts (counts by name), missing, share and interval of those that pass (null: no estimate), until_failures
/// (null: the work didn't end with a failure), repeated, unrepeated, with_errors, passed_with_errors, faults (a list of
/// fault, cases and expectations: expectation, survives, holds, violated, unjudged, least_margin, violated_with, text).
std::string to_json(const CampaignSummary& summary);

/// What else than the results differs between two campaigns with the same plan, a phrase each, as "the model arm.urdf":
/// of their scenarios, models, expectations, controllers and options.
std::vector<std::string> differences(const Campaign& before, const Campaign& now);

/// Writes report.html, report.md, report.json and results.csv into the campaign's folder. `against`: a campaign with
/// the same plan, before a change; null: none. `margin`: that of NonInferiority, claimed with the summary's confidence;
/// none: no claim. Fails if the plans differ, if a margin is claimed of a campaign that ended with a failure, or if a
/// file can't be written.
Result<CampaignSummary> write_campaign_report(const Campaign& campaign, const Campaign* against = nullptr,
                                              const std::optional<double>& margin = {});

}  // namespace rehearse
