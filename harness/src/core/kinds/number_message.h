// Messages that are a header and a fixed number of numbers.
#pragma once

#include <array>
#include <cstddef>
#include <memory>

#include "kinds.h"
#include "rows.h"

namespace rehearse {

/// Places of the numbers of two vectors, in their order.
inline std::array<double*, 6> numbers_in(msg::Vector3& a, msg::Vector3& b) {
  return {&a.x, &a.y, &a.z, &b.x, &b.y, &b.z};
}

/// Places of the numbers of a pose or a transform.
template <class Position>
std::array<double*, 7> numbers_in(Position& p, msg::Quaternion& q) {
  return {&p.x, &p.y, &p.z, &q.x, &q.y, &q.z, &q.w};
}

/// `Places`: a function that returns an array of the places of a message's numbers, in the order of the elements.
template <class Message, auto Places>
inline constexpr NumberMessage number_message{
    .encode =
        [](const msg::Header& header, std::span<const double> numbers, CdrWriter& cdr) {
          Message message;
          message.header = header;
          const auto places = Places(message);
          REHEARSE_ASSERT(places.size() == numbers.size(), "a message has as many numbers as its kind has elements");
          for (std::size_t i = 0; i < places.size(); ++i) *places[i] = numbers[i];
          msg::encode(message, cdr);
        },
    .decode =
        [](mcap::Bytes bytes, std::vector<double>& numbers) {
          Message message;
          CdrReader reader(bytes);
          if (!msg::decode(reader, message)) return false;
          numbers.clear();
          for (const double* place : Places(message)) numbers.push_back(*place);
          return true;
        }};

/// The table of such messages: a column for each element of the kind.
template <class Message, auto Places, ChannelKind kind>
std::unique_ptr<RowReader> number_rows(TraceChannel& channel, const std::string&) {
  return rows_of<Message>(channel, [&elements = elements_of(kind)](Message& message, RowWriter& row) {
    const auto places = Places(message);
    for (std::size_t i = 0; i < places.size(); ++i) row.put(elements[i].name, *places[i]);
  });
}

/// Writes numbers under the names of the kind's elements, after a prefix.
inline void put_after(std::string& prefix, ChannelKind kind, std::span<double* const> places, RowWriter& row) {
  const std::size_t stem = prefix.size();
  const std::vector<ChannelElement>& elements = elements_of(kind);
  for (std::size_t i = 0; i < places.size(); ++i) {
    prefix.resize(stem);
    prefix += elements[i].name;
    row.put(prefix, *places[i]);
  }
}

}  // namespace rehearse
