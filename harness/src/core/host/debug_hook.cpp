#include "debug_hook.h"

// tools/gdb/rehearse_debug/place.py reads this layout.
static_assert(sizeof(rehearse::DebugPlace) == 64 && sizeof(long) == 8 && sizeof(void*) == 8);

extern "C" {

[[gnu::visibility("default")]] rehearse::DebugPlace rehearse_now;
[[gnu::visibility("default")]] volatile long rehearse_stop_run = 0;
[[gnu::visibility("default")]] volatile long rehearse_stop_tick = 0;
[[gnu::visibility("default")]] volatile long rehearse_watch_trial = 0;

[[gnu::noinline, gnu::used, gnu::visibility("default")]] void rehearse_try_watch() {
  rehearse_watch_trial = rehearse_watch_trial + 1;
}

[[gnu::noinline, gnu::used, gnu::visibility("default")]] void rehearse_at_tick(long tick, const char* controller,
                                                                               cnoid::SimpleController* object) {
  asm volatile("" : : "r"(tick), "r"(controller), "r"(object));  // keeps the arguments for a debugger
}

}  // extern "C"
