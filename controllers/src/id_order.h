// The order of joint ids in a list of joints.
#pragma once

#include <cnoid/Link>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace cnoid {

/// The place in the list of the joint at this place in the order of ids. Throws std::out_of_range.
inline int placeInIdOrder(const std::vector<LinkPtr>& joints, int index) {
  std::vector<int> order(joints.size());
  std::iota(order.begin(), order.end(), 0);
  const auto id = [&joints](int place) { return joints[static_cast<std::size_t>(place)]->jointId(); };
  std::stable_sort(order.begin(), order.end(), [&id](int a, int b) { return id(a) < id(b); });
  return order.at(static_cast<std::size_t>(index));
}

}  // namespace cnoid
