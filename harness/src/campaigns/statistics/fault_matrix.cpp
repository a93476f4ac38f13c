#include "fault_matrix.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

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
  struct Named {
    std::string text, kind;
  };
  Named named(std::size_t number) const;
  FaultCell cell_of(const std::vector<std::size_t>& cases, std::size_t expectation, std::string_view kind) const;

  const Campaign& campaign_;
  const CaseTable& table_;
  const StatedFault stated_;
  std::vector<std::size_t> words_, numbers_;  // parameters
};

/// The fault of a case in words.
FaultEntry::Named FaultEntry::named(std::size_t number) const {
  std::string part = stated_.part, fault = stated_.fault, rest;
  for (const std::size_t parameter : words_) {
    const Variation& variation = campaign_.scenario().variations[parameter];
    const std::string& word = table_.words[parameter][static_cast<std::size_t>(table_.values[parameter][number])];
    const std::string_view key = key_of(variation);
    if (key == stated_.owner)
      part = word;
    else if (key == "fault")
      fault = word;
    else if (fault_reads(fault, key))
      rest += fmt::format(", {} {}", key, word);
  }
  return {fmt::format("{} {}/{} {}{}", stated_.owner, stated_.body, part, fault, rest), fault};
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
    const double from = table_.values[parameter][*low], to = table_.values[parameter][*high];
    cell.violated_with.push_back(from == to ? fmt::format("{} {:.4g}", key, from)
                                            : fmt::format("{} {:.4g} to {:.4g}", key, from, to));
  }
  return cell;
}

void FaultEntry::add_rows(std::vector<FaultRow>& rows) const {
  struct Cases {
    std::string kind;
    std::vector<std::size_t> numbers;
  };
  std::map<std::string, Cases> by_fault;
  for (std::size_t number = 0; number < table_.size(); ++number) {
    if (!table_.has(number)) continue;
    Named name = named(number);
    Cases& cases = by_fault[std::move(name.text)];
    cases.kind = std::move(name.kind);
    cases.numbers.push_back(number);
  }
  for (const auto& [fault, cases] : by_fault) {
    FaultRow& row = rows.emplace_back();
    row.fault = fault;
    row.cases = static_cast<std::int64_t>(cases.numbers.size());
    for (std::size_t e = 0; e < table_.margins.size(); ++e) row.cells.push_back(cell_of(cases.numbers, e, cases.kind));
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

std::string to_string(const FaultCell& cell) {
  const std::int64_t judged = cell.holds + cell.violated;
  if (judged == 0) return "not judged";
  std::string text = cell.violated == 0 ? fmt::format("holds in {}", judged)
                                        : fmt::format("violated in {} of {}", cell.violated, judged);
  if (!cell.violated_with.empty()) text += fmt::format(": {}", fmt::join(cell.violated_with, ", "));
  return cell.unjudged > 0 ? fmt::format("{}; {} not judged", text, cell.unjudged) : text;
}

}  // namespace rehearse
