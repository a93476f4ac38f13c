#include "core/recording/fixed_message.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rehearse {
namespace {

std::vector<std::byte> encoded(const auto& message) {
  CdrWriter cdr;
  msg::encode(message, cdr);
  return {cdr.bytes().begin(), cdr.bytes().end()};
}

std::vector<std::byte> bytes_of(const FixedMessage& message) {
  return {message.bytes().begin(), message.bytes().end()};
}

TEST(FixedMessage, HasTheBytesOfItsMessageInEachTick) {
  const std::vector<std::string> names{"ONE", "TWO", "AND_A_THIRD"};
  FixedMessage fixed = joint_message(
      names, {{&msg::JointState::velocity, 2}, {&msg::JointState::position, 0}, {&msg::JointState::position, 2}});
  msg::JointState message;
  message.name = names;
  for (std::uint32_t tick = 1; tick < 4; ++tick) {
    const double number = tick / 3.0;
    message.header.stamp = {static_cast<std::int32_t>(tick), 1000 * tick};
    message.position = {number, std::nan(""), -number};
    message.velocity = {std::nan(""), std::nan(""), 2.0 * number};
    fixed.set_stamp(message.header.stamp);
    fixed.set(0, 2.0 * number);
    fixed.set(1, number);
    fixed.set(2, -number);
    EXPECT_EQ(bytes_of(fixed), encoded(message));
  }
}

TEST(FixedMessage, HasTheFrameOfItsKind) {
  FixedMessage fixed = fixed_numbers(ChannelKind::wrench, "Robot/Foot");
  msg::WrenchStamped message{{{3, 4}, "Robot/Foot"}, {{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}}};
  fixed.set_stamp(message.header.stamp);
  fixed.set(std::vector<double>{1.0, 2.0, 3.0, 4.0, 5.0, 6.0});
  EXPECT_EQ(bytes_of(fixed), encoded(message));
}

TEST(FixedMessage, FindsThePlacesOfManyNumbers) {
  constexpr std::size_t count = 40'000;
  std::vector<double> values(count);
  const auto encode = [](const msg::Time& stamp, std::span<const double> numbers, CdrWriter& cdr) {
    msg::encode(msg::DeviceState{{stamp, "f"}, {numbers.rbegin(), numbers.rend()}}, cdr);
  };
  auto fixed = FixedMessage::of(count, encode);
  ASSERT_TRUE(fixed);
  for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<double>(i) - 0.5;
  fixed->set_stamp({1, 2});
  fixed->set(values);
  EXPECT_EQ(bytes_of(*fixed), encoded(msg::DeviceState{{{1, 2}, "f"}, {values.rbegin(), values.rend()}}));
}

TEST(FixedMessage, IsNoneOfAnotherForm) {
  using Numbers = std::span<const double>;
  const auto without_one = [](const msg::Time& stamp, Numbers numbers, CdrWriter& cdr) {
    msg::encode(msg::DeviceState{{stamp, ""}, {numbers[0]}}, cdr);
  };
  EXPECT_FALSE(FixedMessage::of(2, without_one));
  const auto rounded = [](const msg::Time& stamp, Numbers numbers, CdrWriter& cdr) {
    msg::encode(msg::ContactForce{{stamp, ""}, static_cast<std::uint32_t>(numbers[0]), {}}, cdr);
  };
  EXPECT_FALSE(FixedMessage::of(1, rounded));
  const auto growing = [](const msg::Time& stamp, Numbers numbers, CdrWriter& cdr) {
    msg::encode(msg::DeviceState{{stamp, ""}, std::vector<double>(numbers[0] == 0.0 ? 1 : 2, numbers[0])}, cdr);
  };
  EXPECT_FALSE(FixedMessage::of(1, growing));
  const auto twice = [](const msg::Time& stamp, Numbers numbers, CdrWriter& cdr) {
    msg::encode(msg::DeviceState{{stamp, ""}, {numbers[0], numbers[0]}}, cdr);
  };
  EXPECT_FALSE(FixedMessage::of(1, twice));
}

}  // namespace
}  // namespace rehearse
