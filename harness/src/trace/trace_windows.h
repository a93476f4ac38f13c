// TraceWindows: a recording as one window of time after the other, each a trace; and how a channel's messages are read
// into its table. Internal.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "message_rest.h"
#include "trace_rows.h"

namespace rehearse {

/// A channel while it is read.
struct ChannelSource {
  ChannelSource(const mcap::Channel& channel, const mcap::Schema* schema, std::vector<TraceColumn> columns = {});
  /// Adds a message to the table. False: it isn't what the schema says.
  bool add(const mcap::Message& message);

  ChannelRows rows;
  std::unique_ptr<MessageRest> rest;  // null if there are no rows
};

/// Lets go of a table's first messages.
void drop_messages(TraceChannel& table, std::size_t count);

class TraceWindows {
 public:
  /// `whole`: as Trace::load_in_pieces() returned it; every table has its columns from the beginning. Messages of
  /// these channels, by their place in the trace, are read; at least one.
  TraceWindows(const Trace& whole, std::span<const std::size_t> channels);

  /// Lets go of the messages before `keep_from` and takes in those up to `until`, inclusive [ns].
  void move(std::uint64_t keep_from, std::uint64_t until);
  /// Without events and changes of contact.
  const Trace& window() const { return trace_; }
  /// When the first message behind the window is [ns]; none: there is none.
  std::optional<std::uint64_t> next_time() const;
  /// What is damaged in the messages that were read.
  Result<void> verdict();

 private:
  Trace trace_;
  std::deque<ChannelSource> sources_;  // like the trace's channels
  std::vector<ChannelSource*> by_id_ = std::vector<ChannelSource*>(0x10000, nullptr);
  std::unique_ptr<mcap::OrderedMessages> messages_;
  const mcap::Message* message_ = nullptr;  // the next
};

/// Whether a trace is as Trace::load_in_pieces() returns it.
bool is_without_messages(const Trace& trace);

/// Calls `take` with the messages of some channels, by their place in the trace, in the order of time: with windows
/// that are read from its file, or once with the trace itself if it holds its messages.
void for_each_window(const Trace& trace, const std::vector<std::size_t>& channels,
                     const std::function<void(const Trace& window)>& take);

}  // namespace rehearse
