// The interposer: a library that is loaded before all others (LD_PRELOAD) and sees what a controller asks of the
// system.
//
// It takes note of the calls (audit/call_log.h), and gives other answers than the system's where it was told to:
// another time, other random numbers, other thread schedules. It does so only for calls made by a controller: on the
// thread that called it, while it is called, with the controller's own code on the stack; and on threads that it
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

/// An address in a file of code: of the call itself, not of what follows it.
struct CodePlace {
  std::string module;        // path of the library
  std::uint64_t offset = 0;  // virtual address in it, as its symbols have it

  friend bool operator==(const CodePlace&, const CodePlace&) = default;
  friend auto operator<=>(const CodePlace&, const CodePlace&) = default;
};

/// A clock that follows the simulation: `start + rate * (time of the tick)`, and `read_step` more with each further
/// reading in the same call, so that nobody waits for ever. Sleeping takes no time but moves it on by what was asked
/// for.
struct SimulatedClock {
  std::int64_t date = 1'767'225'600'000'000'000;  // [ns] since 1970 at time 0: 2026-01-01 UTC
  std::int64_t uptime = 1'000'000'000'000;        // [ns] monotonic clocks at time 0
  std::int64_t rate = 1'000'000;                  // [ppm] of simulated time
  std::int64_t read_step = 1;                     // [ns]

  /// Another date, another uptime, and running at another rate.
  SimulatedClock shifted() const;
};

enum class ThreadSchedule {
  as_it_comes,
  late,   // what a controller starts begins some milliseconds later
  early,  // the controller goes on some milliseconds after it started it
};

/// What a controller is given instead of what the system has.
struct Substitution {
  std::optional<SimulatedClock> clock;  // none: the system's
  std::optional<std::uint64_t> seed;    // of all random sources; none: the system's
  int machine = 0;                      // number of an imaginary machine, its user and terminal; 0: the real ones
  ThreadSchedule threads = ThreadSchedule::as_it_comes;
  int slow = 0;  // [us] of real time to sleep before each control()
};

struct InterposerSettings {
  std::filesystem::path log;    // empty: none
  std::filesystem::path files;  // where copies of the files are that controllers write; empty: they write the files
  Substitution everywhere;
  /// At calls from this place (audit/call_log.h: ObservedCall::place) the clock and the seed are these; at all others
  /// `everywhere`.
  std::optional<CodePlace> only;
  Substitution there;
};

/// The file of the interposer, beside our own libraries. Fails if it isn't there.
Result<std::filesystem::path> interposer_library();

/// What changes in the environment of a process to run under the interposer; none: to be removed. An LD_PRELOAD and
/// ASAN_OPTIONS of the user's stay. Fails as interposer_library() does.
Result<std::map<std::string, std::optional<std::string>>> interposer_environment(const InterposerSettings& settings);

/// True if this process runs under the interposer.
bool is_interposed();

/// Paints the stack below its caller, so that a local variable without an initial value holds this and not what chance
/// left there.
class StackFill {
 public:
  static constexpr std::size_t depth = 81920;  // [bytes]; the first 16 KiB are left free by guarded_call()
  explicit StackFill(unsigned char pattern) : pattern_(pattern) {}
  void paint() const;

 private:
  unsigned char pattern_;
};

/// The watch to put into HostOptions::watch of a process under the interposer: tells it of each call, and paints the
/// stack before each if there is a fill. In a process without the interposer it only paints. To be made before the
/// first run: it takes the interposer's variables out of the environment, for neither controllers nor their programs to
/// see.
class InterposerWatch : public ControllerWatch {
 public:
  explicit InterposerWatch(std::optional<StackFill> fill = {});
  void enter(const ControllerCall& call) override;
  void leave() override;

 private:
  std::optional<StackFill> fill_;
};

}  // namespace rehearse
