#include "closed_surface.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cstddef>
#include <map>
#include <tuple>
#include <utility>

namespace rehearse {
namespace {

/// The surface of one object, which consists of consecutive parts.
class ObjectSurface {
 public:
  void add(const MeshPart& part) {
    std::vector<int> places;
    for (const Eigen::Vector3f& vertex : part.vertices) places.push_back(place_of(vertex));
    for (const auto& [a, b, c] : part.triangles) {
      const Eigen::Vector3d p = part.vertices[a].cast<double>();
      volume_ += p.dot(part.vertices[b].cast<double>().cross(part.vertices[c].cast<double>()));
      for (const auto& [from, to] :
           {std::pair(places[a], places[b]), std::pair(places[b], places[c]), std::pair(places[c], places[a])}) {
        if (from != to) edges_.push_back({std::min(from, to), std::max(from, to), from < to ? 1 : -1});
      }
    }
  }

  bool is_closed() {
    std::ranges::sort(
        edges_, [](const Edge& a, const Edge& b) { return std::tie(a.lower, a.upper) < std::tie(b.lower, b.upper); });
    for (std::size_t i = 0; i < edges_.size();) {
      const Edge first = edges_[i];
      int open = 0;
      for (; i < edges_.size() && edges_[i].lower == first.lower && edges_[i].upper == first.upper; ++i)
        open += edges_[i].direction;
      if (open != 0) return false;
    }
    return volume_ > 0.0;
  }

 private:
  struct Edge {
    int lower, upper;  // numbers of positions
    int direction;     // 1: from the lower to the upper position
  };

  int place_of(const Eigen::Vector3f& vertex) {
    const auto number = static_cast<int>(places_.size());
    return places_.try_emplace({vertex.x(), vertex.y(), vertex.z()}, number).first->second;
  }

  std::map<std::tuple<float, float, float>, int> places_;
  std::vector<Edge> edges_;
  double volume_ = 0.0;  // times six [m³]
};

}  // namespace

std::vector<bool> closed_parts(const MeshData& mesh) {
  std::vector<bool> closed;
  for (auto first = mesh.parts.begin(); first != mesh.parts.end();) {
    ObjectSurface surface;
    auto part = first;
    for (; part != mesh.parts.end() && part->object == first->object; ++part) surface.add(*part);
    closed.resize(static_cast<std::size_t>(part - mesh.parts.begin()), surface.is_closed());
    first = part;
  }
  return closed;
}

}  // namespace rehearse
