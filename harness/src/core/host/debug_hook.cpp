#include "debug_hook.h"

#include <array>
#include <iterator>

#include "core/turns/scheduler.h"

// tools/gdb/rehearse_debug/place.py reads this layout.
static_assert(sizeof(rehearse::DebugPlace) == 64 && sizeof(rehearse::DebugThread) == 40 && sizeof(long) == 8 &&
              sizeof(void*) == 8);

extern "C" {

[[gnu::visibility("default")]] rehearse::DebugPlace rehearse_now;
[[gnu::visibility("default")]] volatile long rehearse_stop_run = 0;
[[gnu::visibility("default")]] volatile long rehearse_stop_tick = 0;
[[gnu::visibility("default")]] volatile long rehearse_watch_trial = 0;

[[gnu::visibility("default")]] rehearse::DebugThread rehearse_threads[64];

[[gnu::noinline, gnu::used, gnu::visibility("default")]] long rehearse_list_threads() {
  static std::array<rehearse::TurnScheduler::Listed, std::size(rehearse_threads)> listed;
  const std::size_t count = rehearse::TurnScheduler::instance().list(listed);
  for (std::size_t i = 0; i < count; ++i)
    rehearse_threads[i] = {listed[i].tid, listed[i].number, listed[i].has_turn, listed[i].name, listed[i].waits_for};
  return count > 1 ? static_cast<long>(count) : 0;
}

[[gnu::noinline, gnu::used, gnu::visibility("default")]] void rehearse_try_watch() {
  rehearse_watch_trial = rehearse_watch_trial + 1;
}

[[gnu::noinline, gnu::used, gnu::visibility("default")]] void rehearse_at_tick(long tick, const char* controller,
                                                                               cnoid::SimpleController* object) {
  asm volatile("" : : "r"(tick), "r"(controller), "r"(object));  // keeps the arguments for a debugger
}

}  // extern "C"
