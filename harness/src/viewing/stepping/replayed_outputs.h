// ReplayedOutputs: the present outputs of the controllers of a recording. Only differences from the recording are
// stored, in a file to save memory, and by tick for direct access. Internal.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/messages.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "message_finder.h"
#include "tick_view.h"

namespace rehearse {

/// The log time of the nearest message of the channel after that time (or before it, backwards) [ns].
std::optional<std::uint64_t> nearest_message(MessageFinder& finder, std::uint16_t channel, std::uint64_t time,
                                             Direction direction);

class ReplayedOutputs {
 public:
  /// Makes the replay. Never fails: failures are reported in remarks().
  static std::unique_ptr<ReplayedOutputs> make(mcap::Reader& trace, const Scenario& scenario,
                                               const SteppingOptions& options, std::optional<double> until);

  const Diagnostics& remarks() const { return remarks_; }
  const std::optional<Diagnostic>& failure() const { return failure_; }
  std::optional<std::int64_t> last_tick() const { return last_tick_; }
  /// Finds the variables that the controllers set, each on its topic; null: nothing was replayed.
  MessageFinder* variables() const { return finder_.get(); }

  bool differs() const { return !places_.empty(); }
  /// The differences of a tick, in the order of discovery.
  std::vector<Divergence> differences(std::uint64_t time) const;
  /// The messages of the controllers in the tick, and the messages about them.
  std::vector<msg::Event> events(std::uint64_t time) const;
  /// A sentence for each thread that took turns, after the tick.
  std::vector<std::string> threads(std::uint64_t time) const;
  bool differs_at(std::uint64_t time) const;
  /// The log time of the nearest tick with a difference after that time (or before it, backwards).
  std::optional<std::uint64_t> difference_beside(std::uint64_t time, Direction direction) const;
  /// As difference_beside(), of a tick with an event.
  std::optional<std::uint64_t> event_beside(std::uint64_t time, Direction direction) const;

 private:
  class Writing;
  struct Place {
    std::string channel, element, unit, note;
    Stage stage = Stage::controller;
  };

  double time_step_ = 0.0;
  std::vector<Place> places_;  // a difference in the file has the index of its place
  std::unique_ptr<MessageFinder> finder_;
  std::uint16_t differences_ = 0, events_ = 0, threads_ = 0;  // channels
  std::optional<std::int64_t> last_tick_;
  std::optional<Diagnostic> failure_;
  Diagnostics remarks_;
};

}  // namespace rehearse
