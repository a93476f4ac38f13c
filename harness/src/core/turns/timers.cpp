// Timers of simulated time that count in a descriptor, as those of timerfd_create().
#include <algorithm>

#include "raw_call.h"
#include "scheduler.h"
#include "waited_descriptors.h"

namespace rehearse {

void TurnScheduler::add_timer(int descriptor, bool is_date) {
  remove_timer(descriptor);
  timers_.push_back({descriptor, is_date});
}

TurnScheduler::Timer* TurnScheduler::timer(int descriptor) {
  const auto found = std::ranges::find(timers_, descriptor, &Timer::descriptor);
  return found == timers_.end() ? nullptr : &*found;
}

void TurnScheduler::remove_timer(int descriptor) {
  std::erase_if(timers_, [&](const Timer& timer) { return timer.descriptor == descriptor; });
}

void TurnScheduler::fire_timers() {
  for (Timer& timer : timers_) {
    if (timer.next > now_) continue;
    std::uint64_t count = 1;
    if (timer.period > 0) {
      count += static_cast<std::uint64_t>((now_ - timer.next) / timer.period);
      timer.next += static_cast<std::int64_t>(count) * timer.period;
    } else {
      timer.next = never;
    }
    raw_call(SYS_write, timer.descriptor, reinterpret_cast<long>(&count), sizeof count);
    wake(waited_descriptors, 1 << 30);
  }
}

/// Never, if no thread waits for a descriptor.
std::int64_t TurnScheduler::earliest_timer() const {
  std::int64_t first = never;
  for (const TurnThread* thread : waiting_)
    if (thread->wait.object == waited_descriptors)
      for (const Timer& timer : timers_) first = std::min(first, timer.next);
  return first;
}

}  // namespace rehearse
