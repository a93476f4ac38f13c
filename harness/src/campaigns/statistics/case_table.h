// The results of a campaign as columns of numbers. Internal.
#pragma once

#include <rehearse/campaign_report.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

struct CaseTable {
  /// Reads all result lines. Of a case with several the first counts.
  static Result<CaseTable> of(const Campaign& campaign);

  std::size_t size() const { return verdicts.size(); }
  bool has(std::size_t number) const { return verdicts[number].has_value(); }
  bool passed(std::size_t number) const { return verdicts[number] == CaseVerdict::passed; }

  // by case
  std::vector<std::optional<CaseVerdict>> verdicts;  // none: missing
  std::vector<std::int64_t> ticks, failing_ticks;    // -1: none
  std::vector<std::uint64_t> hashes;
  std::vector<std::size_t> reasons;  // index into reason_texts
  std::vector<std::int64_t> errors;  // of controllers

  std::vector<std::vector<double>> margins;     // by expectation, by case; NaN: none
  std::vector<std::vector<double>> values;      // by variation, by case; of words their place in `words`
  std::vector<std::vector<std::string>> words;  // by variation; empty: its values are numbers
  std::vector<bool> logarithmic;                // by variation: its distribution is log_uniform
  std::vector<std::string> reason_texts, reason_examples;

  std::map<std::int64_t, std::string> first_errors;  // by case with errors

  std::vector<std::int64_t> reached;  // by condition of `sometimes`: the number of cases

  std::int64_t repeated = 0;
  std::vector<std::int64_t> unrepeated;
};

}  // namespace rehearse
