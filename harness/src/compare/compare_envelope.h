// All that a golden is from a little before a message to a little after it: what a value may be that may come early or
// late. Internal.
#pragma once

#include <rehearse/trace.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace rehearse {

using Quaternion = std::array<double, 4>;  // x, y, z, w

double norm_of(const Quaternion& q);

/// The angle of the rotation from one to the other, 0 to pi [rad]. Their norms don't matter.
double angle_between(const Quaternion& a, const Quaternion& b);

/// The least and the greatest value of a column around each row. What isn't finite is no part of it.
class Envelope {
 public:
  /// Around a row: the rows whose times are from its own minus `lag` to its own plus `lead` [s]; its own always.
  Envelope(const TraceChannel& channel, std::size_t column, double lead, double lag);
  /// How far a value is outside of it; 0 within. NaN if the envelope is empty.
  double distance(std::size_t row, double value) const;

 private:
  std::vector<double> least_, greatest_;  // by row
};

/// The rows whose times are within lag before and lead after that of a row: first and one past the last.
std::pair<std::size_t, std::size_t> rows_around(const std::vector<std::uint64_t>& times, std::size_t row, double lead,
                                                double lag);

/// How far an orientation is from the path that the golden's takes over the rows around a row: straight on from each to
/// the next [rad].
double distance_from_path(const std::vector<std::uint64_t>& times, std::size_t row, double lead, double lag,
                          const std::function<Quaternion(std::size_t row)>& golden, const Quaternion& actual);

}  // namespace rehearse
