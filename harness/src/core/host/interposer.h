// The interposer: a library that is loaded before all others (LD_PRELOAD) and observes a controller's calls to the
// system.
//
// It logs the calls (audit/call_log.h), and replaces the system's answers if requested: a different time, different
// random numbers, different thread schedules. It does so only for calls made by a controller. These are calls on the
// thread that called it, during the call, with the controller's own code on the stack; and calls on threads that it
// created.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "controller_watch.h"

namespace rehearse {

/// An address in a file of code: the address of the call itself, not of the instruction after it.
struct CodePlace {
  std::string module;        // path of the library
  std::uint64_t offset = 0;  // virtual address in it, as in its symbols

  friend bool operator==(const CodePlace&, const CodePlace&) = default;
  friend auto operator<=>(const CodePlace&, const CodePlace&) = default;
};

/// A clock that follows the simulation: `start + rate * (time of the tick)`. It adds `read_step` for each further
/// reading in the same call, so that no loop waits for ever. Sleeping takes no real time but advances the clock by the
/// requested time.
struct SimulatedClock {
  std::int64_t date = 1'767'225'600'000'000'000;  // [ns] since 1970 at time 0: 2026-01-01 UTC
  std::int64_t uptime = 1'000'000'000'000;        // [ns] monotonic clocks at time 0
  std::int64_t rate = 1'000'000;                  // [ppm] of simulated time
  std::int64_t read_step = 1;                     // [ns]

  /// A clock with a different date, uptime and rate.
  SimulatedClock shifted() const;
};

enum class ThreadSchedule {
  as_it_comes,
  late,   // threads of a controller begin some milliseconds later
  early,  // the controller continues some milliseconds after it started a thread
};

/// The answers that a controller gets instead of the system's.
struct Substitution {
  std::optional<SimulatedClock> clock;  // none: the system's
  std::optional<std::uint64_t> seed;    // of all random sources; none: the system's
  int machine = 0;                      // number of an imaginary machine, its user and terminal; 0: the real ones
  ThreadSchedule threads = ThreadSchedule::as_it_comes;
  int slow = 0;  // [us] of real time to sleep before each control()
};

struct InterposerSettings {
  std::filesystem::path log;  // empty: none
  /// Folder for copies of files that controllers write; empty: they write the files themselves.
  std::filesystem::path files;
  Substitution everywhere;
  /// At calls from this place (audit/call_log.h: ObservedCall::place) the clock and the seed are these; at all other
  /// places `everywhere` is used.
  std::optional<CodePlace> only;
  Substitution there;
};

/// The file of the interposer, in the folder of Rehearse's libraries. Fails if it doesn't exist.
Result<std::filesystem::path> interposer_library();

/// The changes to the environment of a process that must run under the interposer; a variable without value is removed.
/// The user's LD_PRELOAD and ASAN_OPTIONS are kept. Fails as interposer_library() does.
Result<std::map<std::string, std::optional<std::string>>> interposer_environment(const InterposerSettings& settings);

/// True if this process runs under the interposer.
bool is_interposed();

/// Logs each counted call of a controller (cost_counter.h) with its place, in a process under the interposer.
void log_costs();

/// Fills the stack below its caller, so that a local variable without an initial value has this value instead of a
/// random one.
class StackFill {
 public:
  static constexpr std::size_t depth = 81920;  // [bytes]; guarded_call() leaves the first 16 KiB free
  explicit StackFill(unsigned char pattern) : pattern_(pattern) {}
  void paint() const;

 private:
  unsigned char pattern_;
};

/// The watch for HostOptions::watch in a process under the interposer: notifies it of each call, and fills the stack
/// before each if there is a fill. Without the interposer it only fills the stack. It must be created before the first
/// run: it removes the interposer's variables from the environment, so that neither controllers nor their programs see
/// them.
class InterposerWatch : public ControllerWatch {
 public:
  explicit InterposerWatch(std::optional<StackFill> fill = {});
  void enter(const ControllerCall& call) override;
  void leave() override;

 private:
  std::optional<StackFill> fill_;
};

}  // namespace rehearse
