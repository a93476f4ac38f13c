// Counts the calls by which control() may miss its deadline: allocations, locks, system calls, exceptions.
//
// The functions of c_functions.h that have a cost are replaced, in the whole process. A replacement that isn't counted
// costs a jump: it compares one thread-local pointer with null. Counts are equal in all runs of a controller that is a
// function of its inputs; they don't depend on the machine.
#pragma once

#include <rehearse/messages.h>

#include <cstdint>
#include <string_view>

namespace rehearse {

/// The count to which a call is added, in the order of the fields of msg::ControlCost.
enum class Cost : std::uint8_t { none, allocation, release, lock, system_call, exception };

/// "allocation", "release", "lock", "system call", "exception"; none: "".
std::string_view to_string(Cost cost);

/// During its lifetime the calls of this thread are added to `costs`; null: they aren't counted.
class CountedCall {
 public:
  explicit CountedCall(msg::ControlCost* costs);
  ~CountedCall() { stop(); }
  CountedCall(const CountedCall&) = delete;
  CountedCall& operator=(const CountedCall&) = delete;
  /// Ends all counting of this thread, after a call that was ended without destructors.
  static void stop();
};

/// During its lifetime the calls of this thread are the host's own and aren't counted.
class HostCode {
 public:
  HostCode();
  ~HostCode();
  HostCode(const HostCode&) = delete;
  HostCode& operator=(const HostCode&) = delete;

 private:
  msg::ControlCost* outer_;
};

/// Adds bytes that a controller wrote to os(), if this thread counts.
void count_message_bytes(std::uint64_t bytes);

/// True if the calls of this process reach the counters. They don't with another allocator that is loaded earlier
/// (LD_PRELOAD, valgrind), or on other processors than x86-64.
bool can_count_costs();
/// The reason if they don't.
inline constexpr std::string_view why_no_costs =
#if defined(__x86_64__)
    "another allocator is loaded before Rehearse's libraries";
#else
    "they aren't recorded on this processor, which isn't an x86-64";
#endif

/// Called for each counted call, on its thread, while nothing is counted; null: nothing is called. `function`: its name
/// in the C library.
using CostObserver = void (*)(Cost cost, const char* function);
void observe_costs(CostObserver observer);

}  // namespace rehearse
