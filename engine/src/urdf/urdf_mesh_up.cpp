// glTF files whose z is up, against their standard: their boxes fit those of the collision shapes only unturned.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "base/text.h"
#include "mesh/mesh_format.h"
#include "model/shape_bounds.h"
#include "urdf_draft.h"

namespace rehearse::urdf {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

const Mesh* gltf_mesh(const Shape& shape) {
  const auto* mesh = std::get_if<Mesh>(&shape.geometry);
  if (mesh == nullptr || mesh->data == nullptr) return nullptr;
  const Result<MeshFormat> format = mesh_format_of(mesh->file);
  return format && (*format == MeshFormat::gltf || *format == MeshFormat::glb) ? mesh : nullptr;
}

/// The box around a glTF mesh in its link's frame, as it would be without the turn of (x, y, z) to (x, -z, y).
AlignedBox3d unturned_bounds(const Mesh& mesh, const Eigen::Isometry3d& pose) {
  const AlignedBox3d turned(mesh.data->lower, mesh.data->upper);
  AlignedBox3d box;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d unscaled = turned.corner(static_cast<AlignedBox3d::CornerType>(corner)).cwiseQuotient(mesh.scale);
    box.extend(pose * Vector3d(mesh.scale.cwiseProduct(Vector3d(unscaled.x(), unscaled.z(), -unscaled.y()))));
  }
  return box;
}

/// The largest distance between the corners of two boxes, as a share of the second one's diagonal.
double distance(const AlignedBox3d& box, const AlignedBox3d& other) {
  return std::max((box.min() - other.min()).norm(), (box.max() - other.max()).norm()) / other.diagonal().norm();
}

bool fits_only_unturned(const Link& link) {
  constexpr double same = 0.1, different = 0.25;  // of the diagonal
  AlignedBox3d turned, unturned, touched;
  for (const Shape& visual : link.visuals) {
    const Mesh* mesh = gltf_mesh(visual);
    if (mesh == nullptr) return false;
    turned.extend(bounds(visual.geometry, visual.pose));
    unturned.extend(unturned_bounds(*mesh, visual.pose));
  }
  for (const Shape& collision : link.collisions) {
    if (gltf_mesh(collision) != nullptr) return false;  // it would be unturned as well
    touched.extend(bounds(collision.geometry, collision.pose));
  }
  if (turned.isEmpty() || touched.isEmpty() || touched.diagonal().norm() <= 0.0) return false;
  return distance(unturned, touched) < same && distance(turned, touched) > different;
}

}  // namespace

void check_mesh_up(const Model& model, const UrdfOptions& options, Findings& findings) {
  if (options.mesh_z_up) return;
  const Link* first = nullptr;
  int count = 0;
  for (const Link& link : model.links) {
    if (!fits_only_unturned(link)) continue;
    if (count++ == 0) first = &link;
  }
  if (first == nullptr) return;
  findings.warning(first->line,
                   fmt::format("the glTF meshes of link {}{} fit the collision shapes only if z is up in their files",
                               in_quotes(first->name), count > 1 ? fmt::format(" and {} more", count - 1) : ""),
                   "mesh_up: z of the body in a scenario, or --mesh-up z, takes z for up; by their standard y is up");
}

}  // namespace rehearse::urdf
