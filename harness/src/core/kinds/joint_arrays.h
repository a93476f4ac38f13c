// JointArrays: the numbers of a stream of messages with arrays that belong to an array of names, read fast:
// sensor_msgs/JointState and JointAccelerations.
//
// The names in such messages are the same in all ticks. They are decoded once. If a later message has equal bytes up to
// the numbers, only the numbers are read.
#pragma once

#include <rehearse/mcap_types.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace rehearse {

namespace msg {
struct JointState;
}

class JointArrays {
 public:
  /// `count`: the number of arrays after the names; of a JointState 3, of JointAccelerations 1.
  explicit JointArrays(std::size_t count = 3) : arrays_(count), offsets_(count) {}

  /// False if the bytes are no such message.
  bool read(std::span<const std::byte> payload);
  /// Takes the values of a JointState that was read in another way.
  void take(const msg::JointState& message);
  /// True if each array is empty or as long as names().
  bool fit_the_names() const;

  const std::vector<std::string>& names() const { return names_; }
  const std::vector<std::vector<double>>& all() const { return arrays_; }
  // of a JointState
  const std::vector<double>& position() const { return arrays_[0]; }
  const std::vector<double>& velocity() const { return arrays_[1]; }
  const std::vector<double>& effort() const { return arrays_[2]; }
  /// True if the last message was the first, or has other names or numbers of values than the message before.
  /// Otherwise the values are at the same addresses.
  bool layout_changed() const { return layout_changed_; }

 private:
  bool read_everything(std::span<const std::byte> payload);

  std::vector<std::string> names_;
  std::vector<std::vector<double>> arrays_;
  std::vector<std::size_t> offsets_;  // offset of each array's first number
  std::vector<std::byte> frame_;      // all bytes of the last message that was decoded completely
  bool layout_changed_ = false;
};

}  // namespace rehearse
