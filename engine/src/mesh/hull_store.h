// Files that keep computed convex parts: a robot of fine meshes takes minutes to decompose, and its parts a moment to
// read. Private to the engine.
#pragma once

#include <rehearse/model.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "triangle_soup.h"

namespace rehearse {

/// Counts the changes of convex_parts() that alter its result; part of each key. A test compares the hash of a
/// decomposition with a stored hash, and fails if only one of the hash and this number changes.
inline constexpr std::uint64_t convex_parts_version = 1;

/// A folder of convex parts, with a file for each object. Several processes may use it at once. A store never fails: a
/// file that can't be read or that is damaged counts as absent, and hulls that can't be written are computed again.
class HullStore {
 public:
  /// Finds and keeps nothing.
  HullStore() = default;
  explicit HullStore(std::filesystem::path folder) : folder_(std::move(folder)) {}
  /// In `convex-parts` of REHEARSE_CACHE, else of `rehearse` in XDG_CACHE_HOME, else of `.cache/rehearse` in HOME.
  /// Empty if REHEARSE_CACHE is `off`.
  static HullStore of_user();

  /// Nullopt: absent.
  std::optional<std::vector<ConvexHull>> find(const TriangleSoup& object) const;
  void keep(const TriangleSoup& object, const std::vector<ConvexHull>& hulls) const;

 private:
  /// Named by the hash of the object's triangles, convex_parts_version and Qhull's version.
  std::filesystem::path file_of(const TriangleSoup& object) const;

  std::filesystem::path folder_;
};

}  // namespace rehearse
