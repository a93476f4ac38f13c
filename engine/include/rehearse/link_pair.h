// LinkPair: two links that touch.
#pragma once

#include <compare>
#include <utility>

namespace rehearse {

/// The link of the earlier body comes first; of one body the earlier link.
struct LinkPair {
  int body = 0;  // index into the world's bodies
  int link = 0;  // index into its model's links
  int other_body = 0;
  int other_link = 0;

  static LinkPair of(int body, int link, int other_body, int other_link) {
    const bool in_order = std::pair(body, link) <= std::pair(other_body, other_link);
    return in_order ? LinkPair{body, link, other_body, other_link} : LinkPair{other_body, other_link, body, link};
  }
  auto operator<=>(const LinkPair&) const = default;
};

}  // namespace rehearse
