#include "fixed_message.h"

#include <bit>
#include <limits>
#include <utility>

namespace rehearse {
namespace {

constexpr std::uint64_t mark_head = 0x4141'4141ull << 32;  // of numbers that no message has
constexpr std::uint32_t stamp_mark = 0x0202'0202;

/// A finite number whose eight bytes tell its index, none of them 0.
double mark_of(std::size_t index) {
  std::uint64_t bits = mark_head;
  for (int digit = 0; digit < 4; ++digit, index >>= 7) bits |= (0x80 | (index & 0x7f)) << (8 * digit);
  return std::bit_cast<double>(bits);
}

/// The index of a mark; nullopt: the bytes are none.
std::optional<std::size_t> index_at(const std::byte* place) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, place, sizeof bits);
  std::size_t index = 0;
  for (int digit = 3; digit >= 0; --digit) index = index << 7 | (bits >> (8 * digit) & 0x7f);
  if (std::bit_cast<std::uint64_t>(mark_of(index)) != bits) return std::nullopt;
  return index;
}

}  // namespace

/// The places of the numbers are where two encodings differ.
std::optional<FixedMessage> FixedMessage::of(std::size_t count, const Encode& encode) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<double> numbers(count, 0.0);
  CdrWriter zeros, marks;
  encode({}, numbers, zeros);
  for (std::size_t i = 0; i < count; ++i) numbers[i] = mark_of(i);
  encode({stamp_mark, stamp_mark}, numbers, marks);
  const mcap::Bytes blank = zeros.bytes(), marked = marks.bytes();
  if (blank.size() != marked.size()) return std::nullopt;

  FixedMessage message;
  message.bytes_.assign(blank.begin(), blank.end());
  message.places_.assign(count, none);
  message.set_stamp({stamp_mark, stamp_mark});
  std::size_t found = 0;
  for (std::size_t at = 0; at < marked.size(); ++at) {
    if (message.bytes_[at] == marked[at]) continue;
    const auto index = at + sizeof(double) <= marked.size() ? index_at(&marked[at]) : std::nullopt;
    if (!index || *index >= count || message.places_[*index] != none) return std::nullopt;
    message.places_[*index] = static_cast<std::uint32_t>(at);
    at += sizeof(double) - 1;
    ++found;
  }
  if (found != count) return std::nullopt;
  return message;
}

FixedMessage joint_message(const std::vector<std::string>& names, const std::vector<JointElement>& places) {
  msg::JointState message;
  message.name = names;
  for (const JointElement& place : places)
    (message.*place.array).assign(names.size(), std::numeric_limits<double>::quiet_NaN());
  auto fixed =
      FixedMessage::of(places.size(), [&](const msg::Time& stamp, std::span<const double> numbers, CdrWriter& cdr) {
        message.header.stamp = stamp;
        for (std::size_t i = 0; i < numbers.size(); ++i) (message.*places[i].array)[places[i].index] = numbers[i];
        msg::encode(message, cdr);
      });
  REHEARSE_ASSERT(fixed, "the numbers of joints are float64");
  return *std::move(fixed);
}

FixedMessage fixed_numbers(ChannelKind kind, const std::string& frame) {
  auto fixed = FixedMessage::of(elements_of(kind).size(),
                                [&](const msg::Time& stamp, std::span<const double> numbers, CdrWriter& cdr) {
                                  form_of(kind).numbers->encode({stamp, frame}, numbers, cdr);
                                });
  REHEARSE_ASSERT(fixed, "the numbers of such a kind are float64");
  return *std::move(fixed);
}

}  // namespace rehearse
