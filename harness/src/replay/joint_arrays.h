// JointArrays: the numbers of a stream of sensor_msgs/JointState messages, read fast.
//
// The names in such messages are the same in all ticks. They are decoded once. If a later message has equal bytes up to
// the numbers, only the numbers are read.
#pragma once

#include <rehearse/mcap.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace rehearse {

class JointArrays {
 public:
  /// False if the bytes are no JointState message.
  bool read(mcap::Bytes payload);

  const std::vector<std::string>& names() const { return names_; }
  /// Position, velocity and effort, each empty or as long as names().
  const std::vector<double>& position() const { return arrays_[0]; }
  const std::vector<double>& velocity() const { return arrays_[1]; }
  const std::vector<double>& effort() const { return arrays_[2]; }
  /// True if the last read() was the first, or found other names or numbers of values than the read() before.
  /// Otherwise the values are at the same addresses.
  bool layout_changed() const { return layout_changed_; }

 private:
  bool read_everything(mcap::Bytes payload);

  std::vector<std::string> names_;
  std::array<std::vector<double>, 3> arrays_;
  std::array<std::size_t, 3> offsets_{};  // offset of each array's first number
  std::vector<std::byte> frame_;          // all bytes of the last message that was decoded completely
  bool layout_changed_ = false;
};

}  // namespace rehearse
