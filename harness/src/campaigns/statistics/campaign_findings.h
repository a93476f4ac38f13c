// The findings of a campaign, as all forms of its report state them. Internal.
#pragma once

#include <rehearse/campaign_report.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "case_table.h"

namespace rehearse {

/// Failed cases with one reason.
struct FailureKind {
  std::string reason;
  CaseVerdict verdict = CaseVerdict::passed;
  std::size_t count = 0;
  std::string sentence;                  // of one of them
  std::vector<std::int64_t> cases = {};  // the first of them
};

/// The most frequent first.
std::vector<FailureKind> failures_of(const CaseTable& table);

/// Cases whose controllers wrote one kind of error.
struct ErrorKind {
  std::string error;  // without its numbers
  std::size_t count = 0;
  std::int64_t passed = 0;  // cases
  std::string example;
  std::vector<std::int64_t> cases = {};  // the first of them
};

/// The cases in which a parameter has one word.
struct WordShare {
  std::string word;
  std::int64_t cases = 0, passed = 0;
  std::optional<double> share = {};  // that passes
  Interval interval = {};            // of the share
};

/// A number about a parameter and the margin of an expectation.
struct OfMargin {
  std::string expectation;
  double number = 0.0;
};

struct IndexOfMargin {
  std::string expectation;
  FirstOrderIndex index;
};

/// The effects of a varied parameter. None: unknown, or not of this kind of parameter.
struct ParameterFindings {
  std::string name, path, nominal;
  std::optional<double> correlation_with_passing = {};   // rank correlation
  std::optional<OfMargin> correlation_with_margin = {};  // the largest one
  std::optional<FirstOrderIndex> importance_of_passing = {};
  std::optional<IndexOfMargin> importance_of_margin = {};  // the largest one
  std::optional<double> median_of_passed = {}, median_of_failed = {};
  // of a parameter with words, which have no order
  bool has_words = false;
  std::optional<double> association_with_passing = {};  // Cramér's V
  std::vector<WordShare> words = {};

  /// Without its sign; 0: unknown.
  double largest_effect() const;
};

/// The margins of an expectation, in its unit. None: no case has one.
struct MarginFindings {
  std::string expectation;
  std::optional<double> least = {}, percentile_5 = {}, median = {}, largest = {};
  std::vector<std::pair<std::int64_t, double>> worst_passes = {};  // case and margin
};

/// The cells of a pair of parameters, equal parts of the ranges that occur, which no case with a result visited.
struct UnvisitedCells {
  std::array<std::string, 2> parameters;
  std::size_t cells = 0, unvisited = 0;
  std::vector<std::array<std::string, 2>> examples = {};
};

/// The cases that have a result in two campaigns.
struct CampaignChange {
  PairedCases pairs = {};
  std::int64_t same_bits = 0;
  double p = 1.0;  // McNemar's
  std::optional<double> difference = {};
  Interval interval = {};                                          // of the difference
  std::vector<std::int64_t> broken_cases = {}, mended_cases = {};  // the first of them
  std::vector<std::string> differences = {};                       // between the campaigns, a phrase each
};

struct CampaignFindings {
  std::string scenario;
  std::uint64_t seed = 0;
  std::string plan;  // digest
  CampaignSummary summary = {};
  CaseResult nominal = {};
  std::vector<FailureKind> failures = {};  // the most frequent first
  std::vector<ErrorKind> errors = {};      // likewise
  std::vector<ParameterFindings> parameters = {};
  std::vector<MarginFindings> margins = {};
  std::vector<UnvisitedCells> cells = {};
  std::optional<CampaignChange> against = {};

  static CampaignFindings of(const Campaign& campaign, const CaseTable& table, CampaignSummary summary);
};

}  // namespace rehearse
