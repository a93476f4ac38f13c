// A bag of ROS 1: any bytes are refused or read to their end, with the damage stated.
#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>

#include "logs/bag/ros1_bag.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rehearse;
  const auto bag = bag::Ros1Bag::open({reinterpret_cast<const std::byte*>(data), size}, "fuzz.bag");
  if (!bag) {
    REHEARSE_ASSERT(!bag.errors()[0].message.empty(), "a refusal says why");
    return 0;
  }
  std::size_t bytes = 0;
  const auto read = (*bag)->for_each_message(
      [&](const bag::Ros1Connection& connection) { bytes += connection.topic.size() + connection.definition.size(); },
      [&](std::uint32_t, std::uint64_t, mcap::Bytes message) {
        bytes += message.size();
        return Result<void>();
      });
  if (!read) REHEARSE_ASSERT(!read.errors()[0].message.empty(), "damage is described");
  return 0;
}
