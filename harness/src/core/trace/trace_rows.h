// Converts messages to rows of numbers. Internal.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/trace.h>

#include "core/kinds/rows.h"

namespace rehearse {

/// A reader for the types with a specific table in TRACE_FORMAT.md; null for all others.
std::unique_ptr<RowReader> make_typed_row_reader(TraceChannel& channel);

/// A channel's table without messages.
TraceChannel describe_channel(const mcap::Channel& channel, const mcap::Schema* schema);

/// A channel's table and its reader: all rows one after the other, or the row of one message.
class ChannelRows {
 public:
  /// `schema` may be null. `columns`: the columns of the rows that an earlier pass found.
  ChannelRows(const mcap::Channel& channel, const mcap::Schema* schema, std::vector<TraceColumn> columns = {});
  ChannelRows(const ChannelRows&) = delete;
  ChannelRows& operator=(const ChannelRows&) = delete;

  /// Adds the time of a message, and its row if the channel has rows. False: the payload doesn't fit the schema, and
  /// the table is unchanged, or has a row without values if these are kept.
  bool add(std::uint64_t time, std::span<const std::byte> payload);
  /// Replaces all rows by the row of this message.
  bool replace(std::uint64_t time, std::span<const std::byte> payload);

  bool has_rows() const { return reader_ != nullptr; }
  /// True if TRACE_FORMAT.md has a specific table for its type.
  bool is_typed() const { return typed_; }
  /// The errors of its schema, if it therefore has no rows.
  const Diagnostics& problems() const { return problems_; }

  TraceChannel table;
  bool keeps_undecoded = false;

 private:
  std::unique_ptr<RowReader> reader_;
  bool typed_ = false;
  Diagnostics problems_;
};

/// Gives every column the name of its series (trace.h), and lists the series. All columns must be complete.
void name_series(std::span<TraceChannel* const> channels, std::map<std::string, SeriesPlace, std::less<>>& series);

/// Types without series: pictures, checkpoints, events, changes of contact.
bool has_no_series(std::string_view type);

}  // namespace rehearse
