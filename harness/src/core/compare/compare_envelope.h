// The values of a golden shortly before and after a message: the range for a value that may come early or late.
// Internal.
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

/// The angle of the rotation from a to b, 0 to pi [rad]. The norms of a and b have no influence.
double angle_between(const Quaternion& a, const Quaternion& b);

/// The least and the greatest value of a column around each row. Numbers that aren't finite are left out.
class Envelope {
 public:
  /// The rows around a row have times from its time minus `lag` to its time plus `lead` [s], and include the row
  /// itself.
  Envelope(const TraceChannel& channel, std::size_t column, double lead, double lag);
  /// The distance of a value from the envelope; 0 within it. NaN if the envelope is empty.
  double distance(std::size_t row, double value) const;

 private:
  std::vector<double> least_, greatest_;  // by row
};

/// The rows whose times are within lag before and lead after that of a row: first and one past the last.
std::pair<std::size_t, std::size_t> rows_around(const std::vector<std::uint64_t>& times, std::size_t row, double lead,
                                                double lag);

/// The angle between an orientation and the golden's path over the rows around a row [rad]. The path is the shortest
/// rotation from each of these rows to the next.
double distance_from_path(const std::vector<std::uint64_t>& times, std::size_t row, double lead, double lag,
                          const std::function<Quaternion(std::size_t row)>& golden, const Quaternion& actual);

}  // namespace rehearse
