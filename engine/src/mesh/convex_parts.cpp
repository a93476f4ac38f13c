#include "convex_parts.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "slow_mesh.h"
#include "triangle_soup.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

constexpr int coarse_cells = 12;            // along the longest side of a piece, to compare cuts
constexpr int hull_cells = 24;              // likewise, to estimate the volume of its hull
constexpr std::size_t fine_vertices = 200;  // of a piece whose cuts are compared without coarsening it
constexpr std::size_t concave_planes = 8;   // of a piece's faces, which are tried as cuts
constexpr int cuts_across = 3;              // planes across each axis, which are tried as cuts
constexpr std::size_t max_separate = 6;     // parts of a side that a cut leaves unconnected, which become pieces
constexpr double least_gain = 0.01;         // of a cut: share of the object's hull that it empties
constexpr double worthwhile = 0.1;          // of a cut: share of the piece's surplus; else the piece is halved

/// The cut of a piece with the largest gain.
struct BestCut {
  CutPlane plane;
  double gain = 0.0;  // volume that both hulls together fill less [m³]
};

/// A part of an object.
struct Piece {
  TriangleSoup solid;
  double hull = 0.0;     // volume of its convex hull, approximate for a fine solid [m³]
  double surplus = 0.0;  // volume of the hull outside the solid; if the object isn't closed: that a cut empties [m³]
  BestCut best;          // of an object that isn't closed
};

/// Two points nearer to a cut than this are in it.
double tolerance_of(const TriangleSoup& soup) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& vertex : soup.vertices) box.extend(vertex);
  return 1e-6 * box.sizes().norm();
}

/// The planes of faces at concave edges, those with the largest sum of edge length times angle first.
std::vector<CutPlane> planes_at_concave_edges(const TriangleSoup& soup) {
  struct Face {
    Vector3d normal;
    int opposite;
  };
  std::map<std::pair<int, int>, Face> faces;  // by directed edge: the triangle on its left
  const auto at = [&soup](int vertex) -> const Vector3d& { return soup.vertices[static_cast<std::size_t>(vertex)]; };
  for (const std::array<int, 3>& t : soup.triangles) {
    const Vector3d normal = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).stableNormalized();
    for (std::size_t i = 0; i < 3; ++i) faces[{t[i], t[(i + 1) % 3]}] = {normal, t[(i + 2) % 3]};
  }
  Eigen::AlignedBox3d box;
  for (const Vector3d& vertex : soup.vertices) box.extend(vertex);
  const double rounding = 0.005;  // of normals, and of offsets as a share of the size
  const double size = std::max(box.sizes().norm(), std::numeric_limits<double>::min());
  std::map<std::array<long, 4>, std::pair<double, CutPlane>> weights;
  for (const auto& [edge, face] : faces) {
    const auto other = faces.find({edge.second, edge.first});
    if (other == faces.end() || edge.first > edge.second) continue;
    const double rise = face.normal.dot(at(other->second.opposite) - at(edge.first));
    const double sine = face.normal.cross(other->second.normal).norm();
    constexpr double least_sine = 0.1;
    if (rise <= 1e-4 * size || sine < least_sine) continue;
    for (const Vector3d& normal : {face.normal, other->second.normal}) {
      const CutPlane plane{normal, normal.dot(at(edge.first))};
      const std::array<long, 4> key{std::lround(normal.x() / rounding), std::lround(normal.y() / rounding),
                                    std::lround(normal.z() / rounding),
                                    std::lround((plane.offset - normal.dot(box.center())) / (rounding * size))};
      auto& [weight, first] = weights.emplace(key, std::pair(0.0, plane)).first->second;
      weight += sine * (at(edge.second) - at(edge.first)).norm();
    }
  }
  std::vector<std::pair<double, CutPlane>> sorted;
  for (const auto& [key, weighted] : weights) sorted.push_back(weighted);
  std::ranges::stable_sort(sorted, [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<CutPlane> planes;
  for (std::size_t i = 0; i < std::min(concave_planes, sorted.size()); ++i) planes.push_back(sorted[i].second);
  return planes;
}

/// Planes across the axes, evenly spaced.
std::vector<CutPlane> planes_across(const TriangleSoup& soup) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& vertex : soup.vertices) box.extend(vertex);
  std::vector<CutPlane> planes;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 1; i <= cuts_across; ++i)
      planes.push_back({Vector3d::Unit(axis), box.min()[axis] + i * box.sizes()[axis] / (cuts_across + 1)});
  return planes;
}

BestCut best_cut(const TriangleSoup& solid) {
  const TriangleSoup tried = solid.vertices.size() > fine_vertices ? coarsened(solid, coarse_cells) : solid;
  const double whole = hull_volume(tried.vertices), tolerance = tolerance_of(tried);
  BestCut best;
  std::vector<CutPlane> planes = planes_at_concave_edges(tried);
  const std::vector<CutPlane> across = planes_across(tried);
  planes.insert(planes.end(), across.begin(), across.end());
  for (const CutPlane& plane : planes) {
    const auto [behind, ahead] = cut(tried, plane, tolerance);
    if (behind.triangles.empty() || ahead.triangles.empty()) continue;
    double gain = whole;
    for (const TriangleSoup* side : {&behind, &ahead})
      for (const TriangleSoup& part : separate_parts(*side, max_separate)) gain -= hull_volume(part.vertices);
    if (gain > best.gain) best = {plane, gain};
  }
  return best;
}

/// Halves a solid across its longest side: two cuts may improve a solid that no single cut improves (a ring).
CutPlane middle_of(const TriangleSoup& solid) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& vertex : solid.vertices) box.extend(vertex);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  return {Vector3d::Unit(axis), box.center()[axis]};
}

/// The volumes of an object, which may have none, and of its hull.
struct Judgement {
  std::optional<double> volume;  // of the object [m³]; nullopt: it isn't closed
  double hull = 0.0;             // [m³]

  std::optional<double> excess() const { return volume ? std::optional(hull / *volume - 1.0) : std::nullopt; }
};

/// `hull`: the volume of its convex hull, if it is known.
Judgement judge(const TriangleSoup& solid, std::optional<double> hull = std::nullopt) {
  Judgement judgement;
  judgement.hull = hull ? *hull : hull_volume(solid.vertices);
  const double inside = is_closed(solid) ? volume(solid) : 0.0;
  constexpr double thin = 1e-6, rounding = 1e-3;
  // objects that overlap themselves or are wound inwards have no volume either
  if (inside > thin * judgement.hull && inside < (1.0 + rounding) * judgement.hull) judgement.volume = inside;
  return judgement;
}

class Decomposer {
 public:
  Decomposer(TriangleSoup solid, const Judgement& judgement) : judgement_(judgement) { add(std::move(solid)); }

  std::vector<Piece> pieces() {
    while (pieces_.size() < max_convex_parts && !is_near()) {
      const auto worst =
          std::ranges::max_element(pieces_, [](const Piece& a, const Piece& b) { return a.surplus < b.surplus; });
      if (worst->surplus < least_gain * judgement_.hull) break;
      split(static_cast<std::size_t>(worst - pieces_.begin()));
    }
    return std::move(pieces_);
  }

 private:
  void add(TriangleSoup solid) {
    Piece piece;
    const bool is_fine = solid.vertices.size() > 8 * fine_vertices;
    piece.hull = hull_volume(is_fine ? coarsened(solid, hull_cells).vertices : solid.vertices);
    if (judgement_.volume) {
      piece.surplus = piece.hull - volume(solid);
    } else {
      piece.best = best_cut(solid);
      piece.surplus = piece.best.gain;
    }
    piece.solid = std::move(solid);
    pieces_.push_back(std::move(piece));
  }

  /// Replaces a piece by both sides of a cut. If nothing cuts it, it isn't tried again.
  void split(std::size_t index) {
    const TriangleSoup& solid = pieces_[index].solid;
    BestCut best = judgement_.volume ? best_cut(solid) : pieces_[index].best;
    if (best.gain < worthwhile * pieces_[index].surplus) best.plane = middle_of(solid);
    auto [behind, ahead] = cut(solid, best.plane, tolerance_of(solid));
    if (behind.triangles.empty() || ahead.triangles.empty()) {
      pieces_[index].surplus = 0.0;
      return;
    }
    pieces_.erase(pieces_.begin() + static_cast<std::ptrdiff_t>(index));
    for (const TriangleSoup* side : {&behind, &ahead}) {
      const std::size_t room = max_convex_parts - std::min(max_convex_parts - 1, pieces_.size());
      for (TriangleSoup& part : separate_parts(*side, std::min(max_separate, room))) add(std::move(part));
    }
  }

  bool is_near() const {
    if (!judgement_.volume) return false;
    double hulls = 0.0;
    for (const Piece& piece : pieces_) hulls += piece.hull;
    return hulls <= (1.0 + tolerated_excess) * *judgement_.volume;
  }

  Judgement judgement_;
  std::vector<Piece> pieces_;
};

Diagnostic note(std::string message, std::string hint) {
  Diagnostic remark = error(std::move(message), std::move(hint));
  remark.severity = Severity::note;
  return remark;
}

constexpr const char* simpler = "take simple shapes for its collision, if that matters";

std::string excess_text(const std::string& object, const Judgement& judgement) {
  return judgement.volume ? fmt::format("{}has a convex hull that fills {:.3g} % more than its volume", object,
                                        100.0 * *judgement.excess())
                          : fmt::format("{}isn't closed, so that its volume is unknown", object);
}

std::string parts_text(const Judgement& judgement, std::size_t count, double hulls) {
  std::string filled = "overlap each other";
  if (judgement.volume)
    filled = fmt::format("fill {:.3g} % more than its volume", 100.0 * (hulls / *judgement.volume - 1.0));
  else if (hulls < judgement.hull)
    filled = fmt::format("fill {:.3g} % less than its convex hull", 100.0 * (1.0 - hulls / judgement.hull));
  return fmt::format("contact takes {} convex parts, which {}", count, filled);
}

/// The hulls of the convex parts of an object; none if one of them has no hull.
std::vector<ConvexHull> parts_of(const TriangleSoup& solid, const std::string& object, const Judgement& judgement) {
  std::vector<ConvexHull> hulls;
  const double flat = 1e-6 * judgement.hull;  // slivers beside a cut
  Diagnostics remarks;                        // about the thinning of parts; the note of all parts has the figure
  for (const Piece& piece : Decomposer(solid, judgement).pieces()) {
    if (piece.hull <= flat) continue;
    auto hull = convex_hull(piece.solid.vertices, object, remarks);
    if (!hull) return {};
    hulls.push_back(*std::move(hull));
  }
  return hulls;
}

/// Adds the convex parts of an object, and a note. False: it has no more than one.
bool add_parts(const TriangleSoup& solid, const std::string& object, const Judgement& judgement, ConvexHulls& result) {
  std::vector<ConvexHull> hulls = parts_of(solid, object, judgement);
  if (hulls.size() < 2) return false;
  double filled = 0.0;
  for (const ConvexHull& hull : hulls) filled += volume(hull);
  result.remarks.push_back(
      note(excess_text(object, judgement) + ": " + parts_text(judgement, hulls.size(), filled), simpler));
  std::move(hulls.begin(), hulls.end(), std::back_inserter(result.hulls));
  return true;
}

std::size_t triangles_of(const MeshData& mesh, int object) {
  std::size_t count = 0;
  for (const MeshPart& part : mesh.parts)
    if (part.object == object) count += part.triangles.size();
  return count;
}

}  // namespace

bool is_convex(const MeshData& mesh, double excess) {
  for (const auto& [number, name] : objects_of(mesh)) {
    const auto beyond = judge(object_of(mesh, number)).excess();
    if (!beyond || *beyond > excess) return false;
  }
  return true;
}

Result<ConvexHulls> judged_hulls(const MeshData& mesh) {
  std::map<int, double> volumes;
  Result<ConvexHulls> hulls = convex_hulls(mesh, &volumes);
  if (!hulls) return hulls;
  for (const auto& [number, name] : objects_of(mesh)) {
    const TriangleSoup solid = object_of(mesh, number);
    const auto known = volumes.find(number);
    // a triangle that is left out may have vertices of its own
    const bool is_whole = solid.triangles.size() == triangles_of(mesh, number);
    const Judgement judgement =
        judge(solid, known != volumes.end() && is_whole ? std::optional(known->second) : std::nullopt);
    if (judgement.volume && *judgement.excess() > tolerated_excess)
      hulls->remarks.push_back(note(excess_text(name, judgement), "collision: parts takes convex parts of it"));
  }
  return hulls;
}

Result<ConvexHulls> convex_parts(const MeshData& mesh) {
  ConvexHulls result;
  for (const auto& [number, name] : objects_of(mesh)) {
    TriangleSoup solid = object_of(mesh, number);
    const Judgement judgement = judge(solid);
    const bool is_hull = judgement.hull <= 0.0 || (judgement.volume && *judgement.excess() <= tolerated_excess);
    if (!is_hull && add_parts(solid, name, judgement, result)) continue;
    auto hull = REHEARSE_TRY(convex_hull(std::move(solid.vertices), name, result.remarks));
    result.hulls.push_back(std::move(hull));
  }
  if (result.hulls.empty()) return error("it has no triangles");
  return result;
}

namespace {

constexpr std::size_t quick_triangles = 500;   // a hull of so many takes a millisecond
constexpr std::size_t slow_triangles = 50000;  // a hull of so many takes a second

void tell_of_slow(const MeshData& mesh, MeshContact contact, const HullStore& store) {
  const std::size_t triangles = mesh.triangle_count();
  if (triangles < slow_triangles) return;
  const std::string name = mesh.file.empty() ? "a mesh" : std::filesystem::path(mesh.file).filename().string();
  tell_slow_mesh(fmt::format("{} has {} triangles: its {} are computed{}", name, triangles,
                             contact == MeshContact::parts ? "convex parts" : "convex hulls",
                             store.is_kept() ? " and kept for later runs" : ""));
}

}  // namespace

Result<ConvexHulls> contact_hulls(const MeshData& mesh, MeshContact contact, const HullStore& store) {
  if (auto kept = store.find(mesh, contact)) return *std::move(kept);
  tell_of_slow(mesh, contact, store);
  Result<ConvexHulls> made = contact == MeshContact::parts ? convex_parts(mesh) : judged_hulls(mesh);
  if (!made) return made;
  const bool has_parts = made->hulls.size() > objects_of(mesh).size();
  if (has_parts || mesh.triangle_count() > quick_triangles) store.keep(mesh, contact, *made);
  return made;
}

}  // namespace rehearse
