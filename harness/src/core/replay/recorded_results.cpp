#include "recorded_results.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/clock.h"
#include "core/kinds/channel_name.h"
#include "output_record.h"

namespace rehearse {

RecordedResults::RecordedResults(const std::vector<OutputField>& fields, const std::vector<ToleranceRule>& rules,
                                 double time_step)
    : fields_(fields), time_step_(time_step) {
  for (std::size_t word = 0; word < fields.size(); ++word) {
    const OutputField& field = fields[word];
    if (field.channel != run_topics::tick || !field.element.starts_with("controller_results/")) continue;
    const int allowed = tolerance_of(field.element, "", rules).ticks.value_or(default_ticks(EventKind::refusal));
    results_.push_back({word, allowed});
    results_.back().sequence.source = source_of_refusals(field.element);
  }
}

void RecordedResults::take(std::int64_t tick, const std::vector<std::uint64_t>& row,
                           const std::vector<bool>& recorded) {
  bool different = false;
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    OfController& result = results_[i];
    const std::uint64_t now = row[result.word], before = recorded[i] ? 1 : 0;
    different = different || now != before;
    const auto note = [&](std::vector<EventEdge>& edges, bool refuses) {
      const bool refused = !edges.empty() && edges.back().begins;
      if (refuses != refused) edges.push_back({tick, nanoseconds_of(tick, time_step_), refuses});
    };
    note(result.sequence.golden, before == 0);
    note(result.sequence.actual, now == 0);
  }
  if (!different) return;
  ++ticks_different_;
  if (spans_.empty() || spans_.back().second + 1 < tick) spans_.emplace_back(tick, tick);
  spans_.back().second = tick;
}

bool RecordedResults::differ_at(std::int64_t tick) {
  while (span_ < spans_.size() && spans_[span_].second < tick) ++span_;
  return span_ < spans_.size() && spans_[span_].first <= tick;
}

std::vector<JudgedEvent> RecordedResults::judge(std::int64_t last_tick) const {
  std::vector<JudgedEvent> all;
  for (const OfController& result : results_) {
    JudgedSequence judged = judge_sequence(result.sequence, result.allowed, last_tick);
    std::ranges::move(judged.differing, std::back_inserter(all));
  }
  std::ranges::stable_sort(all, {}, [](const JudgedEvent& event) { return event.edge.tick; });
  return all;
}

}  // namespace rehearse
