// Cache of meshes: all models and worlds that use the same file at the same scale share one mesh in memory.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/model.h>

#include "convex_hull.h"
#include "mesh_file.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace rehearse {

struct SharedMesh {
  std::shared_ptr<const MeshData> data;
  std::vector<std::string> warnings;  // from reading the file; also returned when the mesh is already in memory
};

/// Like read_mesh(), but a mesh that is still in use isn't read again, unless the size or the modification time of its
/// file has changed. Keys are real paths, so files of the same name are different. May be called from any thread.
Result<SharedMesh> shared_mesh(const std::filesystem::path& file, const Eigen::Vector3d& scale,
                               const MeshSelection& selection = {});

/// The convex hulls of the mesh, as from judged_hulls() or, of contact `parts`, from convex_parts(); shared in the same
/// way.
Result<std::shared_ptr<const ConvexHulls>> shared_hulls(const std::filesystem::path& file, const Eigen::Vector3d& scale,
                                                        MeshContact contact, const MeshSelection& selection = {});

/// The number of meshes that this process has read from files.
std::uint64_t meshes_read();

}  // namespace rehearse
