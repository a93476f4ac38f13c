// rehearse replay --tick, --at, --watch and --when: prints parts of a recording while its controllers are replayed.
#pragma once

#include "viewing/stepping/tick_view.h"

#include <optional>
#include <string>
#include <vector>

#include "command.h"

namespace rehearse::tool {

struct TickSettings {
  std::string trace;
  HostOptions host;
  std::optional<std::int64_t> tick;
  std::optional<double> at;        // [s]
  std::vector<std::string> watch;  // globs, or names as in an expression
  std::string when;
  double from = 0.0;            // [s]
  std::optional<double> until;  // [s]
  std::int64_t every = 1;
  bool full = false;
  bool json = false;

  bool shows_a_tick() const { return tick || at; }
  bool is_asked() const { return shows_a_tick() || !watch.empty() || !when.empty(); }
};

/// An error if options contradict each other.
Result<void> check_usage(const TickSettings& settings);
Exit show_ticks(const TickSettings& settings);

/// Prints remarks about the trace to stderr.
void tell_remarks(const SteppedTrace& trace);

}  // namespace rehearse::tool
