#include "shape_bounds.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

/// Half the extents of a shape with the orientation `axes`, about its centre.
struct HalfExtents {
  const Eigen::Matrix3d& axes;

  Vector3d operator()(const Box& box) const { return axes.cwiseAbs() * box.size / 2.0; }
  Vector3d operator()(const Sphere& sphere) const { return Vector3d::Constant(sphere.radius); }
  /// A disk perpendicular to the unit vector z reaches r sqrt(1 - z_i²) along axis i.
  Vector3d operator()(const Cylinder& cylinder) const {
    const Vector3d along = axes.col(2).cwiseAbs();
    const Vector3d across = (1.0 - along.array().square()).max(0.0).sqrt();
    return cylinder.length / 2.0 * along + cylinder.radius * across;
  }
  Vector3d operator()(const Capsule& capsule) const {
    return capsule.length / 2.0 * axes.col(2).cwiseAbs() + Vector3d::Constant(capsule.radius);
  }
  Vector3d operator()(const Mesh& mesh) const { return (*this)(Box{mesh.data->upper - mesh.data->lower}); }
};

}  // namespace

Eigen::AlignedBox3d bounds(const Geometry& geometry, const Eigen::Isometry3d& pose) {
  Vector3d center = pose.translation();
  if (const auto* mesh = std::get_if<Mesh>(&geometry)) {
    if (mesh->data == nullptr) return {};
    center = pose * Vector3d((mesh->data->lower + mesh->data->upper) / 2.0);
  }
  const Eigen::Matrix3d axes = pose.linear();
  const Vector3d half = std::visit(HalfExtents{axes}, geometry);
  return {Vector3d(center - half), Vector3d(center + half)};
}

}  // namespace rehearse
