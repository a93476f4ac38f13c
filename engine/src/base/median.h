// The median of numbers: of an even count, the upper one of the two in the middle.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace rehearse {

/// There has to be a number, and none may be NaN.
template <class Number>
Number upper_median(std::vector<Number> numbers) {
  const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  return *middle;
}

}  // namespace rehearse
