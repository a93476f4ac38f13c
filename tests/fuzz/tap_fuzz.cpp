// For any bytes in the place of a tap's ring, the reader returns ticks of the series that it has read, or an error, and
// never crashes or hangs. The input: a byte of flags, the length of the definitions in two bytes, the definitions, and
// the words of the ring. Flags: 1: the first record gets its size and its hash; 2: the definitions get their hash; 4:
// the head gets its hash; 8: bytes behind the definitions replace the head, 16 of them before the words.
#include <rehearse/tap_ring.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <span>

#include "logs/flight/tap_ring.h"

using namespace rehearse;

namespace {

constexpr std::size_t ring_words = 2048;

struct Memory {
  alignas(64) std::byte bytes[tap_words_place + ring_words * 8];
};
Memory memory;

void require(bool holds) {
  if (!holds) std::abort();
}

std::span<const std::uint8_t> take(std::span<const std::uint8_t>& input, std::size_t count) {
  const auto part = input.first(std::min(count, input.size()));
  input = input.subspan(part.size());
  return part;
}

void check(const TapTick& tick, const TapDefinitions& definitions) {
  require(tick.tick >= 0);
  for (const TapEntry& entry : tick.entries) {
    // reads all of it
    require(std::ranges::count_if(entry.numbers, [](double number) { return number == number; }) <=
            std::ssize(entry.numbers));
    require(std::ranges::count(entry.text, 'x') <= std::ssize(entry.text));
    if (entry.kind == tap_values) require(entry.numbers.size() == definitions.series.at(entry.series).numbers);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span<const std::uint8_t> input(data, size);
  if (input.size() < 3) return 0;
  const std::uint8_t flags = input[0];
  const std::size_t length = input[1] | input[2] << 8;
  input = input.subspan(3);
  auto* const head = reinterpret_cast<tap_ring_head*>(memory.bytes);
  auto* const words = reinterpret_cast<std::uint64_t*>(memory.bytes + tap_words_place);
  *head = {};
  head->magic = TAP_MAGIC;
  head->version = TAP_VERSION;
  head->head_size = sizeof *head;
  head->words = ring_words;
  head->time_step = 0.001;
  head->seconds = 60;
  const auto text = take(input, length);
  std::memcpy(memory.bytes + tap_definitions_place, text.data(), text.size());
  head->definitions_size = text.size();
  if (flags & 2) {
    std::uint64_t hash = text.size();
    for (std::size_t i = 0; i < text.size(); i += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, text.data() + i, std::min<std::size_t>(8, text.size() - i));
      hash = tap_mix(hash, word);
    }
    head->definitions_hash = hash;
  }
  if (flags & 8) {
    const auto other = take(input, 16);
    if (other.size() == 16) std::memcpy(memory.bytes + other[0] % 200 * 8, other.data() + 8, 8);
  }
  if (flags & 4) {
    std::uint64_t all[offsetof(tap_ring_head, hash) / 8 - 1];
    std::memcpy(all, memory.bytes + 8, sizeof all);
    head->hash = tap_hash(all, std::size(all));
  }
  const auto bytes = take(input, ring_words * 8);
  std::memset(words, 0, ring_words * 8);
  std::memcpy(words, bytes.data(), bytes.size());
  const std::uint64_t count = (bytes.size() + 7) / 8;
  if ((flags & 1) && count >= tap_record_head_words) {
    words[0] = count;
    words[2] = tap_record_hash(words, count);
  }
  if (head->written == 0) head->written = count;
  const auto ring = TapRing::of_memory(memory.bytes, "fuzz");
  if (!ring) {
    require(!ring.errors()[0].message.empty());
    return 0;
  }
  require((*ring)->controller().size() < 128);
  const auto definitions = (*ring)->definitions();
  if (!definitions) return 0;
  TapTick tick;
  for (int i = 0; i < 10'000; ++i) {
    const TapRing::Got got = (*ring)->take(*definitions, tick);
    if (got == TapRing::Got::nothing) return 0;
    if (got == TapRing::Got::tick) check(tick, *definitions);
  }
  std::abort();  // a ring of this size has fewer records
}
