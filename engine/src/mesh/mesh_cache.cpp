#include "mesh_cache.h"

#include <map>
#include <mutex>
#include <optional>
#include <system_error>
#include <tuple>

#include "convex_parts.h"

namespace rehearse {
namespace {

using Key = std::tuple<std::string, std::uintmax_t, std::filesystem::file_time_type, double, double, double,
                       std::string, std::set<std::string>, bool>;

struct CachedMesh {
  MeshReading reading;
  std::optional<Result<ConvexHulls>> hulls, parts;  // nullopt: not requested yet
};

class MeshCache {
 public:
  static MeshCache& one() {
    static MeshCache cache;
    return cache;
  }

  Result<SharedMesh> mesh(const std::filesystem::path& file, const Eigen::Vector3d& scale,
                          const MeshSelection& selection) {
    const std::lock_guard lock(mutex_);
    const auto found = REHEARSE_TRY(find(file, scale, selection));
    const MeshReading& reading = found->reading;
    return SharedMesh{{found, &reading.data}, reading.warnings};
  }

  Result<std::shared_ptr<const ConvexHulls>> hulls(const std::filesystem::path& file, const Eigen::Vector3d& scale,
                                                   MeshContact contact, const MeshSelection& selection) {
    const std::lock_guard lock(mutex_);
    const auto found = REHEARSE_TRY(find(file, scale, selection));
    auto& hulls = contact == MeshContact::parts ? found->parts : found->hulls;
    if (!hulls) hulls = contact_hulls(found->reading.data, contact, HullStore::of_user());
    if (!*hulls) return hulls->errors();
    return std::shared_ptr<const ConvexHulls>(found, &**hulls);
  }

  std::uint64_t count() {
    const std::lock_guard lock(mutex_);
    return count_;
  }

 private:
  Result<std::shared_ptr<CachedMesh>> find(const std::filesystem::path& file, const Eigen::Vector3d& scale,
                                           const MeshSelection& selection) {
    const Key key = key_of(file, scale, selection);
    if (const auto known = meshes_.find(key); known != meshes_.end())
      if (std::shared_ptr<CachedMesh> held = known->second.lock()) return held;
    MeshReading fresh = REHEARSE_TRY(read_mesh(file, scale, selection));
    ++count_;
    std::erase_if(meshes_, [](const auto& entry) { return entry.second.expired(); });
    auto read = std::make_shared<CachedMesh>(CachedMesh{std::move(fresh), std::nullopt, std::nullopt});
    meshes_[key] = read;
    return read;
  }

  static Key key_of(const std::filesystem::path& file, const Eigen::Vector3d& scale, const MeshSelection& selection) {
    std::error_code ignored;
    return {std::filesystem::weakly_canonical(file, ignored).string(),
            std::filesystem::file_size(file, ignored),
            std::filesystem::last_write_time(file, ignored),
            scale.x(),
            scale.y(),
            scale.z(),
            selection.node,
            selection.without,
            selection.z_up};
  }

  std::mutex mutex_;
  std::map<Key, std::weak_ptr<CachedMesh>> meshes_;
  std::uint64_t count_ = 0;
};

}  // namespace

Result<SharedMesh> shared_mesh(const std::filesystem::path& file, const Eigen::Vector3d& scale,
                               const MeshSelection& selection) {
  return MeshCache::one().mesh(file, scale, selection);
}

Result<std::shared_ptr<const ConvexHulls>> shared_hulls(const std::filesystem::path& file, const Eigen::Vector3d& scale,
                                                        MeshContact contact, const MeshSelection& selection) {
  return MeshCache::one().hulls(file, scale, contact, selection);
}

std::uint64_t meshes_read() { return MeshCache::one().count(); }

}  // namespace rehearse
