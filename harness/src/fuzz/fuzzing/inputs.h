// Inputs: the values of a run's inputs, a row for each tick. Internal.
#pragma once

#include <rehearse/fuzz.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace rehearse {

/// One number that a controller reads in each tick.
struct InputColumn {
  std::string name;       // "SHOULDER/q", or "Imu/3": the fourth value of a device
  std::string statement;  // of a bench: "joint(\"SHOULDER\").q"
  int joint = -1;         // id; -1: of a device
  FuzzRange::Quantity quantity = FuzzRange::Quantity::q;
  int device = -1, element = 0;
  double low = 0.0, high = 0.0;
  double start = 0.0;  // in runs that leave it alone

  double clamped(double value) const { return std::min(high, std::max(low, value)); }
  /// True if values of the other column have the same meaning.
  bool is_like(const InputColumn& other) const {
    return (joint >= 0) == (other.joint >= 0) && (joint < 0 || quantity == other.quantity);
  }
};

struct Inputs {
  std::size_t columns = 0;
  std::vector<double> values;  // of the first tick, of the second one, ...

  int ticks() const { return columns == 0 ? 0 : static_cast<int>(values.size() / columns); }
  double& at(int tick, std::size_t column) { return values[static_cast<std::size_t>(tick) * columns + column]; }
  double at(int tick, std::size_t column) const { return values[static_cast<std::size_t>(tick) * columns + column]; }
  friend bool operator==(const Inputs& a, const Inputs& b) { return a.columns == b.columns && a.values == b.values; }
};

/// All columns at their starts.
inline Inputs inputs_at_start(const std::vector<InputColumn>& columns, int ticks) {
  Inputs inputs{columns.size(), {}};
  for (int tick = 0; tick < ticks; ++tick)
    for (const InputColumn& column : columns) inputs.values.push_back(column.start);
  return inputs;
}

/// A value that begins at a tick.
struct InputChange {
  int tick = 0;
  std::size_t column = 0;
  double value = 0.0;
};

/// The changes that make the inputs; before its first change a column is at its start.
inline std::vector<InputChange> changes_of(const Inputs& inputs, const std::vector<InputColumn>& columns) {
  std::vector<InputChange> changes;
  for (int tick = 0; tick < inputs.ticks(); ++tick)
    for (std::size_t i = 0; i < columns.size(); ++i)
      if (const double before = tick == 0 ? columns[i].start : inputs.at(tick - 1, i); inputs.at(tick, i) != before)
        changes.push_back({tick, i, inputs.at(tick, i)});
  return changes;
}

}  // namespace rehearse
