// TraceWindows: reads a recording as a sequence of windows of time, each of which is a trace. Also reads the messages
// of a channel into its table. Internal.
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
#include "state_rate.h"
#include "trace_rows.h"

namespace rehearse {

/// The reader of a channel.
struct ChannelSource {
  ChannelSource(const mcap::Channel& channel, const mcap::Schema* schema, std::vector<TraceColumn> columns = {});
  /// From now on adds only samples, if this channel has samples.
  void take_samples(const StateRate* rate);
  /// Adds a message to the table. False: it doesn't fit the schema.
  bool add(const mcap::Message& message);
  /// Keeps messages that can't be decoded, from now on.
  void keep_undecoded(const mcap::Schema* schema);

  ChannelRows rows;
  const StateRate* samples = nullptr;    // null: all messages are added
  std::unique_ptr<MessageRest> rest;     // null if there are no rows
  const mcap::Schema* schema = nullptr;  // of the messages that are kept although they can't be decoded; null: none are
};

/// Removes a table's first messages.
void drop_messages(TraceChannel& table, std::size_t count);

/// Adds some messages of a channel, given by their indices, to another table of the channel.
void append_messages(TraceChannel& to, const TraceChannel& from, const std::vector<std::size_t>& messages);

/// The first messages to be read in windows.
struct WindowsStart {
  std::uint64_t time = 0;                   // [ns]
  std::vector<std::uint64_t> earlier = {};  // messages before that time, for each of the channels; empty: none
};

class TraceWindows {
 public:
  /// `whole`: the result of Trace::load_in_pieces() or load_samples(), whose tables have all columns from the
  /// beginning, or of load_sizes(), whose tables get columns with their first messages. The messages of `channels`,
  /// given by their indices in the trace, are read; at least one channel.
  TraceWindows(const Trace& whole, std::span<const std::size_t> channels, const WindowsStart& start = {});

  /// Removes the messages before `keep_from` and reads the messages up to `until`, inclusive [ns].
  void move(std::uint64_t keep_from, std::uint64_t until);
  /// The trace of the present window, without events and changes of contact.
  const Trace& window() const { return trace_; }
  /// The time of the first message after the window [ns]; nullopt: no message follows.
  std::optional<std::uint64_t> next_time() const;
  /// Fails with the damage of the messages that were read.
  Result<void> verdict();

 private:
  Trace trace_;
  std::deque<ChannelSource> sources_;  // parallel to the trace's channels
  std::vector<ChannelSource*> by_id_;  // up to the largest id of a channel
  std::unique_ptr<mcap::OrderedMessages> messages_;
  const mcap::Message* message_ = nullptr;  // the next message
};

/// As Trace::load(); of the state of the world only the samples at a rate are read.
Result<Trace> load_samples(const std::filesystem::path& file, const StateRate& rate);

/// As Trace::load_in_pieces(), for a comparison. `rate`: of the state of the world only these samples are read; null:
/// all. In a file without ticks messages that can't be decoded are no damage: they are TraceChannel::undecoded, also in
/// the windows of the trace.
Result<Trace> load_for_comparison(const std::filesystem::path& file, const StateRate* rate,
                                  const Trace::OnPiece& on_piece, std::size_t piece_size,
                                  Trace::Damage damage = Trace::Damage::refuse);

enum class PieceOrder {
  of_file,
  of_time,  // no message of a piece is later than one of the next piece, also if chunks overlap in time
};

/// As Trace::load_in_pieces(); only messages of the wanted channels are read (null: of all), and the other tables have
/// no columns.
Result<Trace> load_pieces(const std::filesystem::path& file, const std::function<bool(const mcap::Channel&)>& wanted,
                          const Trace::OnPiece& on_piece, std::size_t piece_size, PieceOrder order,
                          Trace::Damage damage = Trace::Damage::refuse);

/// As Trace::load_in_pieces(), but no message is read: the tables have no columns, and their sizes are those of the
/// file's statistics, which must be right (mcap::Reader::can_copy_chunks()).
Result<Trace> load_sizes(const std::filesystem::path& file);

/// The messages of `whole` at whose time `part` has messages of the same topic. Both contain their messages.
Trace overlap(const Trace& whole, const Trace& part);

/// True if a trace is a result of Trace::load_in_pieces(), without messages.
bool is_without_messages(const Trace& trace);

/// Calls `take` with the messages of some channels, given by their indices in the trace, in the order of time. It
/// passes windows that are read from the trace's file, or once the trace itself if it contains its messages. False from
/// `take` ends the pass.
void for_each_window(const Trace& trace, const std::vector<std::size_t>& channels,
                     const std::function<bool(const Trace& window)>& take);

}  // namespace rehearse
