#include "compared_traces.h"

#include <algorithm>

#include "core/kinds/channel_name.h"

namespace rehearse {

Divergence place_of(const ComparedTraces& traces, const TraceChannel& channel, std::uint64_t time) {
  const TickClock& clock =
      !traces.clock.has(time) && traces.actual_clock.has(time) ? traces.actual_clock : traces.clock;
  Divergence divergence;
  divergence.tick = clock.tick_at(time);
  if (!traces.have_ticks()) {  // no recording of Rehearse: the index of the message
    const auto message = std::ranges::lower_bound(channel.times, time);
    divergence.tick = static_cast<std::int64_t>(channel.earlier) + (message - channel.times.begin());
  }
  divergence.time = static_cast<double>(time) / 1e9;
  divergence.channel = channel.topic;
  divergence.stage = stage_of(channel.topic);
  return divergence;
}

}  // namespace rehearse
