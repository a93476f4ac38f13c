#include "case_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "base/text.h"

namespace rehearse {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t most_unrepeated = 100;

std::uint64_t hash_of_text(const std::string& text) {
  std::uint64_t hash = 0;
  std::from_chars(text.data(), text.data() + text.size(), hash, 16);
  return hash;
}

std::optional<double> finite_number(const std::string& text) {
  const auto number = number_in<double>(text);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

/// A parameter with a value that is no number has words; they are in the order of the alphabet.
void read_values(const Campaign& campaign, CaseTable& table) {
  const std::size_t count = campaign.scenario().variations.size();
  table.values.assign(count, std::vector<double>(table.size()));
  table.words.resize(count);
  for (const Variation& variation : campaign.scenario().variations)
    table.logarithmic.push_back(variation.distribution == Distribution::log_uniform);
  std::vector<bool> has_words(count);
  for (std::size_t number = 0; number < table.size(); ++number) {
    const std::vector<std::string> values = campaign.values_of(static_cast<std::int64_t>(number));
    for (std::size_t i = 0; i < count; ++i)
      if (const auto value = finite_number(values[i]))
        table.values[i][number] = *value;
      else
        has_words[i] = true;
  }
  if (std::ranges::count(has_words, true) == 0) return;
  std::vector<std::map<std::string, std::vector<std::size_t>>> cases(count);  // by word
  for (std::size_t number = 0; number < table.size(); ++number) {
    std::vector<std::string> values = campaign.values_of(static_cast<std::int64_t>(number));
    for (std::size_t i = 0; i < count; ++i)
      if (has_words[i]) cases[i][std::move(values[i])].push_back(number);
  }
  for (std::size_t i = 0; i < count; ++i)
    for (const auto& [word, these] : cases[i]) {
      for (const std::size_t number : these) table.values[i][number] = static_cast<double>(table.words[i].size());
      table.words[i].push_back(word);
    }
}

}  // namespace

Result<CaseTable> CaseTable::of(const Campaign& campaign) {
  CaseTable table;
  const auto size = static_cast<std::size_t>(campaign.options().cases);
  table.verdicts.resize(size);
  table.ticks.assign(size, -1);
  table.failing_ticks.assign(size, -1);
  table.hashes.resize(size);
  table.reasons.resize(size);
  table.errors.resize(size);
  table.margins.assign(campaign.expectations().size(), std::vector<double>(size, none));
  std::map<std::string, std::size_t> places;
  std::vector<std::int64_t> lowest;  // case by reason
  std::vector<CaseResult> second_runs;
  auto read = campaign.read_results([&](const CaseResult& result) {
    const auto i = static_cast<std::size_t>(result.number);
    if (result.again || table.verdicts[i]) return second_runs.push_back(result);
    table.verdicts[i] = result.verdict;
    table.ticks[i] = result.ticks;
    table.failing_ticks[i] = result.tick.value_or(-1);
    table.hashes[i] = hash_of_text(result.hash);
    table.errors[i] = result.errors;
    if (result.errors > 0) table.first_errors[result.number] = result.first_error;
    const auto [place, is_new] = places.emplace(result.reason, places.size());
    table.reasons[i] = place->second;
    if (is_new) {
      table.reason_texts.push_back(result.reason);
      table.reason_examples.emplace_back();
      lowest.push_back(result.number + 1);
    }
    if (result.number < lowest[place->second]) {
      table.reason_examples[place->second] = result.sentence;
      lowest[place->second] = result.number;
    }
    table.reached.resize(std::max(table.reached.size(), result.reached.size()));
    for (std::size_t condition = 0; condition < result.reached.size(); ++condition)
      table.reached[condition] += result.reached[condition] ? 1 : 0;
    for (std::size_t e = 0; e < std::min(table.margins.size(), result.margins.size()); ++e)
      table.margins[e][i] = result.margins[e].value_or(none);
  });
  if (!read) return read.errors();
  std::set<std::int64_t> twice, different;
  for (const CaseResult& second : second_runs) {
    const auto i = static_cast<std::size_t>(second.number);
    if (!table.verdicts[i]) continue;  // another process hasn't made the first run yet
    twice.insert(second.number);
    const bool is_same = table.verdicts[i] == second.verdict && table.hashes[i] == hash_of_text(second.hash) &&
                         table.failing_ticks[i] == second.tick.value_or(-1) && table.ticks[i] == second.ticks;
    if (!is_same) different.insert(second.number);
  }
  table.repeated = static_cast<std::int64_t>(twice.size());
  for (const std::int64_t number : different)
    if (table.unrepeated.size() < most_unrepeated) table.unrepeated.push_back(number);
  read_values(campaign, table);
  return table;
}

}  // namespace rehearse
