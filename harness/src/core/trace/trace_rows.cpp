#include "trace_rows.h"

#include "core/kinds/channel_name.h"
#include "core/ros2msg/message_format.h"
#include "core/ros2msg/ros2msg.h"

namespace rehearse {

namespace {

/// Reads messages of any type, by its schema.
class SchemaRowReader : public RowReader {
 public:
  SchemaRowReader(TraceChannel& channel, ros2msg::Schema schema)
      : channel_(channel), row_(channel), decoder_(std::move(schema)) {}

  bool read(std::span<const std::byte> payload) override {
    const std::size_t columns = channel_.columns.size();
    row_.begin_row();
    if (decoder_.decode(payload, [this](const ros2msg::Value& value) { put(value); })) return true;
    row_.drop_columns(columns);
    return false;
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

  TraceChannel& channel_;
  RowWriter row_;
  ros2msg::Decoder decoder_;
};

}  // namespace

bool has_no_series(std::string_view type) {
  const ChannelForm* form = form_of_type(type);
  return form && !form->has_series;
}

std::unique_ptr<RowReader> make_typed_row_reader(TraceChannel& channel) {
  const ChannelName name = ChannelName::parse(channel.topic);
  const bool is_of_kind = name.kind != ChannelKind::other && form_of(name.kind).type == channel.type;
  const ChannelForm* form = is_of_kind ? &form_of(name.kind) : form_of_type(channel.type);
  if (!form || !form->make_rows || (form->has_rows_by_topic && !is_of_kind)) return nullptr;
  return form->make_rows(channel, name.owner);
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
  if (!ros2msg::is_decodable(table.encoding, schema) || has_no_series(schema->name)) return;
  if (table.encoding == "cdr") reader_ = make_typed_row_reader(table);
  typed_ = reader_ != nullptr;
  if (typed_) return;
  auto parsed = ros2msg::schema_of(table.encoding, *schema, "schema " + schema->name);
  if (!parsed)
    problems_ = parsed.errors();
  else
    reader_ = std::make_unique<SchemaRowReader>(table, std::move(*parsed));
}

bool ChannelRows::add(std::uint64_t time, std::span<const std::byte> payload) {
  table.times.push_back(time);  // before the row: the table gets as many rows as there are times
  if (reader_ == nullptr || reader_->read(payload)) return true;
  table.cells.resize((table.times.size() - 1) * table.columns.size());
  if (keeps_undecoded)
    for (const TraceColumn& column : table.columns) table.cells.push_back(cell_without_value(column.kind));
  else
    table.times.pop_back();
  return false;
}

bool ChannelRows::replace(std::uint64_t time, std::span<const std::byte> payload) {
  table.times.clear();
  table.cells.clear();
  return add(time, payload);
}

}  // namespace rehearse
