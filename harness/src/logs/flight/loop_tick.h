// The messages of a flight that no other recording has.
#pragma once

#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace rehearse::msg {

struct LoopTick {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/LoopTick";
  Time stamp;
  std::int64_t tick = 0;
  std::int64_t loop_time = 0;  // of the loop's clock [ns]
  std::uint64_t dropped = 0;   // number of the ticks so far that are in no recording
  std::string absent;          // inputs without new numbers: "Imu, LeftFoot"
  REHEARSE_FIELDS(stamp, tick, loop_time, dropped, absent)
};

struct ImageReference {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/ImageReference";
  Time stamp;
  std::int64_t tick = 0;
  std::string device;   // the camera
  std::string picture;  // the name under which the loop stored it: the path of a file
  REHEARSE_FIELDS(stamp, tick, device, picture)
};

}  // namespace rehearse::msg
