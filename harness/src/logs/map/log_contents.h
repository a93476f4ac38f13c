// LogContents: the facts of a log's topics from which a first map is made; they are read from the log's beginning.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/kinds/kind.h"
#include "log_topics.h"

namespace rehearse {

/// The use of a topic's messages, by their fields.
enum class TopicUse { joint_states, device, joystick, twist, pose, odometry, numbers, other };

struct TopicContents {
  LogTopic topic;
  TopicUse use = TopicUse::other;
  const LogInput* input = nullptr;  // of a device; a depth picture has that of a picture
  std::uint64_t messages = 0;       // number of messages that were read
  std::optional<double> interval;   // median distance of two messages [s]
  double unevenness = 0.0;          // largest relative difference of a distance from the median
  std::optional<double> stamp_lag;  // median of log time less header.stamp [s]
  std::string frame;                // header.frame_id of the first message
  std::vector<std::string> names;   // of joints, in order of first use
  bool has_position = false, has_velocity = false, has_effort = false;  // true if any message has one
  std::string encoding;                                                 // of pictures
  std::uint32_t width = 0, height = 0;                                  // of pictures [pixels]
  std::size_t numbers = 0;  // of a message: the beams of a scan, the numbers of an array
};

/// Reads the first minute of the log, of each topic at most 500 messages. Sorted by topic. Damage is ignored.
std::vector<TopicContents> contents_of(mcap::Reader& log);

}  // namespace rehearse
