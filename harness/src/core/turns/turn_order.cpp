#include "turn_order.h"

#include <algorithm>
#include <utility>

#include "base/chance.h"

namespace rehearse {

TurnOrder::TurnOrder(const std::vector<Exchange>& exchanges) {
  for (const Exchange& exchange : exchanges) exchanges_[exchange.place] = exchange.behind;
}

TurnOrder::TurnOrder(std::uint64_t seed, std::vector<std::int64_t> changes)
    : is_drawn_(true), seed_(seed), changes_(std::move(changes)) {}

/// Between 0 and 1, or negative: the lower, the later it was lowered.
double TurnOrder::priority_of(int thread) const {
  if (const auto found = lowered_.find(thread); found != lowered_.end()) return found->second;
  return Chance(seed_, 0).uniform(static_cast<std::uint64_t>(thread));
}

std::size_t TurnOrder::choose(OrderPlace place, std::span<const int> ready) {
  const std::int64_t count = places_++;
  if (!is_drawn_) {
    const auto found = exchanges_.find(place);
    return found == exchanges_.end() ? 0 : static_cast<std::size_t>(found->second) % ready.size();
  }
  const auto highest = [&] { return std::ranges::max_element(ready, {}, [&](int t) { return priority_of(t); }); };
  if (std::ranges::find(changes_, count) != changes_.end()) lowered_[*highest()] = -1.0 - static_cast<double>(count);
  return static_cast<std::size_t>(highest() - ready.begin());
}

}  // namespace rehearse
