// Writes numbers of messages as rows of a channel's table.
#pragma once

#include <rehearse/cdr.h>
#include <rehearse/diagnostic.h>
#include <rehearse/trace_table.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rehearse {

/// The bits of a cell without a value.
std::uint64_t cell_without_value(CellKind kind);

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
  /// Removes all columns but the first ones, from all rows.
  void drop_columns(std::size_t kept);
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
  /// Appends one row; false if the payload doesn't fit the schema. Then no column is new, and the
  /// cells after the rows so far are of no use.
  virtual bool read(std::span<const std::byte> payload) = 0;
};

/// Reads the rows of a type of message. `put(message, row)` writes the cells of one row.
template <class Message, class Put>
class TypedRowReader : public RowReader {
 public:
  TypedRowReader(TraceChannel& channel, Put put) : row_(channel), put_(std::move(put)) {}

  bool read(std::span<const std::byte> payload) override {
    CdrReader reader(payload);
    row_.begin_row();
    if (!msg::decode(reader, message_)) return false;
    put_(message_, row_);
    return true;
  }

 private:
  RowWriter row_;
  Put put_;
  Message message_;
};

template <class Message, class Put>
std::unique_ptr<RowReader> rows_of(TraceChannel& channel, Put put) {
  return std::make_unique<TypedRowReader<Message, Put>>(channel, std::move(put));
}

}  // namespace rehearse
