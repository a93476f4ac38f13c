#include "compare_envelope.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

namespace rehearse {
namespace {

double dot(const Quaternion& a, const Quaternion& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]; }

Quaternion scaled(const Quaternion& q, double factor) {
  return {factor * q[0], factor * q[1], factor * q[2], factor * q[3]};
}

Quaternion plus(const Quaternion& a, const Quaternion& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]};
}

/// The angle from q to the nearest orientation on the shortest rotation from `from` to `to` [rad].
double distance_from_turn(const Quaternion& from, Quaternion to, Quaternion q) {
  const double at_ends = std::fmin(angle_between(from, q), angle_between(to, q));
  if (dot(from, to) < 0.0) to = scaled(to, -1.0);
  const Quaternion across = plus(to, scaled(from, -dot(from, to) / dot(from, from)));
  if (!(norm_of(across) > 0.0)) return at_ends;
  // in the plane of `from` and `to`: the angle along the rotation; then the part of q outside the plane
  const Quaternion x = scaled(from, 1.0 / norm_of(from)), y = scaled(across, 1.0 / norm_of(across));
  if (dot(x, q) < 0.0) q = scaled(q, -1.0);
  const double along = std::atan2(dot(y, q), dot(x, q)), all = std::atan2(dot(y, to), dot(x, to));
  if (along <= 0.0 || along >= all) return at_ends;
  const double in_plane = std::hypot(dot(x, q), dot(y, q));
  const Quaternion off = plus(q, plus(scaled(x, -dot(x, q)), scaled(y, -dot(y, q))));
  return 2.0 * std::atan2(norm_of(off), in_plane);
}

}  // namespace

double norm_of(const Quaternion& q) { return std::sqrt(dot(q, q)); }

double angle_between(const Quaternion& a, const Quaternion& b) {
  const double w = a[3] * b[3] + a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const double x = a[3] * b[0] - b[3] * a[0] - (a[1] * b[2] - a[2] * b[1]);
  const double y = a[3] * b[1] - b[3] * a[1] - (a[2] * b[0] - a[0] * b[2]);
  const double z = a[3] * b[2] - b[3] * a[2] - (a[0] * b[1] - a[1] * b[0]);
  return 2.0 * std::atan2(std::sqrt(x * x + y * y + z * z), std::abs(w));
}

std::pair<std::size_t, std::size_t> rows_around(const std::vector<std::uint64_t>& times, std::size_t row, double lead,
                                                double lag) {
  const auto nanoseconds = [](double seconds) { return static_cast<std::uint64_t>(std::llround(seconds * 1e9)); };
  const std::uint64_t now = times[row], before = nanoseconds(lag);
  const auto first = std::lower_bound(times.begin(), times.end(), now - std::min(now, before));
  const auto last = std::ranges::upper_bound(times, now + nanoseconds(lead));
  return {static_cast<std::size_t>(first - times.begin()), static_cast<std::size_t>(last - times.begin())};
}

Envelope::Envelope(const TraceChannel& channel, std::size_t column, double lead, double lag) {
  const std::size_t rows = channel.rows();
  least_.assign(rows, std::numeric_limits<double>::infinity());
  greatest_.assign(rows, -std::numeric_limits<double>::infinity());
  // rows that may still be the least (greatest) of a later span, by ascending (descending) value
  std::deque<std::size_t> low, high;
  std::size_t entered = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    const auto [first, end] = rows_around(channel.times, row, lead, lag);
    for (; entered < end; ++entered) {
      const double value = channel.number(entered, column);
      if (!std::isfinite(value)) continue;
      while (!low.empty() && channel.number(low.back(), column) >= value) low.pop_back();
      while (!high.empty() && channel.number(high.back(), column) <= value) high.pop_back();
      low.push_back(entered);
      high.push_back(entered);
    }
    while (!low.empty() && low.front() < first) low.pop_front();
    while (!high.empty() && high.front() < first) high.pop_front();
    if (low.empty()) continue;
    least_[row] = channel.number(low.front(), column);
    greatest_[row] = channel.number(high.front(), column);
  }
}

double Envelope::distance(std::size_t row, double value) const {
  if (least_[row] > greatest_[row]) return std::numeric_limits<double>::quiet_NaN();
  return std::max({least_[row] - value, value - greatest_[row], 0.0});
}

double distance_from_path(const std::vector<std::uint64_t>& times, std::size_t row, double lead, double lag,
                          const std::function<Quaternion(std::size_t row)>& golden, const Quaternion& actual) {
  const auto [first, end] = rows_around(times, row, lead, lag);
  double least = angle_between(golden(first), actual);
  for (std::size_t next = first + 1; next < end; ++next)
    least = std::fmin(least, distance_from_turn(golden(next - 1), golden(next), actual));
  return least;
}

}  // namespace rehearse
