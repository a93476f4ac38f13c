// EventStream: the events of a trace, one by one. Internal.
#pragma once

#include <rehearse/messages.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <memory>

namespace rehearse {

/// The events of a trace in the order of time. A trace that left them in its file keeps none of them in memory: the
/// stream reads them from there, and passes over damaged ones.
class EventStream {
 public:
  /// The trace must outlive this, and its file must not change.
  explicit EventStream(const Trace& trace);
  /// The next event, valid until the next call; null after the last.
  const msg::Event* next();

 private:
  const std::vector<msg::Event>* held_;  // null: the events are in the file
  std::size_t index_ = 0;                // of the next held event
  std::unique_ptr<mcap::OrderedMessages> messages_;
  msg::Event event_;
};

}  // namespace rehearse
