// Limits of numbers in files.
#pragma once

#include <string>
#include <string_view>

namespace rehearse {

/// The range of valid numbers.
struct Range {
  double low;
  double high;
  std::string_view unit = "";  // "[m]"; empty: none
  bool open_low = false;       // low itself is invalid
  bool open_high = false;      // high itself is invalid

  bool contains(double value) const;
  /// "above 0 and at most 86400 [s]"
  std::string text() const;
};

}  // namespace rehearse
