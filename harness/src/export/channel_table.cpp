#include "export/channel_table.h"

#include <fmt/format.h>
#include <rehearse/message_json.h>
#include <rehearse/ros2msg.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <iterator>

#include "compare/compare_parts.h"
#include "export/picture_file.h"

namespace rehearse {
namespace {

constexpr std::size_t max_columns = 65'536;  // of a table

template <class Number>
void append_number(std::string& line, Number number) {
  std::array<char, 32> digits;
  line.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr);
}

void append_number(std::string& line, double number) {
  if (std::isnan(number)) {
    line += "NaN";
  } else if (std::isinf(number)) {
    line += number > 0.0 ? "Infinity" : "-Infinity";
  } else {
    append_number<double>(line, number);
  }
}

void append_bits(std::string& line, CellKind kind, std::uint64_t bits) {
  switch (kind) {
    case CellKind::floating: return append_number(line, std::bit_cast<double>(bits));
    case CellKind::signed_integer: return append_number(line, static_cast<std::int64_t>(bits));
    case CellKind::unsigned_integer:
    case CellKind::boolean: return append_number(line, bits);
  }
}

/// Any other type, by its schema: a column for each field but bytes.
class FieldTable final : public ChannelTable {
 public:
  FieldTable(ros2msg::Schema schema, TraceChannel channel)
      : decoder_(std::move(schema)), channel_(std::move(channel)) {}

  bool read(mcap::Bytes payload) override {
    for (std::string& cell : cells_) cell.clear();
    bool too_many = false;
    const bool fits = decoder_.decode(payload, [&](const ros2msg::Value& value) {
      if (value.kind == ros2msg::Value::Kind::blob) return;
      const auto known = by_name_.find(value.path);
      if (known == by_name_.end() && cells_.size() == max_columns) {
        too_many = true;
        return;
      }
      std::size_t column = cells_.size();
      if (known == by_name_.end()) {
        by_name_.emplace(value.path, column);
        channel_.columns.push_back({std::string(value.path), {}, CellKind::floating});
        cells_.emplace_back();
      } else {
        column = known->second;
      }
      set(cells_[column], value);
    });
    return fits && !too_many;
  }

  void append_row(std::string& line) const override {
    for (const std::string& cell : cells_) {
      line += ',';
      line += cell;
    }
  }

  std::vector<Column> columns() const override {
    std::vector<Column> columns;
    for (const TraceColumn& column : channel_.columns)
      columns.push_back({column.element, unit_of(channel_, column.element)});
    return columns;
  }

 private:
  static void set(std::string& cell, const ros2msg::Value& value) {
    using Kind = ros2msg::Value::Kind;
    switch (value.kind) {
      case Kind::floating: return append_number(cell, value.number);
      case Kind::signed_integer: return append_number(cell, value.integer);
      case Kind::unsigned_integer:
      case Kind::boolean: return append_number(cell, value.unsigned_integer);
      case Kind::text: return append_cell(cell, value.text);
      case Kind::blob: return;
    }
  }

  ros2msg::Decoder decoder_;
  TraceChannel channel_;
  std::map<std::string, std::size_t, std::less<>> by_name_;
  std::vector<std::string> cells_;  // as they stand in the file
};

TraceChannel describe(const mcap::Channel& channel, const mcap::Schema* schema) {
  TraceChannel described;
  described.topic = channel.topic;
  described.type = schema == nullptr ? "" : schema->name;
  described.encoding = channel.message_encoding;
  described.metadata = channel.metadata;
  return described;
}

}  // namespace

Result<std::unique_ptr<ChannelTable>> ChannelTable::make(const mcap::Channel& channel, const mcap::Schema* schema) {
  if (channel.message_encoding != "cdr" || schema == nullptr || schema->encoding != "ros2msg") {
    return error(fmt::format("messages of encoding '{}'{} can't be decoded", channel.message_encoding,
                             schema == nullptr ? " without a schema" : ""));
  }
  if (is_picture_type(schema->name)) return error("pictures: see --frames");
  auto series = SeriesTable::make(channel, schema, false);
  if (!series) return series.errors();
  if (*series != nullptr) return std::unique_ptr<ChannelTable>(std::move(*series));
  auto parsed = ros2msg::Schema::parse(schema->name, schema->data, "schema " + schema->name);
  if (!parsed) return parsed.errors();
  return std::unique_ptr<ChannelTable>(std::make_unique<FieldTable>(std::move(*parsed), describe(channel, schema)));
}

Result<std::unique_ptr<SeriesTable>> SeriesTable::make(const mcap::Channel& channel, const mcap::Schema* schema,
                                                       bool any_schema) {
  std::unique_ptr<SeriesTable> table(new SeriesTable());
  table->channel_ = describe(channel, schema);
  if (any_schema) {
    auto rows = make_row_reader(table->channel_, schema);
    if (!rows) return rows.errors();
    table->rows_ = std::move(*rows);
  } else {
    table->rows_ = make_typed_row_reader(table->channel_);
  }
  if (table->rows_ == nullptr) table.reset();
  return table;
}

bool SeriesTable::read(mcap::Bytes payload) {
  channel_.cells.clear();
  channel_.times.assign(1, 0);  // the table has one row, whatever its columns
  return rows_->read(payload) && channel_.columns.size() <= max_columns;
}

void SeriesTable::append_row(std::string& line) const {
  for (std::size_t i = 0; i < channel_.columns.size(); ++i) {
    line += ',';
    append_bits(line, channel_.columns[i].kind, channel_.cells[i]);
  }
}

std::vector<ChannelTable::Column> SeriesTable::columns() const {
  std::vector<Column> columns;
  for (const TraceColumn& column : channel_.columns)
    columns.push_back({column.series.empty() ? column.element : column.series, unit_of(channel_, column.element)});
  return columns;
}

void append_cell(std::string& line, std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
    line += text;
    return;
  }
  line += '"';
  for (const char c : text) {
    if (c == '"') line += '"';
    line += c;
  }
  line += '"';
}

void append_seconds(std::string& line, std::uint64_t ns) {
  constexpr std::uint64_t second = 1'000'000'000;
  fmt::format_to(std::back_inserter(line), "{}.{:09}", ns / second, ns % second);
}

}  // namespace rehearse
