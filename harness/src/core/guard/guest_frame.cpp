#include "guest_frame.h"

#include <dlfcn.h>
#include <setjmp.h>
#include <signal.h>
#include <unwind.h>

#include <cstdint>
#include <utility>

#include "core/turns/scheduler.h"
#include "process_end.h"

namespace rehearse {
namespace {

constexpr int most_frames = 256;

struct Walk {
  const void* volatile found = nullptr;
  volatile int frames = 0;
};

thread_local constinit volatile sig_atomic_t walks = 0;
thread_local sigjmp_buf end_of_walk;

const void* place_of(_Unwind_Context* frame) {
  int is_interrupted = 0;  // else the address is that of the instruction after a call
  const std::uintptr_t address = _Unwind_GetIPInfo(frame, &is_interrupted) - (is_interrupted != 0 ? 0 : 1);
  return reinterpret_cast<const void*>(address);
}

_Unwind_Reason_Code look_at_frame(_Unwind_Context* frame, void* walk) {
  Walk& here = *static_cast<Walk*>(walk);
  const void* const place = place_of(frame);
  if (is_code_of_guest(place)) here.found = place;
  here.frames = here.frames + 1;
  return here.found || here.frames == most_frames ? _URC_END_OF_STACK : _URC_NO_REASON;
}

}  // namespace

CodePlaces guest_frames() {
  struct Found {
    CodePlaces places{};
    std::size_t count = 0;
  } found;
  const auto look = [](_Unwind_Context* frame, void* walk) {
    Found& here = *static_cast<Found*>(walk);
    if (const void* const place = place_of(frame); is_code_of_guest(place)) here.places[here.count++] = place;
    return here.count == here.places.size() ? _URC_END_OF_STACK : _URC_NO_REASON;
  };
  _Unwind_Backtrace(look, &found);
  return found.places;
}

const void* guest_frame_of(const void* interrupted) {
  if (is_code_of_guest(interrupted)) return interrupted;
  Walk walk;
  TurnThread* const turn = std::exchange(this_turn, nullptr);  // the walk takes locks, and they aren't the guest's
  if (sigsetjmp(end_of_walk, 0) == 0) {
    walks = 1;
    _Unwind_Backtrace(look_at_frame, &walk);
  }
  walks = 0;
  this_turn = turn;
  return walk.found ? walk.found : interrupted;
}

void end_walk_of_frames() {
  if (walks != 0) siglongjmp(end_of_walk, 1);
}

void prepare_guest_frames() {
  Walk walk;
  _Unwind_Backtrace(look_at_frame, &walk);  // the first call may read tables
}

}  // namespace rehearse
