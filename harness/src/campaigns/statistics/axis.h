// The range of a parameter or a margin, for cells and pictures. Internal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "case_table.h"

namespace rehearse {

/// The range of the finite values of a column. Of a parameter with log_uniform it is divided logarithmically.
class Axis {
 public:
  explicit Axis(const std::vector<double>& values, bool is_logarithmic = false);
  static Axis of_parameter(const CaseTable& table, std::size_t parameter);

  double low() const { return low_; }
  double high() const { return high_; }
  /// The place of a value, 0 to 1.
  double share(double value) const;
  /// The value at a place, 0 to 1.
  double at(double share) const;

 private:
  double low_ = 0.0, high_ = 1.0;
  bool is_logarithmic_ = false;
};

/// With four digits.
std::string short_number(double value);

/// The values of two parameters in cells: four equal parts of the range that occurs, or the words of a choice.
struct CellGrid {
  CellGrid(const CaseTable& table, std::size_t a, std::size_t b);
  std::size_t columns = 0, rows = 0;
  std::vector<std::size_t> counts;  // cases with a result, by row (of `b`), then by column (of `a`)
};
/// A cell of a parameter: "0.2 to 0.4", or a word.
std::string cell_text(const CaseTable& table, std::size_t parameter, std::size_t cell);

}  // namespace rehearse
