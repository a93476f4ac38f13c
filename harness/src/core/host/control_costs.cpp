// ControlCosts: the sums of a run, and the sentence about them.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/diagnostic.h>
#include <rehearse/run_options.h>
#include <sys/resource.h>

#include <iterator>

#include "core/kinds/cost_fields.h"

namespace rehearse {
namespace {

bool is_fault(std::string_view name) {
  for (const CostField& field : cost_fields)
    if (field.name == name) return !field.one.empty();
  return false;
}

std::string_view words_of(const ControlCosts::Count& count) {
  for (const CostField& field : cost_fields)
    if (field.name == count.name) return count.total == 1 ? field.one : field.many;
  return count.name;
}

/// "4000 allocations in 998 ticks, first at tick 1"
std::string text_of(const ControlCosts::Count& count) {
  return fmt::format("{} {} in {} tick{}, first at tick {}", count.total, words_of(count), count.ticks,
                     count.ticks == 1 ? "" : "s", count.first_tick);
}

}  // namespace

void ControlCosts::add(std::int64_t tick, const msg::ControlCost& cost, std::uint64_t faults) {
  if (counts.empty())
    for (const CostField& field : cost_fields) counts.push_back({field.name});
  if (tick == 0) return;
  const auto count = [tick](Count& sum, std::uint64_t number) {
    if (number == 0) return;
    if (sum.total == 0) sum.first_tick = tick;
    sum.total += number;
    ++sum.ticks;
  };
  for (std::size_t i = 0; i < std::size(cost_fields); ++i) count(counts[i], cost.*cost_fields[i].count);
  count(page_faults, faults);
}

bool ControlCosts::is_realtime_safe() const {
  for (const Count& count : counts)
    if (count.total > 0 && is_fault(count.name)) return false;
  return true;
}

std::string realtime_sentence(const ControlTimes& control) {
  REHEARSE_ASSERT(control.costs.has_value(), "only of a run that counts costs");
  if (control.calls <= 1) return fmt::format("control() of {} ran in no tick after tick 0", control.controller);
  if (control.costs->is_realtime_safe())
    return fmt::format(
        "control() of {} is real-time safe in {} ticks, as to calls: no allocation, lock, system call or exception "
        "after tick 0",
        control.controller, control.calls);
  std::vector<std::string> texts;
  for (const ControlCosts::Count& count : control.costs->counts)
    if (count.total > 0 && is_fault(count.name)) texts.push_back(text_of(count));
  return fmt::format("control() of {} isn't real-time safe: {}", control.controller, fmt::join(texts, "; "));
}

std::uint64_t page_faults_of_thread() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return static_cast<std::uint64_t>(usage.ru_minflt + usage.ru_majflt);
}

}  // namespace rehearse
