#include "ground_beam.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rehearse {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A coordinate of the beam's points in cells, and the next distance at which it is a whole number.
class Crossings {
 public:
  /// The coordinate is start + rate * distance.
  Crossings(double start, double rate, double first) : start_(start), rate_(rate) {
    if (rate == 0.0) return;
    const double at_first = start + rate * first;
    line_ = rate > 0.0 ? std::floor(at_first) + 1.0 : std::ceil(at_first) - 1.0;
    compute();
  }

  double next() const { return next_; }
  void pass() {
    line_ += rate_ > 0.0 ? 1.0 : -1.0;
    compute();
  }

 private:
  void compute() { next_ = (line_ - start_) / rate_; }

  double start_, rate_;
  double line_ = 0.0;
  double next_ = unlimited;
};

/// Height of the surface at a point in cells from the first column and row.
double height_at(const Heightmap& map, const Vector2d& cells) {
  const auto part = [](double value, int points) {
    const double whole = std::clamp(std::floor(value), 0.0, static_cast<double>(points - 2));
    return std::pair(static_cast<int>(whole), value - whole);
  };
  const auto [column, x] = part(cells.x(), map.columns);
  const auto [row, y] = part(cells.y(), map.rows);
  const auto height = [&map](int at_column, int at_row) { return map.point(at_column, at_row).z(); };
  const double across = height(column + 1, row), along = height(column, row + 1);
  if (x + y <= 1.0) {
    const double corner = height(column, row);
    return corner + x * (across - corner) + y * (along - corner);
  }
  const double corner = height(column + 1, row + 1);
  return corner + (1.0 - x) * (along - corner) + (1.0 - y) * (across - corner);
}

}  // namespace

double beam_to_ground(const Heightmap& map, const Vector3d& from, const Vector3d& direction, double length) {
  const Vector2d start((from.x() + 0.5 * map.size.x()) / map.cell().x(),
                       (0.5 * map.size.y() - from.y()) / map.cell().y());
  const Vector2d rate(direction.x() / map.cell().x(), -direction.y() / map.cell().y());
  double first = 0.0, last = length;
  for (const auto& [axis, points] : {std::pair(0, map.columns), std::pair(1, map.rows)}) {
    const double most = points - 1;
    if (rate[axis] == 0.0 && (start[axis] < 0.0 || start[axis] > most)) return unlimited;
    if (rate[axis] == 0.0) continue;
    const double a = -start[axis] / rate[axis], b = (most - start[axis]) / rate[axis];
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  if (first > last) return unlimited;
  // between two crossings of the edges of triangles both the beam and the surface are straight
  std::array<Crossings, 3> edges{Crossings(start.x(), rate.x(), first), Crossings(start.y(), rate.y(), first),
                                 Crossings(start.x() + start.y(), rate.x() + rate.y(), first)};
  const auto clearance = [&](double distance) {
    return from.z() + distance * direction.z() - height_at(map, start + distance * rate);
  };
  double before = clearance(first);
  while (first < last) {
    Crossings& edge =
        *std::ranges::min_element(edges, [](const Crossings& a, const Crossings& b) { return a.next() < b.next(); });
    const double end = std::min(edge.next(), last);
    const double after = clearance(end);
    if ((before > 0.0) != (after > 0.0)) return first + (end - first) * before / (before - after);
    edge.pass();
    first = std::max(first, end);
    if (end >= last) break;
    before = after;
  }
  return unlimited;
}

}  // namespace rehearse
