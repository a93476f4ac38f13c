#include "recorded_results.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "model/clock.h"
#include "output_record.h"
#include "trace/channel_name.h"

namespace rehearse {

RecordedResults::RecordedResults(const std::vector<OutputField>& fields, const std::vector<ToleranceRule>* rules,
                                 double time_step)
    : fields_(fields), rules_(rules), time_step_(time_step) {
  for (std::size_t word = 0; word < fields.size(); ++word) {
    const OutputField& field = fields[word];
    if (field.channel != run_topics::tick || !field.element.starts_with("controller_results/")) continue;
    results_.push_back({word});
    results_.back().sequence.source = source_of_refusals(field.element);
  }
}

void RecordedResults::compare(std::int64_t tick, const std::vector<std::uint64_t>& row,
                              const std::vector<bool>& recorded, const OnDifference& differs) {
  bool different = false;
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    const std::uint64_t now = row[results_[i].word], before = recorded[i] ? 1 : 0;
    if (!rules_) {
      if (auto found = difference(fields_[results_[i].word], before, now)) differs(*std::move(found));
      continue;
    }
    different = different || now != before;
    const auto note = [&](std::vector<EventEdge>& edges, bool refuses) {
      const bool refused = !edges.empty() && edges.back().begins;
      if (refuses != refused) edges.push_back({tick, nanoseconds_of(tick, time_step_), refuses});
    };
    note(results_[i].sequence.golden, before == 0);
    note(results_[i].sequence.actual, now == 0);
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
  if (!rules_) return all;
  for (const OfController& result : results_) {
    const auto stated = tolerance_of(result.sequence.source.element, "", *rules_).ticks;
    JudgedSequence judged =
        judge_sequence(result.sequence, stated.value_or(default_ticks(EventKind::refusal)), last_tick);
    std::ranges::move(judged.differing, std::back_inserter(all));
  }
  std::ranges::stable_sort(all, {}, [](const JudgedEvent& event) { return event.edge.tick; });
  return all;
}

}  // namespace rehearse
