// FixedMessage: a message of which only the stamp and some numbers change from tick to tick.
#pragma once

#include <rehearse/cdr.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/kinds/kinds.h"

namespace rehearse {

/// Its names and sizes are encoded once; a tick writes its numbers over those of the last one.
class FixedMessage {
 public:
  /// Encodes the message with that stamp and those numbers.
  using Encode = std::function<void(const msg::Time& stamp, std::span<const double> numbers, CdrWriter& cdr)>;

  /// A message that begins with a stamp and has `count` numbers, each a float64. nullopt: it has another form.
  static std::optional<FixedMessage> of(std::size_t count, const Encode& encode);

  void set_stamp(const msg::Time& stamp) {
    std::memcpy(&bytes_[stamp_place], &stamp.sec, sizeof stamp.sec);
    std::memcpy(&bytes_[stamp_place + sizeof stamp.sec], &stamp.nanosec, sizeof stamp.nanosec);
  }
  void set(std::size_t number, double value) { std::memcpy(&bytes_[places_[number]], &value, sizeof value); }
  void set(std::span<const double> numbers, std::size_t first = 0) {
    for (std::size_t i = 0; i < numbers.size(); ++i) set(first + i, numbers[i]);
  }
  std::size_t size() const { return places_.size(); }  // count of its numbers
  mcap::Bytes bytes() const { return bytes_; }

 private:
  static constexpr std::size_t stamp_place = 4;  // behind the bytes that state the byte order

  std::vector<std::byte> bytes_;
  std::vector<std::uint32_t> places_;  // by number: index of its first byte
};

/// A number of a message of joints.
struct JointElement {
  std::vector<double> msg::JointState::*array;
  std::size_t index;  // index in the array
};

/// The message of these joints. Its numbers are those at the places; the others of their arrays are NaN, and arrays
/// without a place are empty.
FixedMessage joint_message(const std::vector<std::string>& names, const std::vector<JointElement>& places);

/// The message of a kind with ChannelForm::numbers.
FixedMessage fixed_numbers(ChannelKind kind, const std::string& frame);

}  // namespace rehearse
