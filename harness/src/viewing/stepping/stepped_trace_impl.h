// The implementation of SteppedTrace. Internal; stepped_trace.cpp opens and finds data, tick_view.cpp shows a tick.
#pragma once

#include <rehearse/scenario.h>

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "contact_history.h"
#include "core/kinds/channel_name.h"
#include "message_finder.h"
#include "recorded_ticks.h"
#include "replayed_outputs.h"
#include "tick_view.h"

namespace rehearse {

class SteppedTrace::Impl {
 public:
  Impl(std::unique_ptr<MessageFinder> finder, Scenario scenario);

  Result<void> find_ticks();
  Result<void> replay(const SteppingOptions& options);

  std::uint64_t ns(std::int64_t tick) const { return nanoseconds_of(tick, scenario_.time_step); }
  std::int64_t tick_of(std::uint64_t ns) const {
    return std::llround(static_cast<double>(ns) * 1e-9 / scenario_.time_step);
  }
  static bool is_command(std::string_view topic) { return ChannelName::parse(topic).side == ChannelSide::output; }
  ViewChannel channel_at(std::size_t channel, std::int64_t tick, const RecordedTicks::Row& row);
  /// Sets the members of a channel that follow from its topic.
  static void classify(ViewChannel& shown);
  /// Cached for the last requested ticks.
  const std::vector<Divergence>& differences(std::int64_t tick);

  std::unique_ptr<MessageFinder> finder_;
  Scenario scenario_;
  RecordedTicks recorded_;
  std::optional<std::uint16_t> events_, contact_changes_;
  ContactHistory contacts_;
  std::unique_ptr<ReplayedOutputs> replayed_;
  std::int64_t first_tick_ = 0, last_tick_ = -1;
  Diagnostics remarks_;

  struct KnownDifferences {
    std::int64_t tick = -1;
    std::uint64_t used = 0;
    std::vector<Divergence> all;
  };
  std::array<KnownDifferences, 8> known_differences_;
  std::uint64_t uses_ = 0;
};

/// The id of a series: the place of its numbers.
inline std::size_t series_id(const SeriesPlace& place) { return (place.channel << 32) | place.column; }
inline SeriesPlace series_place(std::size_t id) { return {id >> 32, id & 0xffffffff}; }

}  // namespace rehearse
