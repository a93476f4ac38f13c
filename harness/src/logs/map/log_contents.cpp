#include "log_contents.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/median.h"
#include "core/kinds/kinds.h"
#include "core/ros2msg/ros2msg.h"

namespace rehearse {
namespace {

using enum FieldContent;

constexpr std::uint64_t longest_time = 60'000'000'000;  // [ns]
constexpr std::uint64_t most_messages = 500;            // of a topic

/// Whether messages of the topic are those of the input.
bool is_for(const LogInput& input, const LogTopic& topic) {
  switch (input.content) {
    case LogInput::Content::numbers:
      return std::ranges::all_of(fields_of(input), [&](const std::string& field) { return topic.has(field); });
    case LogInput::Content::picture:
      return (topic.has("encoding", text) || topic.has("format", text)) && topic.has("data", bytes) &&
             topic.has("header/frame_id", text);
    case LogInput::Content::camera_info: return topic.has("k/*") && topic.has("width");
    case LogInput::Content::ranges:
      return topic.has("ranges/*") || (topic.has("fields/*/name", text) && topic.has("point_step"));
    case LogInput::Content::depth:  // as a picture
    case LogInput::Content::none: break;
  }
  return false;
}

/// Null: the messages are for no device.
const LogInput* input_of(const LogTopic& topic) {
  if (!topic.problem.empty()) return nullptr;
  const auto inputs = log_inputs();
  const auto found = std::ranges::find_if(inputs, [&](const LogInput* input) { return is_for(*input, topic); });
  return found == inputs.end() ? nullptr : *found;
}

TopicUse use_of(const LogTopic& topic) {
  if (!topic.problem.empty()) return TopicUse::other;
  if (topic.has("name/*", text) && (topic.has("position/*") || topic.has("velocity/*") || topic.has("effort/*")))
    return TopicUse::joint_states;
  if (input_of(topic)) return TopicUse::device;
  if (topic.has("axes/*") && topic.has("buttons/*")) return TopicUse::joystick;
  if (topic.has("linear/x") || topic.has("twist/linear/x")) return TopicUse::twist;
  if (topic.has("pose/pose/position/x")) return TopicUse::odometry;
  if (topic.has("pose/position/x")) return TopicUse::pose;
  return topic.has("data/*") ? TopicUse::numbers : TopicUse::other;
}

/// Collects the facts of one topic.
class TopicReader {
 public:
  explicit TopicReader(TopicContents& contents) : contents_(contents) {
    if (contents.topic.problem.empty()) decoder_ = std::make_unique<ros2msg::Decoder>(contents.topic.definitions);
  }

  /// Adds the facts of a message; false: enough messages were read.
  bool take(const mcap::Message& message) {
    if (contents_.messages == most_messages) return false;
    if (contents_.messages++ > 0) intervals_.push_back(static_cast<double>(message.log_time - last_) * 1e-9);
    last_ = message.log_time;
    const bool every = contents_.use == TopicUse::joint_states || contents_.messages < 20;
    if (!decoder_ || !every) return true;
    std::int64_t seconds = 0, nanoseconds = 0;
    std::size_t numbers = 0;
    const auto take_value = [&](const ros2msg::Value& value) {
      if (value.path == "header/stamp/sec") seconds = value.integer;
      if (value.path == "header/stamp/nanosec") nanoseconds = static_cast<std::int64_t>(value.unsigned_integer);
      if (value.path.starts_with("ranges/") || value.path.starts_with("data/")) ++numbers;
      take_value_of(value);
    };
    if (!decoder_->decode(message.data, take_value)) return true;
    contents_.numbers = std::max(contents_.numbers, numbers);
    if (contents_.topic.has("header/stamp/sec"))
      lags_.push_back(
          static_cast<double>(static_cast<std::int64_t>(message.log_time) - seconds * 1'000'000'000 - nanoseconds) *
          1e-9);
    return true;
  }

  void finish() {
    if (!lags_.empty()) contents_.stamp_lag = upper_median(lags_);
    if (intervals_.empty()) return;
    const double median = upper_median(intervals_);
    contents_.interval = median;
    for (const double interval : intervals_)
      contents_.unevenness = std::max(contents_.unevenness, std::abs(interval / median - 1.0));
  }

 private:
  void take_value_of(const ros2msg::Value& value) {
    const std::string_view path = value.path;
    if (path == "header/frame_id" && contents_.frame.empty()) contents_.frame = value.text;
    if (path == "encoding" || path == "format") contents_.encoding = value.text;
    if (path == "width") contents_.width = static_cast<std::uint32_t>(value.unsigned_integer);
    if (path == "height") contents_.height = static_cast<std::uint32_t>(value.unsigned_integer);
    if (path.starts_with("position/")) contents_.has_position = true;
    if (path.starts_with("velocity/")) contents_.has_velocity = true;
    if (path.starts_with("effort/")) contents_.has_effort = true;
    if (!path.starts_with("name/")) return;
    if (std::ranges::find(contents_.names, value.text) == contents_.names.end())
      contents_.names.emplace_back(value.text);
  }

  TopicContents& contents_;
  std::unique_ptr<ros2msg::Decoder> decoder_;
  std::uint64_t last_ = 0;
  std::vector<double> intervals_, lags_;  // [s]
};

}  // namespace

std::vector<TopicContents> contents_of(mcap::Reader& log) {
  std::vector<TopicContents> contents;
  for (LogTopic& topic : topics_of(log)) {
    TopicContents& added = contents.emplace_back();
    added.topic = std::move(topic);
    added.use = use_of(added.topic);
    added.input = added.use == TopicUse::device ? input_of(added.topic) : nullptr;
  }
  std::map<std::string, TopicReader> readers;
  for (TopicContents& topic : contents) readers.try_emplace(topic.topic.name, topic);
  std::optional<std::uint64_t> start;
  std::size_t unfinished = readers.size();
  static_cast<void>(log.for_each_message_in_order([&](const mcap::Message& message) {
    if (!start) start = message.log_time;
    const auto reader = readers.find(message.channel->topic);
    if (reader != readers.end() && !reader->second.take(message) && --unfinished == 0) return false;
    return message.log_time - *start < longest_time;
  }));
  for (auto& [name, reader] : readers) reader.finish();
  return contents;
}

}  // namespace rehearse
