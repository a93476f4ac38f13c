#include "compare_fields.h"

#include <fmt/format.h>
#include <rehearse/messages.h>
#include <rehearse/units.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

#include "core/kinds/channel_name.h"
#include "core/ros2msg/message_format.h"
#include "core/trace/message_rest.h"
#include "divergence_text.h"
#include "series_rules.h"

namespace rehearse {

struct FieldJudge::Decoders {
  ros2msg::Decoder golden, actual;
  ColumnFields columns;
};

namespace {

using Fields = std::vector<MessageField>;

std::optional<ros2msg::Decoder> decoder_of(const Trace& trace, const TraceChannel& channel) {
  const mcap::Schema* schema = trace.schema_of(channel);
  if (!ros2msg::is_decodable(channel.encoding, schema)) return std::nullopt;
  auto parsed = ros2msg::schema_of(channel.encoding, *schema);
  if (!parsed) return std::nullopt;
  return ros2msg::Decoder(std::move(*parsed));
}

/// The fields up to where the payload can't be decoded; then decoder.problem() has the reason.
Fields fields_of(ros2msg::Decoder& decoder, mcap::Bytes payload) {
  Fields fields;
  decoder.decode(payload, [&](const ros2msg::Value& value) { fields.push_back({std::string(value.path), value}); });
  return fields;
}

std::string quoted(std::string_view text) {
  constexpr std::size_t longest = 60;
  return fmt::format("\"{}{}\"", text.substr(0, longest), text.size() > longest ? "..." : "");
}

bool same_bytes(mcap::Bytes a, mcap::Bytes b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size()) == 0);
}

CellKind kind_of(const ros2msg::Value& value) {
  using Kind = ros2msg::Value::Kind;
  if (value.kind == Kind::signed_integer) return CellKind::signed_integer;
  return value.kind == Kind::boolean ? CellKind::boolean : CellKind::unsigned_integer;
}

std::uint64_t bits_of(const ros2msg::Value& value) {
  return kind_of(value) == CellKind::signed_integer ? static_cast<std::uint64_t>(value.integer)
                                                    : value.unsigned_integer;
}

std::optional<std::string> time_named_by(const MessageField& seconds, const MessageField& nanoseconds) {
  using Kind = ros2msg::Value::Kind;
  if (seconds.value.kind != Kind::signed_integer || nanoseconds.value.kind != Kind::unsigned_integer)
    return std::nullopt;
  return name_of_time(seconds.path, nanoseconds.path);
}

std::int64_t time_of_fields(const MessageField& seconds, const MessageField& nanoseconds) {
  return time_of_parts(seconds.value.integer, nanoseconds.value.unsigned_integer);
}

/// The layout of the bytes of a point cloud.
struct PointLayout {
  std::size_t step = 0, count = 0;                           // bytes a point; points
  std::vector<std::pair<std::string, std::size_t>> numbers;  // name and offset of each float32
};

/// The layout has no points if the cloud's numbers aren't in this machine's byte order.
PointLayout layout_of(const Fields& cloud, std::size_t bytes) {
  PointLayout layout;
  std::map<std::string, msg::PointField> parts;
  bool swapped = false;
  for (const auto& [path, value] : cloud) {
    const auto number = static_cast<std::uint32_t>(value.unsigned_integer);
    if (path == "point_step") layout.step = number;
    if (path == "is_bigendian") swapped = number != 0;
    if (!path.starts_with("fields/")) continue;
    msg::PointField& part = parts[path.substr(0, path.rfind('/'))];
    if (path.ends_with("/name")) part.name = value.text;
    if (path.ends_with("/offset")) part.offset = number;
    if (path.ends_with("/datatype")) part.datatype = static_cast<std::uint8_t>(number);
  }
  if (!swapped && layout.step > 0) layout.count = bytes / layout.step;
  for (const auto& [path, part] : parts)
    if (part.datatype == msg::PointField::float32 && part.offset + sizeof(float) <= layout.step)
      layout.numbers.emplace_back(part.name, part.offset);
  return layout;
}

float take_float(std::byte* place) {
  float number = 0.0F;
  std::memcpy(&number, place, sizeof number);
  std::memset(place, 0, sizeof number);
  return number;
}

}  // namespace

FieldJudge::FieldJudge(const ComparedTraces& traces, const PairedChannel& channel, ChannelFindings& findings)
    : traces_(traces), channel_(channel), findings_(findings), joins_times_(!traces.have_ticks()) {
  auto golden = decoder_of(traces.golden, channel.golden), actual = decoder_of(traces.actual, channel.actual);
  if (golden && actual)
    decoders_.reset(new Decoders{std::move(*golden), std::move(*actual), ColumnFields(channel.golden.type)});
}

FieldJudge::~FieldJudge() = default;

bool FieldJudge::compare(std::size_t golden_message, mcap::Bytes expected, mcap::Bytes actual,
                         std::string_view left_out) {
  message_ = golden_message;
  found_ = false;
  if (!decoders_) return false;
  Fields golden_fields = fields_of(decoders_->golden, expected), actual_fields = fields_of(decoders_->actual, actual);
  const std::string &golden_problem = decoders_->golden.problem(), &problem = decoders_->actual.problem();
  if (left_out.empty() && !(golden_problem.empty() && problem.empty())) {
    report(std::string(), problem.empty() ? "its bytes differ; the golden's can't be decoded: " + golden_problem
                                          : "its bytes differ; it can't be decoded: " + problem);
    return true;
  }
  std::map<std::string_view, const MessageField*> of_actual;
  const auto same_path = [](const MessageField& a, const MessageField& b) { return a.path == b.path; };
  const bool same_paths = std::ranges::equal(golden_fields, actual_fields, same_path);
  if (!same_paths)
    for (const MessageField& field : actual_fields) of_actual.emplace(field.path, &field);
  for (std::size_t i = 0; i < golden_fields.size(); ++i) {
    const MessageField& field = golden_fields[i];
    const auto other = of_actual.find(field.path);
    if (field.path == left_out) continue;
    if (!same_paths && other == of_actual.end()) {
      report_lone(field, "is missing");
      continue;
    }
    const auto next = i + 1 < golden_fields.size() ? of_actual.find(golden_fields[i + 1].path) : of_actual.end();
    const MessageField* seconds = same_paths ? &actual_fields[i] : other->second;
    const MessageField* nanoseconds = next != of_actual.end()                      ? next->second
                                      : same_paths && i + 1 < golden_fields.size() ? &actual_fields[i + 1]
                                                                                   : nullptr;
    if (const auto name = nanoseconds && joins_times_ ? time_named_by(field, golden_fields[i + 1]) : std::nullopt;
        name && time_named_by(*seconds, *nanoseconds)) {
      compare_times(*name, time_of_fields(field, golden_fields[i + 1]), time_of_fields(*seconds, *nanoseconds));
      ++i;
      if (!same_paths) of_actual.erase(next);
    } else {
      compare_field(golden_fields, field, *seconds);
    }
    if (!same_paths) of_actual.erase(other);
  }
  for (const MessageField& field : actual_fields)
    if (field.path != left_out && of_actual.contains(field.path)) report_lone(field, "is not in the golden");
  return found_;
}

void FieldJudge::compare_times(const std::string& path, std::int64_t expected, std::int64_t actual) {
  if (expected == actual) return;
  Divergence divergence = place(path);
  put_times(divergence, expected, actual);
  divergence.tolerance = tolerance_of(series_name(channel_.golden.topic, path), "s", traces_.rules).bound(0.0);
  const bool beyond = divergence.difference > divergence.tolerance;
  report(std::move(divergence), beyond);
}

void FieldJudge::compare_field(const Fields& all, const MessageField& golden, const MessageField& actual) {
  using Kind = ros2msg::Value::Kind;
  const ros2msg::Value &expected = golden.value, &other = actual.value;
  if (expected.kind != other.kind) return report(golden.path, "is a value of a different kind than in the golden");
  if (expected.kind == Kind::blob) return compare_bytes(all, golden, actual);
  if (expected.kind == Kind::floating)
    return compare_numbers(golden.path, expected.number, other.number, unit_of(channel_.golden.metadata, golden.path));
  if (expected.kind == Kind::text) {
    if (expected.text != other.text && !has_column(golden))
      report(golden.path, fmt::format("is {}, expected {}", quoted(other.text), quoted(expected.text)));
    return;
  }
  if (bits_of(expected) == bits_of(other)) return;
  Divergence divergence = place(golden.path);
  put_cells(divergence, kind_of(expected), bits_of(expected), bits_of(other));
  report(std::move(divergence), true);
}

void FieldJudge::compare_bytes(const Fields& all, const MessageField& golden, const MessageField& actual) {
  if (same_bytes(golden.value.blob, actual.value.blob)) return;
  std::vector<std::byte> expected(golden.value.blob.begin(), golden.value.blob.end());
  std::vector<std::byte> other(actual.value.blob.begin(), actual.value.blob.end());
  if (channel_.golden.type == msg::PointCloud2::type_name && golden.path == "data" && expected.size() == other.size())
    compare_points(all, expected, other);
  if (same_bytes(expected, other)) return;
  if (expected.size() != other.size())
    return report(golden.path, fmt::format("has {} bytes, expected {}", other.size(), expected.size()));
  const auto first = std::mismatch(expected.begin(), expected.end(), other.begin()).first;
  report(golden.path, fmt::format("differs from the golden's bytes from byte {} on", first - expected.begin()));
}

/// Compares the numbers in the points' bytes, and sets them to 0 there. Distances have columns and are judged there.
void FieldJudge::compare_points(const Fields& all, std::vector<std::byte>& golden, std::vector<std::byte>& actual) {
  const PointLayout layout = layout_of(all, golden.size());
  for (std::size_t point = 0; point < layout.count; ++point) {
    for (const auto& [name, offset] : layout.numbers) {
      const std::size_t at = point * layout.step + offset;
      const float expected = take_float(&golden[at]), other = take_float(&actual[at]);
      if (name != "range")
        compare_numbers(fmt::format("points/{}/{}", point, name), expected, other, UnitName("float32 distance"));
    }
  }
}

void FieldJudge::compare_numbers(const std::string& path, double expected, double actual, std::string_view unit) {
  if (identical(expected, actual)) return;
  const Tolerance tolerance = tolerance_of(series_name(channel_.golden.topic, path), unit, traces_.rules);
  Divergence divergence = place(path);
  put_numbers(divergence, expected, actual, shown_unit(unit));
  divergence.tolerance = tolerance.bound(std::isfinite(expected) ? std::abs(expected) : 0.0);
  const bool beyond = !(divergence.difference <= divergence.tolerance);
  report(std::move(divergence), beyond);
}

/// Reports a field that only one of the messages has. Fields of contacts with a column are left out: the number of
/// contacts is a column. Those of a controller's inputs are left out, too: it may read other inputs (OtherInputs).
void FieldJudge::report_lone(const MessageField& field, std::string note) {
  const bool may_lack = channel_.golden.type == msg::Contacts::type_name ||
                        ChannelName::parse(channel_.golden.topic).side == ChannelSide::input;
  if (may_lack && has_column(field)) return;
  report(field.path, std::move(note));
}

bool FieldJudge::has_column(const MessageField& field) const {
  ros2msg::Value value = field.value;
  value.path = field.path;  // the value's own path was a view of the decoder's text
  return decoders_->columns.covers(value);
}

Divergence FieldJudge::place(const std::string& path) const {
  Divergence divergence = place_of(traces_, window_->golden, window_->golden.times[message_]);
  divergence.element = path;
  return divergence;
}

void FieldJudge::report(const std::string& path, std::string note) {
  Divergence divergence = place(path);
  divergence.difference = std::numeric_limits<double>::infinity();
  divergence.note = std::move(note);
  report(std::move(divergence), true);
}

void FieldJudge::report(Divergence divergence, bool beyond) {
  found_ = true;
  divergence.stage = stage_of(divergence.channel, divergence.element);
  if (!traces_.options.takes(divergence.stage)) return;
  if (!channel_.golden.columns.empty()) ++findings_.result().values;  // else the message counts as one value
  if (traces_.options.on_difference)
    traces_.options.on_difference({window_->golden, window_->place(), message_, {}, beyond, 0});
  if (findings_.count(divergence.difference, divergence.tolerance, beyond)) findings_.describe(divergence, beyond);
}

void FieldJudge::report_encoding(std::size_t golden_message) {
  message_ = golden_message;
  Divergence divergence = place({});
  divergence.note = "the message's bytes differ from the golden's, although all its values are equal";
  report(std::move(divergence), false);
}

void FieldJudge::report_bytes(std::size_t golden_message) {
  message_ = golden_message;
  report(std::string(), "the message's bytes differ from the golden's");
}

std::uint64_t distance_of_integers(CellKind kind, std::uint64_t a, std::uint64_t b) {
  const bool is_signed = kind == CellKind::signed_integer;
  const bool grows = is_signed ? static_cast<std::int64_t>(a) < static_cast<std::int64_t>(b) : a < b;
  return grows ? b - a : a - b;
}

void put_cells(Divergence& divergence, CellKind kind, std::uint64_t expected, std::uint64_t actual) {
  if (kind == CellKind::floating)
    return put_numbers(divergence, std::bit_cast<double>(expected), std::bit_cast<double>(actual));
  constexpr double exact = 0x1p53;
  const bool is_signed = kind == CellKind::signed_integer;
  const auto number = [&](std::uint64_t bits) {
    return is_signed ? static_cast<double>(static_cast<std::int64_t>(bits)) : static_cast<double>(bits);
  };
  const auto text = [&](std::uint64_t bits) {
    return is_signed ? fmt::format("{}", static_cast<std::int64_t>(bits)) : fmt::format("{}", bits);
  };
  const std::uint64_t apart = distance_of_integers(kind, expected, actual);
  divergence.expected = number(expected);
  divergence.actual = number(actual);
  divergence.difference = static_cast<double>(apart);
  divergence.ulps = ulps_between(divergence.expected, divergence.actual);
  if (std::max(std::abs(divergence.expected), std::abs(divergence.actual)) >= exact)
    divergence.note = fmt::format("is {}, expected {}: off by {}", text(actual), text(expected), apart);
}

namespace {

/// True if the numbers of two messages have the same bits, in any order of columns. Then other data of the messages
/// must differ.
bool same_row(const MatchedChannel& channel, std::size_t golden, std::size_t actual) {
  const TraceChannel &a = channel.golden, &b = channel.actual;
  if (a.columns.size() != b.columns.size()) return false;
  for (std::size_t i = 0; i < a.columns.size(); ++i) {
    const bool same_place = b.columns[i].element == a.columns[i].element;
    const std::size_t other = same_place ? i : column_of(b, a.columns[i].element);
    if (other == b.columns.size() || a.bits(golden, i) != b.bits(actual, other)) return false;
  }
  return true;
}

}  // namespace

namespace {

class RestJudge final : public PartJudge {
 public:
  RestJudge(const ComparedTraces& traces, const PairedChannel& channel, ChannelFindings& findings)
      : fields_(traces, channel, findings) {}

  void take(const MatchedChannel& channel) override {
    fields_.begin(channel);
    for (const auto& [golden, actual] : channel.pairs) {
      if (channel.golden.hashes[golden] == channel.actual.hashes[actual]) continue;
      const TraceRest* expected = channel.golden.rest_of(golden);
      const TraceRest* other = channel.actual.rest_of(actual);
      bool found = !same_row(channel, golden, actual);
      if (expected && other && expected->hash != other->hash) {
        const auto golden_rest = channel.window.golden.rest(channel.golden, golden);
        const auto actual_rest = channel.window.actual.rest(channel.actual, actual);
        if (golden_rest && actual_rest && fields_.compare(golden, *golden_rest, *actual_rest)) found = true;
      }
      if (!found) fields_.report_encoding(golden);
    }
  }

 private:
  FieldJudge fields_;
};

}  // namespace

std::unique_ptr<PartJudge> judge_rests(const ComparedTraces& traces, const PairedChannel& channel,
                                       ChannelFindings& findings) {
  return std::make_unique<RestJudge>(traces, channel, findings);
}

}  // namespace rehearse
