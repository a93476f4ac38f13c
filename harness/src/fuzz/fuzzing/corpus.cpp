#include "corpus.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rehearse {

/// The columns in which the inputs differ from those that were the nearest so far, if they are few.
void Corpus::note_columns(Comparison& comparison, const Inputs& inputs) const {
  const Inputs& before = entries_[comparison.entry].inputs;
  std::vector<std::size_t> changed;
  for (std::size_t column = 0; column < inputs.columns; ++column)
    for (int tick = 0; tick < std::min(inputs.ticks(), before.ticks()); ++tick)
      if (inputs.at(tick, column) != before.at(tick, column)) {
        changed.push_back(column);
        break;
      }
  constexpr std::size_t few = 2, most = 6;
  if (changed.empty() || changed.size() > few) return;
  comparison.columns.insert(comparison.columns.end(), changed.begin(), changed.end());
  if (comparison.columns.size() > most)
    comparison.columns.erase(comparison.columns.begin(), comparison.columns.end() - most);
}

bool Corpus::note_comparison(const SeenComparison& seen, const Inputs& inputs, std::size_t entry) {
  const auto [found, is_first] = comparisons_.try_emplace(seen.place);
  Comparison& known = found->second;
  if (is_first) {
    known = {seen.seen, seen.distance, entry, seen.a, seen.b, false, {}};
    return true;
  }
  const bool is_new = (seen.seen & ~known.seen) != 0;
  const bool begins_to_vary = !known.varies && (seen.a != known.a || seen.b != known.b);
  // a hair's breadth is no progress
  const bool is_nearer = is_open(known) && seen.distance < 0.8 * known.distance;
  if (!is_new && !is_nearer && !begins_to_vary) return false;
  known.varies = known.varies || begins_to_vary;
  known.seen |= seen.seen;
  if (seen.distance < known.distance) {
    if (known.entry < entry) note_columns(known, inputs);
    known.distance = seen.distance;
    known.entry = entry;
  }
  return true;
}

bool Corpus::take(const Inputs& inputs, std::int64_t run, const InputOutcome& outcome) {
  const std::size_t entry = entries_.size();
  bool is_new = false;
  for (const std::uint32_t state : outcome.states) is_new = !states_.contains(state) || is_new;
  for (const SeenComparison& comparison : outcome.comparisons)
    is_new = note_comparison(comparison, inputs, entry) || is_new;
  const auto note_best = [&](std::vector<Best>& all, std::size_t index, double value, bool is_better) {
    if (index < all.size() && !is_better) return;
    if (index >= all.size()) all.resize(index + 1);
    all[index] = {value, entry};
    is_new = true;
  };
  for (std::size_t i = 0; i < outcome.margins.size(); ++i) {
    const double known = i < margins_.size() ? margins_[i].value : std::numeric_limits<double>::infinity();
    note_best(margins_, i, outcome.margins[i], outcome.margins[i] < known - 0.05 * std::abs(known));
  }
  for (std::size_t i = 0; i < outcome.peaks.size(); ++i) {
    const double known = i < peaks_.size() ? peaks_[i].value : 0.0;
    note_best(peaks_, i, outcome.peaks[i], outcome.peaks[i] > 1.2 * known);
  }
  if (!is_new) return false;
  states_.insert(outcome.states.begin(), outcome.states.end());
  entries_.push_back({inputs, run, outcome.comparisons});
  return true;
}

std::int64_t Corpus::points() const {
  std::set<std::uint32_t> edges;
  for (const std::uint32_t state : states_)
    if (state >> 28 == 1) edges.insert(state >> 4);
  return static_cast<std::int64_t>(edges.size());
}

Corpus::Choice Corpus::choose(Dice& dice) const {
  Choice choice;
  std::vector<std::uint32_t> open;
  for (const auto& [place, comparison] : comparisons_)
    if (is_open(comparison)) open.push_back(place);
  const double kind = dice.uniform();
  const auto newest = [&] {
    const double share = dice.uniform();
    return entries_.size() - 1 - static_cast<std::size_t>(share * share * static_cast<double>(entries_.size()));
  };
  if (kind < 0.4 && !open.empty()) {
    const std::uint32_t place = open[dice.below(open.size())];
    choice.entry = comparisons_.at(place).entry;
    choice.is_aimed = true;
    choice.columns = comparisons_.at(place).columns;
    for (const SeenComparison& seen : entries_[choice.entry].comparisons)
      if (seen.place == place) choice.hints.push_back(seen);
    return choice;
  }
  if (kind < 0.5 && !margins_.empty())
    choice.entry = margins_[dice.below(margins_.size())].entry;
  else if (kind < 0.55 && !peaks_.empty())
    choice.entry = peaks_[dice.below(peaks_.size())].entry;
  else
    choice.entry = std::min(newest(), entries_.size() - 1);
  choice.hints = entries_[choice.entry].comparisons;
  return choice;
}

}  // namespace rehearse
