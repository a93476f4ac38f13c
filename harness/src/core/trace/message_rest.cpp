#include "message_rest.h"

#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "base/glob.h"
#include "base/hashing.h"
#include "core/ros2msg/message_format.h"

namespace rehearse {
namespace {

struct ColumnsOfType {
  std::string_view type;
  // Patterns up to the first empty pattern; of texts only those that name columns.
  std::array<std::string_view, 5> patterns;
};

constexpr std::array<ColumnsOfType, 14> columns_by_type{{
    {msg::Tick::type_name, {"tick", "state_hash", "input_hash", "output_hash", "controller_results/*"}},
    {msg::JointState::type_name, {"name/*", "position/*", "velocity/*", "effort/*"}},
    {msg::JointAccelerations::type_name, {"name/*", "acceleration/*"}},
    {msg::Joy::type_name, {"axes/*", "buttons/*"}},
    {msg::PoseStamped::type_name, {"pose/*"}},
    {msg::TwistStamped::type_name, {"twist/*"}},
    {msg::AccelStamped::type_name, {"accel/*"}},
    {msg::WrenchStamped::type_name, {"wrench/*"}},
    {msg::Imu::type_name, {"angular_velocity/*", "linear_acceleration/*"}},
    {msg::LaserScan::type_name, {"angle_min", "angle_max", "range_min", "range_max", "ranges/*"}},
    {msg::PointCloud2::type_name, {"height", "width"}},
    {msg::Contacts::type_name, {"contacts/*"}},
    {msg::ContactForce::type_name, {"count", "force/*"}},
    {msg::TFMessage::type_name, {"transforms/*/child_frame_id", "transforms/*/transform/*"}},
}};

constexpr std::byte no_stamp{0xff};  // replaces the log time: no stamp has so many nanoseconds

std::uint32_t number_at(mcap::Bytes payload, std::size_t position) {
  std::uint32_t number = 0;
  std::memcpy(&number, payload.data() + position, sizeof number);
  return number;
}

}  // namespace

ColumnFields::ColumnFields(std::string_view type) {
  const auto known =
      std::ranges::find_if(columns_by_type, [type](const ColumnsOfType& known) { return known.type == type; });
  if (known == columns_by_type.end()) {
    any_number_ = true;
  } else {
    std::ranges::copy_if(known->patterns, std::back_inserter(patterns_),
                         [](std::string_view pattern) { return !pattern.empty(); });
  }
}

bool ColumnFields::covers(const ros2msg::Value& value) const {
  if (any_number_) return value.is_number() && !value.path.starts_with("header/") && !value.path.starts_with("stamp/");
  return std::ranges::any_of(patterns_, [&](std::string_view pattern) { return matches(pattern, value.path); });
}

std::unique_ptr<MessageRest> MessageRest::make(const std::string& type, std::string_view encoding,
                                               const mcap::Schema* schema) {
  if (!ros2msg::is_decodable(encoding, schema)) return nullptr;
  auto parsed = ros2msg::schema_of(encoding, *schema, "schema " + schema->name);
  if (!parsed) return nullptr;
  return std::unique_ptr<MessageRest>(new MessageRest(type, std::move(*parsed)));
}

bool MessageRest::take(mcap::Bytes payload, std::uint64_t log_time) {
  if (is_as_before(payload, log_time)) return false;
  const std::vector<std::byte> before = std::exchange(bytes_, {});
  decode(payload, log_time);
  return before != bytes_;
}

/// True if all bytes of the rest are equal to the bytes of the message before. Then the layout is equal, too, because
/// strings and counts belong to the rest.
bool MessageRest::is_as_before(mcap::Bytes payload, std::uint64_t log_time) const {
  if (bytes_.empty() || payload.size() != bytes_.size()) return false;
  for (const auto& [begin, end] : kept_)
    if (std::memcmp(payload.data() + begin, bytes_.data() + begin, end - begin) != 0) return false;
  if (stamps_.empty()) return true;
  if (CdrReader(payload).swapped()) return false;
  return std::ranges::all_of(stamps_, [&](const Stamp& stamp) {
    const msg::Time time{static_cast<std::int32_t>(number_at(payload, stamp.seconds)),
                         number_at(payload, stamp.nanoseconds)};
    return stamp.is_log_time && time.to_ns() == log_time;
  });
}

void MessageRest::decode(mcap::Bytes payload, std::uint64_t log_time) {
  bytes_.assign(payload.begin(), payload.end());
  stamps_.clear();
  std::vector<std::pair<std::size_t, std::size_t>> cleared;
  if (!is_cdr_) return find_kept(std::move(cleared));
  const auto take_out = [&](std::size_t begin, std::size_t size, std::byte filling = std::byte{0}) {
    std::fill_n(bytes_.begin() + static_cast<std::ptrdiff_t>(begin), size, filling);
    if (!cleared.empty() && cleared.back().second == begin)
      cleared.back().second += size;
    else
      cleared.emplace_back(begin, begin + size);
  };
  msg::Time stamp;
  std::size_t seconds = 0;
  decoder_.decode(payload, [&](const ros2msg::Value& value) {
    if (value.bytes.empty()) return;
    const auto begin = static_cast<std::size_t>(value.bytes.data() - payload.data());
    if (columns_.covers(value)) return take_out(begin, value.bytes.size());
    if (value.bytes.size() != sizeof(std::uint32_t)) return;
    if (value.path.ends_with("stamp/sec")) {
      stamp.sec = static_cast<std::int32_t>(value.integer);
      seconds = begin;
    } else if (value.path.ends_with("stamp/nanosec") && begin == seconds + sizeof(std::uint32_t)) {
      stamp.nanosec = static_cast<std::uint32_t>(value.unsigned_integer);
      const bool is_log_time = stamp.to_ns() == log_time;
      stamps_.push_back({seconds, begin, is_log_time});
      if (is_log_time) take_out(seconds, 2 * sizeof(std::uint32_t), no_stamp);
    }
  });
  find_kept(std::move(cleared));
}

void MessageRest::find_kept(std::vector<std::pair<std::size_t, std::size_t>> cleared) {
  kept_.clear();
  std::size_t begin = 0;
  cleared.emplace_back(bytes_.size(), bytes_.size());
  for (const auto& [from, until] : cleared) {
    if (begin < from) kept_.emplace_back(begin, from);
    begin = until;
  }
}

std::uint64_t MessageRest::hash() const { return hash_bytes(bytes_.data(), bytes_.size()); }

std::vector<std::byte> MessageRest::bytes_at(std::uint64_t log_time) const {
  std::vector<std::byte> bytes = bytes_;
  const bool swapped = CdrReader(bytes).swapped();
  const auto put = [&](std::size_t position, std::uint32_t number) {
    if (swapped) number = __builtin_bswap32(number);
    std::memcpy(bytes.data() + position, &number, sizeof number);
  };
  const msg::Time time = msg::Time::from_ns(log_time);
  for (const Stamp& stamp : stamps_) {
    if (!stamp.is_log_time) continue;
    put(stamp.seconds, static_cast<std::uint32_t>(time.sec));
    put(stamp.nanoseconds, time.nanosec);
  }
  return bytes;
}

}  // namespace rehearse
