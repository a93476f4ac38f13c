#include "rows.h"

#include <algorithm>
#include <iterator>
#include <limits>

namespace rehearse {

std::uint64_t cell_without_value(CellKind kind) {
  return kind == CellKind::floating ? std::bit_cast<std::uint64_t>(std::numeric_limits<double>::quiet_NaN()) : 0;
}

RowWriter::RowWriter(TraceChannel& channel) : channel_(channel) {
  for (std::size_t i = 0; i < channel.columns.size(); ++i) {
    by_name_.emplace(channel.columns[i].element, i);
    empty_row_.push_back(cell_without_value(channel.columns[i].kind));
  }
}

void RowWriter::begin_row() {
  channel_.cells.insert(channel_.cells.end(), empty_row_.begin(), empty_row_.end());
  cursor_ = 0;
}

void RowWriter::put(std::string_view element, CellKind kind, std::uint64_t bits) {
  std::size_t column = cursor_;
  if (column >= channel_.columns.size() || channel_.columns[column].element != element) {
    const auto found = by_name_.find(element);
    column = found == by_name_.end() ? add_column(element, kind) : found->second;
  }
  channel_.cells[channel_.cells.size() - channel_.columns.size() + column] = bits;
  cursor_ = column + 1;
}

std::span<std::uint64_t> RowWriter::next_cells(std::size_t count) {
  REHEARSE_ASSERT(cursor_ + count <= channel_.columns.size(), "the columns are those of the row before");
  std::uint64_t* row = channel_.cells.data() + channel_.cells.size() - channel_.columns.size();
  const std::span<std::uint64_t> cells(row + cursor_, count);
  cursor_ += count;
  return cells;
}

void RowWriter::put_array(std::string_view name, std::span<const float> values) {
  if (array_size_ == 0) {
    const auto known = by_name_.find(std::string(name) + "/0");
    array_begin_ = known == by_name_.end() ? channel_.columns.size() : known->second;
    array_size_ = channel_.columns.size() - array_begin_;
  }
  REHEARSE_ASSERT(array_begin_ + array_size_ == channel_.columns.size(),
                  "an array's columns are a channel's last ones");
  if (values.size() > array_size_) {
    widen(values.size() - array_size_, CellKind::floating);
    for (; array_size_ < values.size(); ++array_size_)
      channel_.columns.push_back({std::string(name) + "/" + std::to_string(array_size_), {}, CellKind::floating});
  }
  std::uint64_t* cells = channel_.cells.data() + channel_.cells.size() - channel_.columns.size() + array_begin_;
  for (const float value : values) *cells++ = std::bit_cast<std::uint64_t>(static_cast<double>(value));
}

std::size_t RowWriter::add_column(std::string_view element, CellKind kind) {
  const std::size_t column = channel_.columns.size();
  widen(1, kind);
  channel_.columns.push_back({std::string(element), {}, kind});
  by_name_.emplace(element, column);
  return column;
}

void RowWriter::drop_columns(std::size_t kept) {
  const std::size_t width = channel_.columns.size();
  if (width == kept) return;
  const auto rows = static_cast<std::ptrdiff_t>(channel_.cells.size() / width);
  const auto begin = channel_.cells.begin();
  for (std::ptrdiff_t row = 1; row < rows; ++row)
    std::copy_n(begin + row * static_cast<std::ptrdiff_t>(width), kept,
                begin + row * static_cast<std::ptrdiff_t>(kept));
  channel_.cells.resize(static_cast<std::size_t>(rows) * kept);
  for (std::size_t column = kept; column < width; ++column) by_name_.erase(channel_.columns[column].element);
  channel_.columns.resize(kept);
  empty_row_.resize(kept);
}

/// Adds columns to all rows so far, the present one included.
void RowWriter::widen(std::size_t added, CellKind kind) {
  const std::size_t columns = channel_.columns.size();
  // A row without columns has no cells: then the messages before this message are the rows so far.
  const std::size_t rows = columns == 0 ? channel_.times.size() : channel_.cells.size() / columns;
  empty_row_.insert(empty_row_.end(), added, cell_without_value(kind));
  std::vector<std::uint64_t> wider;
  wider.reserve(rows * (columns + added));
  for (std::size_t row = 0; row < rows; ++row) {
    const auto begin = channel_.cells.begin() + static_cast<std::ptrdiff_t>(row * columns);
    wider.insert(wider.end(), begin, begin + static_cast<std::ptrdiff_t>(columns));
    wider.insert(wider.end(), added, cell_without_value(kind));
  }
  channel_.cells = std::move(wider);
}

const std::string* TraceChannel::problem_of(std::size_t message) const {
  const auto found = std::ranges::lower_bound(undecoded, message, {}, &UndecodedMessage::index);
  return found == undecoded.end() || found->index != message ? nullptr : &found->reason;
}

double TraceChannel::number(std::size_t row_index, std::size_t column) const {
  const std::uint64_t cell = bits(row_index, column);
  switch (columns[column].kind) {
    case CellKind::floating: return std::bit_cast<double>(cell);
    case CellKind::signed_integer: return static_cast<double>(static_cast<std::int64_t>(cell));
    case CellKind::unsigned_integer:
    case CellKind::boolean: return static_cast<double>(cell);
  }
  REHEARSE_ASSERT(false, "the value is no CellKind");
}

const TraceRest* TraceChannel::rest_of(std::size_t message) const {
  const auto after = std::upper_bound(rests.begin(), rests.end(), message,
                                      [](std::size_t index, const TraceRest& rest) { return index < rest.first; });
  return after == rests.begin() ? nullptr : &*std::prev(after);
}

}  // namespace rehearse
