// The ring in shared memory: order and sizes of messages, answers, and damage by someone else.
#include "core/keeper/ring.h"

#include <gmock/gmock.h>

#include <chrono>
#include <cstring>
#include <thread>
#include <vector>

namespace rehearse {
namespace {

using Message = std::vector<std::byte>;
constexpr std::chrono::milliseconds a_while{10};

Message message_of(std::size_t size, std::size_t number) {
  Message message(size);
  for (std::size_t i = 0; i < size; ++i) message[i] = static_cast<std::byte>(i * 7 + number);
  return message;
}

/// Receives that many messages.
std::vector<Message> receive(RingReader& reader, std::size_t count) {
  std::vector<Message> all;
  Message message;
  while (all.size() < count) {
    const RingReader::Got got = reader.receive(message);
    if (got == RingReader::Got::message) all.push_back(message);
    if (got == RingReader::Got::nothing) reader.wait(a_while);
    if (got == RingReader::Got::damaged) break;
  }
  return all;
}

TEST(Ring, PassesMessagesOfAnySizeInTheirOrder) {
  Ring& ring = *Ring::create();
  std::vector<Message> sent;
  for (const std::size_t size : {0ul, 1ul, 15ul, 16ul, 17ul, 1000ul, 262144ul, 262145ul, 5000000ul, 1ul, 10000000ul})
    sent.push_back(message_of(size, sent.size()));
  std::thread child([&] {
    RingWriter writer(ring);
    for (const Message& message : sent) {
      const Bytes bytes(message);
      writer.send({bytes.first(bytes.size() / 3), bytes.subspan(bytes.size() / 3)});
    }
  });
  RingReader reader(ring);
  const std::vector<Message> received = receive(reader, sent.size());
  child.join();
  EXPECT_TRUE(received == sent);
}

TEST(Ring, PassesMoreThanItHolds) {
  Ring& ring = *Ring::create();
  constexpr std::size_t count = 20000, size = 1000;
  static_assert(count * size > 4 * Ring::capacity);
  std::thread child([&] {
    RingWriter writer(ring);
    for (std::size_t i = 0; i < count; ++i) writer.send({message_of(size, i)});
  });
  RingReader reader(ring);
  const std::vector<Message> received = receive(reader, count);
  child.join();
  ASSERT_EQ(received.size(), count);
  for (std::size_t i = 0; i < count; ++i) ASSERT_TRUE(received[i] == message_of(size, i)) << i;
}

TEST(Ring, AnswersTheMessageThatWaits) {
  Ring& ring = *Ring::create();
  Message answer;
  std::thread child([&] {
    RingWriter writer(ring);
    writer.send({message_of(10, 0)});
    const Bytes text = writer.ask({message_of(10, 1)});
    answer.assign(text.begin(), text.end());
  });
  RingReader reader(ring);
  EXPECT_EQ(receive(reader, 2).size(), 2u);
  reader.answer(message_of(100, 2));
  child.join();
  EXPECT_TRUE(answer == message_of(100, 2));
}

TEST(Ring, DetectsEachByteThatSomeoneElseWrites) {
  constexpr std::size_t size = 100, head = 16;
  for (std::size_t i = 0; i < head + size; ++i) {
    Ring& ring = *Ring::create();
    RingWriter(ring).send({message_of(size, 0)});
    ring.bytes[i] ^= std::byte{0x40};
    RingReader reader(ring);
    Message message;
    EXPECT_EQ(reader.receive(message), RingReader::Got::damaged) << "byte " << i;
  }
}

TEST(Ring, DetectsPositionsThatCanNotBe) {
  for (const std::uint64_t wrong : {std::uint64_t{8}, std::uint64_t{Ring::capacity + 16}, ~std::uint64_t{0}}) {
    Ring& ring = *Ring::create();
    ring.written = wrong;
    RingReader reader(ring);
    Message message;
    EXPECT_EQ(reader.receive(message), RingReader::Got::damaged) << wrong;
  }
}

}  // namespace
}  // namespace rehearse
