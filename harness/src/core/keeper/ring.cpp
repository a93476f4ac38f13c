#include "ring.h"

#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <new>

#include "base/hashing.h"

namespace rehearse {
namespace {

// A message is one or more pieces. A piece lies in the ring without a gap; a pad fills the end before the next begins.
struct PieceHead {
  std::uint32_t size = 0;  // of the data after the head [bytes]
  std::uint32_t kind = 0;
  std::uint64_t hash = 0;  // of size, kind and data
};
constexpr std::uint32_t more = 1, last = 2, pad = 3;  // kinds

constexpr std::size_t alignment = sizeof(PieceHead);
constexpr std::size_t largest_piece = std::size_t{1} << 18;  // [bytes]
static_assert(Ring::capacity % alignment == 0 && largest_piece < Ring::capacity / 4);

constexpr std::size_t extent_of(std::size_t size) {
  return sizeof(PieceHead) + (size + alignment - 1) / alignment * alignment;
}

std::uint64_t hash_of(const PieceHead& head, const std::byte* data) {
  return hash_bytes(data, head.size, std::uint64_t{head.kind} << 32 | head.size);
}

constexpr std::chrono::milliseconds patience{10};  // a missed wake-up delays no longer than this

void wait_on(std::atomic<std::uint32_t>& word, std::uint32_t seen, std::chrono::milliseconds longest) {
  const timespec limit{longest.count() / 1000, longest.count() % 1000 * 1'000'000};
  syscall(SYS_futex, &word, FUTEX_WAIT, seen, &limit, nullptr, 0);
}

void wake(std::atomic<std::uint32_t>& word) {
  word.fetch_add(1, std::memory_order_release);
  syscall(SYS_futex, &word, FUTEX_WAKE, std::numeric_limits<int>::max(), nullptr, nullptr, 0);
}

}  // namespace

Ring* Ring::create() {
  void* memory = mmap(nullptr, sizeof(Ring), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return nullptr;
  // Not value-initialised: the pages are zeros already, and are touched when they are used.
  return static_cast<Ring*>(memory);
}

void RingWriter::set_hidden_from_forks(bool hidden) {
  madvise(&ring_, sizeof(Ring), hidden ? MADV_DONTFORK : MADV_DOFORK);
}

/// Waits until `come` is true.
template <class Condition>
void RingWriter::wait_until(Condition come) {
  for (;;) {
    const std::uint32_t seen = ring_.to_writer.load(std::memory_order_acquire);
    if (come()) return;
    ring_.writer_waits.store(1, std::memory_order_seq_cst);
    wake(ring_.to_reader);
    wait_on(ring_.to_writer, seen, patience);
  }
}

/// Returns the place of a piece's head, when there is room for it.
std::byte* RingWriter::begin_piece(std::size_t size) {
  const std::uint64_t written = ring_.written.load(std::memory_order_relaxed);
  const std::size_t place = written % Ring::capacity, left = Ring::capacity - place;
  const bool fits = extent_of(size) <= left;
  const std::size_t needed = extent_of(size) + (fits ? 0 : left);
  wait_until([&] { return written + needed - ring_.read.load(std::memory_order_acquire) <= Ring::capacity; });
  if (fits) return ring_.bytes + place;
  PieceHead filler{static_cast<std::uint32_t>(left - sizeof(PieceHead)), pad, 0};
  std::memcpy(ring_.bytes + place, &filler, sizeof filler);
  ring_.written.store(written + left, std::memory_order_release);
  return ring_.bytes;
}

void RingWriter::end_piece(std::byte* piece, std::size_t size, bool is_last) {
  PieceHead head{static_cast<std::uint32_t>(size), is_last ? last : more, 0};
  head.hash = hash_of(head, piece + sizeof head);
  std::memcpy(piece, &head, sizeof head);
  const std::uint64_t written = ring_.written.load(std::memory_order_relaxed);
  ring_.written.store(written + extent_of(size), std::memory_order_release);
  // Usually the reader wakes up by its own clock: a system call in each tick would take longer than all of this.
  const std::uint64_t waiting = written + extent_of(size) - ring_.read.load(std::memory_order_relaxed);
  if (waiting > Ring::capacity / 4 && waiting - extent_of(size) <= Ring::capacity / 4) wake(ring_.to_reader);
}

void RingWriter::send(std::initializer_list<Bytes> parts) {
  std::size_t left = 0;
  for (const Bytes part : parts) left += part.size();
  const Bytes* part = parts.begin();
  std::size_t taken = 0;  // of *part
  do {
    const std::size_t size = std::min(left, largest_piece);
    std::byte* const piece = begin_piece(size);
    for (std::size_t filled = 0; filled < size;) {
      const std::size_t count = std::min(size - filled, part->size() - taken);
      if (count > 0) std::memcpy(piece + sizeof(PieceHead) + filled, part->data() + taken, count);
      filled += count;
      taken += count;
      if (taken == part->size()) ++part, taken = 0;
    }
    left -= size;
    end_piece(piece, size, left == 0);
  } while (left > 0);
}

Bytes RingWriter::ask(std::initializer_list<Bytes> parts) {
  const std::uint32_t answers = ring_.answers.load(std::memory_order_acquire);
  send(parts);
  wait_until([&] { return ring_.answers.load(std::memory_order_acquire) != answers; });
  const std::size_t size = ring_.answer_size.load(std::memory_order_acquire);
  return {ring_.answer, std::min(size, Ring::longest_answer)};
}

void RingReader::pass(std::size_t size) {
  position_ += size;
  ring_.read.store(position_, std::memory_order_release);
  if (ring_.writer_waits.exchange(0, std::memory_order_seq_cst) != 0) wake(ring_.to_writer);
}

RingReader::Got RingReader::receive(std::vector<std::byte>& message) {
  for (;;) {
    const std::uint64_t waiting = ring_.written.load(std::memory_order_acquire) - position_;
    if (waiting > Ring::capacity || waiting % alignment != 0) return Got::damaged;
    if (waiting == 0) return Got::nothing;
    const std::byte* const piece = ring_.bytes + position_ % Ring::capacity;
    PieceHead head;
    std::memcpy(&head, piece, sizeof head);
    const std::size_t extent = extent_of(head.size);
    if (extent > waiting || position_ % Ring::capacity + extent > Ring::capacity) return Got::damaged;
    if (head.kind != pad) {
      const std::size_t before = partial_.size();
      partial_.insert(partial_.end(), piece + sizeof head, piece + sizeof head + head.size);
      if (head.hash != hash_of(head, partial_.data() + before)) return Got::damaged;
    }
    pass(extent);
    if (head.kind != last) continue;
    message.swap(partial_);
    partial_.clear();
    return Got::message;
  }
}

void RingReader::wait(std::chrono::milliseconds longest) {
  const std::uint32_t seen = ring_.to_reader.load(std::memory_order_acquire);
  if (ring_.written.load(std::memory_order_acquire) == position_) wait_on(ring_.to_reader, seen, longest);
}

void RingReader::end_wait() { wake(ring_.to_reader); }

void RingReader::answer(Bytes text) {
  const std::size_t size = std::min(text.size(), Ring::longest_answer);
  std::memcpy(ring_.answer, text.data(), size);
  ring_.answer_size.store(static_cast<std::uint32_t>(size), std::memory_order_release);
  ring_.answers.fetch_add(1, std::memory_order_release);
  wake(ring_.to_writer);
}

}  // namespace rehearse
