#include "mesh_cache.h"

#include <map>
#include <mutex>
#include <system_error>
#include <tuple>

#include "mesh_file.h"

namespace rehearse {
namespace {

using Key = std::tuple<std::string, std::uintmax_t, std::filesystem::file_time_type, double, double, double>;

class MeshCache {
 public:
  static MeshCache& one() {
    static MeshCache cache;
    return cache;
  }

  Result<SharedMesh> get(const std::filesystem::path& file, const Eigen::Vector3d& scale) {
    const std::lock_guard lock(mutex_);
    const Key key = key_of(file, scale);
    std::shared_ptr<const MeshReading> reading;
    if (const auto known = readings_.find(key); known != readings_.end()) reading = known->second.lock();
    if (reading == nullptr) {
      Result<MeshReading> fresh = read_mesh(file, scale);
      if (!fresh) return fresh.errors();
      ++count_;
      std::erase_if(readings_, [](const auto& entry) { return entry.second.expired(); });
      reading = std::make_shared<const MeshReading>(*std::move(fresh));
      readings_[key] = reading;
    }
    return SharedMesh{{reading, &reading->data}, reading->warnings};
  }

  std::uint64_t count() {
    const std::lock_guard lock(mutex_);
    return count_;
  }

 private:
  static Key key_of(const std::filesystem::path& file, const Eigen::Vector3d& scale) {
    std::error_code ignored;
    return {std::filesystem::weakly_canonical(file, ignored).string(),
            std::filesystem::file_size(file, ignored),
            std::filesystem::last_write_time(file, ignored),
            scale.x(),
            scale.y(),
            scale.z()};
  }

  std::mutex mutex_;
  std::map<Key, std::weak_ptr<const MeshReading>> readings_;
  std::uint64_t count_ = 0;
};

}  // namespace

Result<SharedMesh> shared_mesh(const std::filesystem::path& file, const Eigen::Vector3d& scale) {
  return MeshCache::one().get(file, scale);
}

std::uint64_t meshes_read() { return MeshCache::one().count(); }

}  // namespace rehearse
