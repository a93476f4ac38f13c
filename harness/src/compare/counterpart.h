// The pairs of channels of two traces that are compared. Internal.
#pragma once

#include <rehearse/trace.h>

#include <algorithm>

namespace rehearse {

/// The channel of `other` with the topic of `channel`, which is one of `of`; null if there is none. Of several channels
/// with this topic, the first is paired with the first, the second with the second.
inline const TraceChannel* counterpart(const Trace& of, const TraceChannel& channel, const Trace& other) {
  const auto earlier = std::count_if(of.channels().data(), &channel,
                                     [&](const TraceChannel& before) { return before.topic == channel.topic; });
  auto skip = earlier;
  for (const TraceChannel& candidate : other.channels()) {
    if (candidate.topic == channel.topic && skip-- == 0) return &candidate;
  }
  return nullptr;
}

}  // namespace rehearse
