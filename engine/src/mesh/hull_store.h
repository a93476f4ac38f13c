// Files that keep computed convex hulls and parts: a robot of fine meshes takes minutes to compute, and a moment to
// read. Private to the engine.
#pragma once

#include <rehearse/model.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>

#include "convex_hull.h"

namespace rehearse {

/// Counts the changes of judged_hulls() and convex_parts() that alter their results; part of each key. A test compares
/// the hash of a decomposition with a stored hash, and fails if only one of the hash and this number changes.
inline constexpr std::uint64_t hulls_version = 1;

/// A folder of hulls, with a file for each mesh and kind of contact. Several processes may use it at once. A store
/// never fails: a file that can't be read or that is damaged counts as absent, and hulls that can't be written are
/// computed again.
class HullStore {
 public:
  /// Finds and keeps nothing.
  HullStore() = default;
  explicit HullStore(std::filesystem::path folder) : folder_(std::move(folder)) {}
  /// In `hulls` of REHEARSE_CACHE, else of `rehearse` in XDG_CACHE_HOME, else of `.cache/rehearse` in HOME. Empty if
  /// REHEARSE_CACHE is `off`.
  static HullStore of_user();
  /// False: this store keeps nothing.
  bool is_kept() const { return !folder_.empty(); }

  /// The hulls with their remarks; nullopt: absent.
  std::optional<ConvexHulls> find(const MeshData& mesh, MeshContact contact) const;
  void keep(const MeshData& mesh, MeshContact contact, const ConvexHulls& hulls) const;

 private:
  /// Named by the hash of the mesh's objects and triangles, the contact, hulls_version and Qhull's version.
  std::filesystem::path file_of(const MeshData& mesh, MeshContact contact) const;

  std::filesystem::path folder_;
};

}  // namespace rehearse
