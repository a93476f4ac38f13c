#include "channel_table.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "core/kinds/channel_name.h"
#include "core/ros2msg/message_format.h"
#include "core/ros2msg/ros2msg.h"
#include "core/trace/message_json.h"

namespace rehearse {
namespace {

constexpr std::size_t max_columns = 65'536;  // limit of a table

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

/// The path with * for each number of an element: points/*/tag for points/12/tag.
std::string pattern_of(std::string_view path) {
  std::string pattern;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    const std::string_view name = path.substr(begin, end - begin);
    const bool is_number = !name.empty() && name.find_first_not_of("0123456789") == std::string_view::npos;
    if (begin > 0) pattern += '/';
    pattern += is_number ? "*" : name;
    begin = end + 1;
  }
  return pattern;
}

/// A table by schema: a column for each field, except bytes and values with a series.
class FieldTable final : public ChannelTable {
 public:
  FieldTable(ros2msg::Schema schema, TraceChannel channel, std::optional<ColumnFields> columns, bool bytes)
      : decoder_(std::move(schema)), channel_(std::move(channel)), columns_(std::move(columns)), bytes_(bytes) {}

  bool read(mcap::Bytes payload) override {
    for (std::string& cell : cells_) cell.clear();
    bool too_many = false;
    const bool fits = decoder_.decode(payload, [&](const ros2msg::Value& value) {
      if (columns_ && columns_->covers(value)) return;
      if (value.kind == ros2msg::Value::Kind::blob && !bytes_) {
        left_out_.insert(pattern_of(value.path));
        return;
      }
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
      columns.push_back({column.element, unit_of(channel_.metadata, column.element)});
    return columns;
  }

  std::set<std::string> left_out() const override { return left_out_; }

 private:
  static void set(std::string& cell, const ros2msg::Value& value) {
    using Kind = ros2msg::Value::Kind;
    switch (value.kind) {
      case Kind::floating: return append_number(cell, value.number);
      case Kind::signed_integer: return append_number(cell, value.integer);
      case Kind::unsigned_integer:
      case Kind::boolean: return append_number(cell, value.unsigned_integer);
      case Kind::text: return append_cell(cell, value.text);
      case Kind::blob: return append_base64(cell, value.blob);
    }
  }

  ros2msg::Decoder decoder_;
  TraceChannel channel_;
  std::optional<ColumnFields> columns_;
  const bool bytes_;
  std::map<std::string, std::size_t, std::less<>> by_name_;
  std::vector<std::string> cells_;  // as written in the file
  std::set<std::string> left_out_;
};

/// The table of a type whose numbers have series: first the series, then all other fields.
class WholeTable final : public ChannelTable {
 public:
  WholeTable(std::unique_ptr<ChannelTable> series, std::unique_ptr<ChannelTable> fields)
      : series_(std::move(series)), fields_(std::move(fields)) {}

  bool read(mcap::Bytes payload) override { return series_->read(payload) && fields_->read(payload); }
  void append_row(std::string& line) const override {
    series_->append_row(line);
    fields_->append_row(line);
  }
  std::vector<Column> columns() const override {
    std::vector<Column> columns = series_->columns();
    const std::vector<Column> others = fields_->columns();
    columns.insert(columns.end(), others.begin(), others.end());
    return columns;
  }
  std::set<std::string> left_out() const override { return fields_->left_out(); }

 private:
  std::unique_ptr<ChannelTable> series_, fields_;
};

}  // namespace

Result<std::unique_ptr<ChannelTable>> ChannelTable::make(const mcap::Channel& channel, const mcap::Schema* schema,
                                                         bool bytes) {
  if (!ros2msg::is_decodable(channel.message_encoding, schema)) {
    return error(fmt::format("messages of encoding '{}'{} can't be decoded", channel.message_encoding,
                             schema == nullptr ? " without a schema" : ""));
  }
  auto series = REHEARSE_TRY(SeriesTable::make(channel, schema, false));
  auto parsed = ros2msg::schema_of(channel.message_encoding, *schema, "schema " + schema->name);
  if (!parsed && series != nullptr) return std::unique_ptr<ChannelTable>(std::move(series));
  if (!parsed) return parsed.errors();
  const auto columns = series == nullptr ? std::nullopt : std::optional<ColumnFields>(schema->name);
  std::unique_ptr<ChannelTable> fields =
      std::make_unique<FieldTable>(std::move(*parsed), describe_channel(channel, schema), columns, bytes);
  if (series == nullptr) return fields;
  return std::unique_ptr<ChannelTable>(std::make_unique<WholeTable>(std::move(series), std::move(fields)));
}

Result<std::unique_ptr<SeriesTable>> SeriesTable::make(const mcap::Channel& channel, const mcap::Schema* schema,
                                                       bool any_schema) {
  std::unique_ptr<SeriesTable> table(new SeriesTable(channel, schema));
  if (any_schema && !table->rows_.problems().empty()) return table->rows_.problems();
  if (!(any_schema ? table->rows_.has_rows() : table->rows_.is_typed())) return std::unique_ptr<SeriesTable>();
  if (schema != nullptr) {
    if (auto parsed = ros2msg::schema_of(channel.message_encoding, *schema))
      table->decoder_ = std::make_unique<ros2msg::Decoder>(std::move(*parsed));
    table->columns_ = std::make_unique<ColumnFields>(schema->name);
  }
  return table;
}

bool SeriesTable::read(mcap::Bytes payload) {
  if (decoder_ && !std::exchange(has_read_, true))
    decoder_->decode(payload, [&](const ros2msg::Value& value) {
      if (!columns_->covers(value)) left_out_.insert(pattern_of(value.path));
    });
  return rows_.replace(0, payload) && rows_.table.columns.size() <= max_columns;
}

void SeriesTable::append_row(std::string& line) const {
  for (std::size_t i = 0; i < rows_.table.columns.size(); ++i) {
    line += ',';
    append_bits(line, rows_.table.columns[i].kind, rows_.table.cells[i]);
  }
}

std::vector<ChannelTable::Column> SeriesTable::columns() const {
  std::vector<Column> columns;
  for (const TraceColumn& column : rows_.table.columns)
    columns.push_back(
        {column.series.empty() ? column.element : column.series, unit_of(rows_.table.metadata, column.element)});
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
