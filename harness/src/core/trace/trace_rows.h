// Converts messages to rows of numbers. Internal.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/trace.h>

#include <bit>

namespace rehearse {

/// Appends rows to a channel's table. Columns are found by name, and added for new names.
class RowWriter {
 public:
  /// The channel may have columns already.
  explicit RowWriter(TraceChannel& channel);

  void begin_row();
  void put(std::string_view element, CellKind kind, std::uint64_t bits);
  void put(std::string_view element, double value) {
    put(element, CellKind::floating, std::bit_cast<std::uint64_t>(value));
  }
  /// Writes the last columns of the row, `name`/0, `name`/1, ...; rows may have different numbers of them.
  void put_array(std::string_view name, std::span<const float> values);
  /// The next cells of the row. The columns must be equal to the columns of the row before.
  std::span<std::uint64_t> next_cells(std::size_t count);

 private:
  std::size_t add_column(std::string_view element, CellKind kind);
  void widen(std::size_t added, CellKind kind);

  TraceChannel& channel_;
  std::map<std::string, std::size_t, std::less<>> by_name_;
  std::vector<std::uint64_t> empty_row_;
  std::size_t cursor_ = 0;  // the column after the last written column: nearly always the next column to write
  std::size_t array_begin_ = 0, array_size_ = 0;  // the columns of put_array
};

/// Reads the messages of one channel into its table.
class RowReader {
 public:
  virtual ~RowReader() = default;
  /// Appends one row; false if the payload doesn't fit the schema.
  virtual bool read(std::span<const std::byte> payload) = 0;
};

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
  /// the table is unchanged.
  bool add(std::uint64_t time, std::span<const std::byte> payload);
  /// Replaces all rows by the row of this message.
  bool replace(std::uint64_t time, std::span<const std::byte> payload);

  bool has_rows() const { return reader_ != nullptr; }
  /// True if TRACE_FORMAT.md has a specific table for its type.
  bool is_typed() const { return typed_; }
  /// The errors of its schema, if it therefore has no rows.
  const Diagnostics& problems() const { return problems_; }

  TraceChannel table;

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
