#include "trace_rows.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/ros2msg/ros2msg.h"

namespace rehearse {

namespace {

std::uint64_t missing(CellKind kind) {
  return kind == CellKind::floating ? std::bit_cast<std::uint64_t>(std::numeric_limits<double>::quiet_NaN()) : 0;
}

/// Reads messages of any type, by its schema.
class SchemaRowReader : public RowReader {
 public:
  SchemaRowReader(TraceChannel& channel, ros2msg::Schema schema) : row_(channel), decoder_(std::move(schema)) {}

  bool read(std::span<const std::byte> payload) override {
    row_.begin_row();
    return decoder_.decode(payload, [this](const ros2msg::Value& value) { put(value); });
  }

 private:
  void put(const ros2msg::Value& value) {
    using Kind = ros2msg::Value::Kind;
    if (value.path.starts_with("header/") || value.path.starts_with("stamp/")) return;
    switch (value.kind) {
      case Kind::floating: row_.put(value.path, value.number); break;
      case Kind::signed_integer:
        row_.put(value.path, CellKind::signed_integer, static_cast<std::uint64_t>(value.integer));
        break;
      case Kind::unsigned_integer: row_.put(value.path, CellKind::unsigned_integer, value.unsigned_integer); break;
      case Kind::boolean: row_.put(value.path, CellKind::boolean, value.unsigned_integer); break;
      case Kind::text:
      case Kind::blob: break;  // a blob is no number
    }
  }

  RowWriter row_;
  ros2msg::Decoder decoder_;
};

}  // namespace

RowWriter::RowWriter(TraceChannel& channel) : channel_(channel) {
  for (std::size_t i = 0; i < channel.columns.size(); ++i) {
    by_name_.emplace(channel.columns[i].element, i);
    empty_row_.push_back(missing(channel.columns[i].kind));
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

/// Adds columns to all rows so far, the present one included.
void RowWriter::widen(std::size_t added, CellKind kind) {
  const std::size_t columns = channel_.columns.size();
  // A row without columns has no cells: then the messages before this message are the rows so far.
  const std::size_t rows = columns == 0 ? channel_.times.size() : channel_.cells.size() / columns;
  empty_row_.insert(empty_row_.end(), added, missing(kind));
  std::vector<std::uint64_t> wider;
  wider.reserve(rows * (columns + added));
  for (std::size_t row = 0; row < rows; ++row) {
    const auto begin = channel_.cells.begin() + static_cast<std::ptrdiff_t>(row * columns);
    wider.insert(wider.end(), begin, begin + static_cast<std::ptrdiff_t>(columns));
    wider.insert(wider.end(), added, missing(kind));
  }
  channel_.cells = std::move(wider);
}

bool has_no_series(std::string_view type) {
  constexpr std::array<std::string_view, 5> types{msg::Image::type_name, msg::CompressedImage::type_name,
                                                  msg::Checkpoint::type_name, msg::Event::type_name,
                                                  msg::ContactChange::type_name};
  return std::find(types.begin(), types.end(), type) != types.end();
}

TraceChannel describe_channel(const mcap::Channel& channel, const mcap::Schema* schema) {
  TraceChannel described;
  described.topic = channel.topic;
  described.type = schema == nullptr ? "" : schema->name;
  described.encoding = channel.message_encoding;
  described.metadata = channel.metadata;
  return described;
}

ChannelRows::ChannelRows(const mcap::Channel& channel, const mcap::Schema* schema, std::vector<TraceColumn> columns)
    : table(describe_channel(channel, schema)) {
  table.columns = std::move(columns);
  if (table.encoding != "cdr" || schema == nullptr || schema->encoding != "ros2msg") return;
  if (has_no_series(schema->name)) return;
  reader_ = make_typed_row_reader(table);
  typed_ = reader_ != nullptr;
  if (typed_) return;
  auto parsed = ros2msg::Schema::parse(schema->name, schema->data, "schema " + schema->name);
  if (!parsed)
    problems_ = parsed.errors();
  else
    reader_ = std::make_unique<SchemaRowReader>(table, std::move(*parsed));
}

bool ChannelRows::add(std::uint64_t time, std::span<const std::byte> payload) {
  table.times.push_back(time);  // before the row: the table gets as many rows as there are times
  if (reader_ == nullptr || reader_->read(payload)) return true;
  table.times.pop_back();
  table.cells.resize(table.times.size() * table.columns.size());
  return false;
}

bool ChannelRows::replace(std::uint64_t time, std::span<const std::byte> payload) {
  table.times.clear();
  table.cells.clear();
  return add(time, payload);
}

}  // namespace rehearse
