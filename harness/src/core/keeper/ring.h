// Ring: messages from a process to its parent, through shared memory of fixed size, and short answers back.
//
// A guest may leave the heap damaged or a lock taken. So the writing side allocates nothing, takes no lock of the C
// library and uses no descriptor. The reading side trusts nothing in the memory, because a guest can write into it:
// each piece has a hash, and each length is checked. A message that is complete in the ring is never lost, however the
// writing process ends.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

namespace rehearse {

using Bytes = std::span<const std::byte>;

/// The shared memory. Everything in it may be overwritten at any time.
struct Ring {
  static constexpr std::size_t capacity = std::size_t{4} << 20;        // [bytes]
  static constexpr std::size_t longest_answer = std::size_t{1} << 14;  // [bytes]

  /// Null if there is no memory. Processes that are forked later share it.
  static Ring* create();

  alignas(64) std::atomic<std::uint64_t> written{0};  // [bytes] since the beginning, like `read`
  alignas(64) std::atomic<std::uint64_t> read{0};
  alignas(64) std::atomic<std::uint32_t> to_reader{0};  // futex
  alignas(64) std::atomic<std::uint32_t> to_writer{0};  // futex
  std::atomic<std::uint32_t> writer_waits{0};           // 1: for room or an answer
  std::atomic<std::uint32_t> answers{0};                // number of answers
  std::atomic<std::uint32_t> failures{0};               // number of failures that the writer has not asked for
  std::atomic<std::uint32_t> answer_size{0};            // [bytes]
  alignas(64) std::byte answer[longest_answer] = {};
  alignas(64) std::byte bytes[capacity] = {};
};

/// The side of the child. Threads may use it one at a time.
class RingWriter {
 public:
  explicit RingWriter(Ring& ring) : ring_(ring) {}

  /// Sends the parts as one message. Waits while the ring is full.
  void send(std::initializer_list<Bytes> parts);
  /// Sends the message, and waits for the answer to it, which is valid until the next call.
  Bytes ask(std::initializer_list<Bytes> parts);
  /// Number of failures that the reader has reported.
  std::uint32_t failures() const { return ring_.failures.load(std::memory_order_acquire); }
  /// Whether processes that this one forks get the memory.
  void set_hidden_from_forks(bool hidden);

 private:
  std::byte* begin_piece(std::size_t size);
  void end_piece(std::byte* piece, std::size_t size, bool is_last);
  template <class Condition>
  void wait_until(Condition come);

  Ring& ring_;
};

/// The side of the parent. One thread may use it.
class RingReader {
 public:
  explicit RingReader(Ring& ring) : ring_(ring) {}

  enum class Got { message, nothing, damaged };
  /// Takes the next complete message. `damaged`: a guest has written into the memory, and nothing more can be read.
  Got receive(std::vector<std::byte>& message);
  /// Waits until there may be a message, at most that long.
  void wait(std::chrono::milliseconds longest);
  /// Ends a wait() of another thread.
  void end_wait();
  /// Answers the message that was received last.
  void answer(Bytes text);
  void note_failure() { ring_.failures.fetch_add(1, std::memory_order_release); }

 private:
  void pass(std::size_t size);

  Ring& ring_;
  std::uint64_t position_ = 0;
  std::vector<std::byte> partial_;  // a message whose last piece has not come yet
};

}  // namespace rehearse
