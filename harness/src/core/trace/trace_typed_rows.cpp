#include "channel_name.h"
#include "joint_arrays.h"
#include "message_numbers.h"
#include "range_messages.h"
#include "trace_rows.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <iterator>
#include <sstream>

namespace rehearse {

namespace {

using Bytes = std::span<const std::byte>;

/// Reads the rows of JointState and JointAccelerations: arrays that belong to an array of names. While the layout stays
/// the same, the arrays are copied as a whole.
class NamedArraysReader : public RowReader {
 public:
  /// `suffixes` name the arrays that follow the names, in order: "/q", "/dq", "/u".
  NamedArraysReader(TraceChannel& channel, std::vector<std::string_view> suffixes)
      : channel_(channel), row_(channel), suffixes_(std::move(suffixes)), joints_(suffixes_.size()) {}

  bool read(Bytes payload) override {
    if (!joints_.read(payload)) return false;
    row_.begin_row();
    if (!joints_.layout_changed() && columns_are_arrays_ && channel_.columns.size() == column_count()) {
      copy_row();
    } else {
      put_row();
    }
    return true;
  }

 private:
  std::size_t column_count() const {
    std::size_t count = 0;
    for (const auto& array : joints_.all()) count += array.size();
    return count;
  }

  void copy_row() {
    for (const auto& array : joints_.all()) {
      if (!array.empty())
        std::memcpy(row_.next_cells(array.size()).data(), array.data(), array.size() * sizeof(double));
    }
  }

  void put_row() {
    bool in_order = true;
    std::size_t column = 0;
    std::string element;
    const std::vector<std::string>& names = joints_.names();
    for (std::size_t a = 0; a < suffixes_.size(); ++a) {
      const std::vector<double>& array = joints_.all()[a];
      for (std::size_t i = 0; i < array.size(); ++i) {
        element = i < names.size() ? names[i] : std::to_string(i);
        element += suffixes_[a];
        row_.put(element, array[i]);
        in_order = in_order && column < channel_.columns.size() && channel_.columns[column].element == element;
        ++column;
      }
    }
    // Then column k contains element k of the arrays in a row; not if names occur twice or other columns came before.
    columns_are_arrays_ = in_order && channel_.columns.size() == column_count();
  }

  TraceChannel& channel_;
  RowWriter row_;
  const std::vector<std::string_view> suffixes_;
  JointArrays joints_;
  bool columns_are_arrays_ = false;
};

/// Writes the row of a Joy. The channel's metadata may state the names of its axes and buttons, separated by blanks,
/// under `axes` and `buttons`. Without them, numbers are used.
class JoyContents {
 public:
  explicit JoyContents(const TraceChannel& channel)
      : axes_(names(channel, "axes")), buttons_(names(channel, "buttons")) {}

  void operator()(const msg::Joy& m, RowWriter& row) {
    for (std::size_t i = 0; i < m.axes.size(); ++i) row.put(element(axes_, "axes", i), m.axes[i]);
    for (std::size_t i = 0; i < m.buttons.size(); ++i)
      row.put(element(buttons_, "buttons", i), CellKind::signed_integer,
              static_cast<std::uint64_t>(std::int64_t{m.buttons[i]}));
  }

 private:
  static std::vector<std::string> names(const TraceChannel& channel, const std::string& array) {
    const auto stated = channel.metadata.find(array);
    if (stated == channel.metadata.end()) return {};
    std::istringstream words(stated->second);
    return {std::istream_iterator<std::string>(words), {}};
  }

  const std::string& element(const std::vector<std::string>& names, const char* array, std::size_t index) {
    element_ = array;
    element_ += '/';
    element_ += index < names.size() ? names[index] : std::to_string(index);
    return element_;
  }

  std::vector<std::string> axes_, buttons_;
  std::string element_;
};

// The contents of a row for each type.

template <class Message>
void put_numbers(ChannelKind kind, const Message& m, RowWriter& row) {
  const auto numbers = numbers_of(m);
  const std::vector<ChannelElement>& elements = elements_of(kind);
  for (std::size_t i = 0; i < numbers.size(); ++i) row.put(elements[i].name, numbers[i]);
}

void put_row(const msg::PoseStamped& m, RowWriter& row) { put_numbers(ChannelKind::pose, m, row); }
void put_row(const msg::TwistStamped& m, RowWriter& row) { put_numbers(ChannelKind::twist, m, row); }
void put_row(const msg::AccelStamped& m, RowWriter& row) { put_numbers(ChannelKind::acceleration, m, row); }
void put_row(const msg::WrenchStamped& m, RowWriter& row) { put_numbers(ChannelKind::wrench, m, row); }
void put_row(const msg::Imu& m, RowWriter& row) { put_numbers(ChannelKind::imu, m, row); }

void put_row(const msg::LaserScan& m, RowWriter& row) {
  row.put("angle_min", m.angle_min);
  row.put("angle_max", m.angle_max);
  row.put("range_min", m.range_min);
  row.put("range_max", m.range_max);
  row.put_array("ranges", m.ranges);
}

/// The distances, if each point has one; its position follows from the distance.
void put_row(const msg::PointCloud2& m, RowWriter& row) {
  row.put("height", CellKind::unsigned_integer, m.height);
  row.put("width", CellKind::unsigned_integer, m.width);
  if (std::vector<float> ranges; read_ranges(m, ranges)) row.put_array("ranges", ranges);
}

/// Writes numbers under the names of the kind's elements, after a prefix.
void put_behind(std::string& prefix, ChannelKind kind, std::span<const double> numbers, RowWriter& row) {
  const std::size_t stem = prefix.size();
  const std::vector<ChannelElement>& elements = elements_of(kind);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    prefix.resize(stem);
    prefix += elements[i].name;
    row.put(prefix, numbers[i]);
  }
}

/// If a row has fewer points than others, the missing ones are NaN; `count` is the number of points.
void put_row(const msg::Contacts& m, RowWriter& row) {
  row.put("contacts/count", CellKind::unsigned_integer, m.contacts.size());
  for (std::size_t i = 0; i < m.contacts.size(); ++i) {
    std::string prefix = "contacts/" + std::to_string(i) + "/";
    put_behind(prefix, ChannelKind::contacts, numbers_of(m.contacts[i]), row);
  }
}

void put_row(const msg::ContactForce& m, RowWriter& row) {
  row.put("count", CellKind::unsigned_integer, m.count);
  row.put("force/x", m.force.x);
  row.put("force/y", m.force.y);
  row.put("force/z", m.force.z);
}

void put_row(const msg::Tick& m, RowWriter& row) {
  row.put("tick", CellKind::signed_integer, static_cast<std::uint64_t>(m.tick));
  row.put("state_hash", CellKind::unsigned_integer, m.state_hash);
  row.put("input_hash", CellKind::unsigned_integer, m.input_hash);
  row.put("output_hash", CellKind::unsigned_integer, m.output_hash);
  std::string element;
  for (std::size_t i = 0; i < m.controller_results.size(); ++i) {
    element = "controller_results/" + std::to_string(i);
    row.put(element, CellKind::boolean, m.controller_results[i] ? 1 : 0);
  }
}

void put_row(const msg::TFMessage& m, RowWriter& row) {
  std::string prefix;
  for (const msg::TransformStamped& t : m.transforms) {
    prefix = t.child_frame_id;
    prefix += '/';
    put_behind(prefix, ChannelKind::transforms, numbers_of(t.transform), row);
  }
}

/// Reads the rows of a type of messages.h. `put_contents(message, row)` writes the cells of one row.
template <class Message, class PutContents>
class TypedRowReader : public RowReader {
 public:
  TypedRowReader(TraceChannel& channel, PutContents put_contents)
      : row_(channel), put_contents_(std::move(put_contents)) {}

  bool read(Bytes payload) override {
    CdrReader reader(payload);
    row_.begin_row();
    if (!msg::decode(reader, message_)) return false;
    put_contents_(message_, row_);
    return true;
  }

 private:
  RowWriter row_;
  PutContents put_contents_;
  Message message_;
};

template <class Message, class PutContents>
std::unique_ptr<RowReader> make_reader(TraceChannel& channel, PutContents put_contents) {
  return std::make_unique<TypedRowReader<Message, PutContents>>(channel, std::move(put_contents));
}

template <class Message>
std::unique_ptr<RowReader> make_if(TraceChannel& channel) {
  if (channel.type != Message::type_name) return nullptr;
  return make_reader<Message>(channel, [](const Message& m, RowWriter& row) { put_row(m, row); });
}

template <class... Messages>
std::unique_ptr<RowReader> make_first(TraceChannel& channel) {
  std::unique_ptr<RowReader> reader;
  static_cast<void>(((reader = make_if<Messages>(channel)) || ...));
  return reader;
}

}  // namespace

std::unique_ptr<RowReader> make_typed_row_reader(TraceChannel& channel) {
  if (channel.type == msg::JointState::type_name) {
    return std::make_unique<NamedArraysReader>(channel, std::vector<std::string_view>{"/q", "/dq", "/u"});
  }
  if (channel.type == msg::JointAccelerations::type_name) {
    return std::make_unique<NamedArraysReader>(channel, std::vector<std::string_view>{"/ddq"});
  }
  if (channel.type == msg::Joy::type_name) return make_reader<msg::Joy>(channel, JoyContents(channel));
  const ChannelName name = ChannelName::parse(channel.topic);
  if (channel.type == msg::Float64::type_name && name.kind == ChannelKind::variable) {
    // the element of a controller's variable is the last segment of the topic
    return make_reader<msg::Float64>(
        channel, [element = topic_segment(name.owner)](const auto& m, RowWriter& row) { row.put(element, m.data); });
  }
  if (name.kind == ChannelKind::delay)
    return make_reader<msg::Float64>(channel, [](const auto& m, RowWriter& row) { row.put("delay", m.data); });
  return make_first<msg::PoseStamped, msg::TwistStamped, msg::AccelStamped, msg::WrenchStamped, msg::Imu,
                    msg::LaserScan, msg::PointCloud2, msg::Contacts, msg::ContactForce, msg::Tick, msg::TFMessage>(
      channel);
}

}  // namespace rehearse
