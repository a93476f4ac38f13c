#include "fault_matrix.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/scenario/stated_faults.h"

namespace rehearse {
namespace {

enum class Outcome { holds, violated, unjudged };

Outcome outcome_of(const Campaign& campaign, const CaseTable& table, std::size_t number, std::size_t expectation) {
  const double margin = table.margins[expectation][number];
  if (table.passed(number) || margin > 0.0) return Outcome::holds;
  const bool is_reason = table.verdicts[number] == CaseVerdict::violated &&
                         table.reason_texts[table.reasons[number]] == campaign.expectations()[expectation];
  if (is_reason || margin < 0.0) return Outcome::violated;
  return margin == 0.0 ? Outcome::holds : Outcome::unjudged;
}

std::string_view key_of(const Variation& variation) {
  return std::string_view(variation.path).substr(variation.path.rfind('.') + 1);
}

/// One entry of `faults`, and the parameters that vary it.
class FaultEntry {
 public:
  FaultEntry(const Campaign& campaign, const CaseTable& table, StatedFault stated)
      : campaign_(campaign), table_(table), stated_(std::move(stated)) {
    const std::vector<Variation>& variations = campaign.scenario().variations;
    for (std::size_t i = 0; i < variations.size(); ++i)
      if (stated_.contains(variations[i].path)) (table.words[i].empty() ? numbers_ : words_).push_back(i);
  }

  bool varies() const { return !words_.empty() || !numbers_.empty(); }
  void add_rows(std::vector<FaultRow>& rows) const;

 private:
  CaseFault fault_of(std::size_t number) const;
  FaultCell cell_of(const std::vector<std::size_t>& cases, std::size_t expectation, std::string_view kind) const;

  const Campaign& campaign_;
  const CaseTable& table_;
  const StatedFault stated_;
  std::vector<std::size_t> words_, numbers_;  // parameters
};

CaseFault FaultEntry::fault_of(std::size_t number) const {
  CaseFault made{stated_.owner, stated_.body, stated_.part, stated_.fault};
  for (const std::size_t parameter : words_) {
    const Variation& variation = campaign_.scenario().variations[parameter];
    const std::string& word = table_.words[parameter][static_cast<std::size_t>(table_.values[parameter][number])];
    const std::string_view key = key_of(variation);
    if (key == stated_.owner)
      made.part = word;
    else if (key == "fault")
      made.fault = word;
    else
      made.words.emplace_back(key, word);
  }
  std::erase_if(made.words, [&](const auto& word) { return !fault_reads(made.fault, word.first); });
  return made;
}

FaultCell FaultEntry::cell_of(const std::vector<std::size_t>& cases, std::size_t expectation,
                              std::string_view kind) const {
  FaultCell cell;
  cell.expectation = campaign_.expectations()[expectation];
  std::vector<std::size_t> violating;
  for (const std::size_t number : cases) {
    switch (outcome_of(campaign_, table_, number, expectation)) {
      case Outcome::holds: ++cell.holds; break;
      case Outcome::unjudged: ++cell.unjudged; break;
      case Outcome::violated:
        ++cell.violated;
        violating.push_back(number);
        break;
    }
    const double margin = table_.margins[expectation][number];
    if (!std::isnan(margin)) cell.least_margin = std::min(margin, cell.least_margin.value_or(margin));
  }
  if (violating.empty()) return cell;
  for (const std::size_t parameter : numbers_) {
    const std::string_view key = key_of(campaign_.scenario().variations[parameter]);
    if (!fault_reads(kind, key)) continue;
    const auto [low, high] = std::minmax_element(violating.begin(), violating.end(), [&](std::size_t a, std::size_t b) {
      return table_.values[parameter][a] < table_.values[parameter][b];
    });
    cell.violated_with.push_back({std::string(key), table_.values[parameter][*low], table_.values[parameter][*high]});
  }
  return cell;
}

void FaultEntry::add_rows(std::vector<FaultRow>& rows) const {
  std::map<CaseFault, std::vector<std::size_t>> by_fault;
  for (std::size_t number = 0; number < table_.size(); ++number)
    if (table_.has(number)) by_fault[fault_of(number)].push_back(number);
  for (const auto& [fault, cases] : by_fault) {
    FaultRow& row = rows.emplace_back();
    row.fault = fault;
    row.cases = static_cast<std::int64_t>(cases.size());
    for (std::size_t e = 0; e < table_.margins.size(); ++e) row.cells.push_back(cell_of(cases, e, fault.fault));
  }
}

}  // namespace

std::vector<FaultRow> fault_matrix(const Campaign& campaign, const CaseTable& table) {
  std::vector<FaultRow> rows;
  if (table.margins.empty()) return rows;  // the scenario expects nothing
  for (const StatedFault& stated : stated_faults(campaign.scenario()))
    if (const FaultEntry entry(campaign, table, stated); entry.varies()) entry.add_rows(rows);
  return rows;
}

std::string to_string(const CaseFault& fault) {
  std::string text = fmt::format("{} {}/{} {}", fault.owner, fault.body, fault.part, fault.fault);
  for (const auto& [key, word] : fault.words) text += fmt::format(", {} {}", key, word);
  return text;
}

std::string to_string(const ViolatingRange& range) {
  return range.from == range.to ? fmt::format("{} {:.4g}", range.key, range.from)
                                : fmt::format("{} {:.4g} to {:.4g}", range.key, range.from, range.to);
}

std::string to_string(const FaultCell& cell) {
  const std::int64_t judged = cell.holds + cell.violated;
  if (judged == 0) return "not judged";
  std::string text = cell.violated == 0 ? fmt::format("holds in {}", judged)
                                        : fmt::format("violated in {} of {}", cell.violated, judged);
  std::string_view separator = ": ";
  for (const ViolatingRange& range : cell.violated_with)
    text += fmt::format("{}{}", std::exchange(separator, ", "), to_string(range));
  return cell.unjudged > 0 ? fmt::format("{}; {} not judged", text, cell.unjudged) : text;
}

}  // namespace rehearse
