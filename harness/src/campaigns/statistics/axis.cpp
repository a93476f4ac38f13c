#include "axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rehearse {
namespace {

constexpr std::size_t parts = 4;  // of a range, in cells

std::size_t cells_of_parameter(const CaseTable& table, std::size_t parameter) {
  return table.words[parameter].empty() ? parts : table.words[parameter].size();
}

std::size_t cell_of(const CaseTable& table, std::size_t parameter, const Axis& axis, double value) {
  if (!table.words[parameter].empty()) return static_cast<std::size_t>(value);
  return std::min(parts - 1, static_cast<std::size_t>(axis.share(value) * static_cast<double>(parts)));
}

}  // namespace

Axis::Axis(const std::vector<double>& values, bool is_logarithmic) {
  bool any = false;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low_ = any ? std::min(low_, value) : value;
    high_ = any ? std::max(high_, value) : value;
    any = true;
  }
  is_logarithmic_ = is_logarithmic && low_ > 0.0;
}

Axis Axis::of_parameter(const CaseTable& table, std::size_t parameter) {
  return Axis(table.values[parameter], table.logarithmic[parameter]);
}

double Axis::share(double value) const {
  if (!(high_ > low_)) return 0.5;
  return is_logarithmic_ ? std::log(value / low_) / std::log(high_ / low_) : (value - low_) / (high_ - low_);
}

double Axis::at(double share) const {
  return is_logarithmic_ ? low_ * std::pow(high_ / low_, share) : low_ + (high_ - low_) * share;
}

std::string short_number(double value) { return fmt::format("{:.4g}", value); }

CellGrid::CellGrid(const CaseTable& table, std::size_t a, std::size_t b)
    : columns(cells_of_parameter(table, a)), rows(cells_of_parameter(table, b)), counts(columns * rows) {
  const Axis x = Axis::of_parameter(table, a), y = Axis::of_parameter(table, b);
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table.has(i))
      ++counts[cell_of(table, b, y, table.values[b][i]) * columns + cell_of(table, a, x, table.values[a][i])];
}

std::string cell_text(const CaseTable& table, std::size_t parameter, std::size_t cell) {
  if (!table.words[parameter].empty()) return table.words[parameter][cell];
  const Axis axis = Axis::of_parameter(table, parameter);
  const auto end = [&](std::size_t at) { return axis.at(static_cast<double>(at) / static_cast<double>(parts)); };
  return fmt::format("{} to {}", short_number(end(cell)), short_number(end(cell + 1)));
}

}  // namespace rehearse
