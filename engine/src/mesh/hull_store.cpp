#define XXH_INLINE_ALL
#include "hull_store.h"

#include <fmt/format.h>
#include <libqhull_r/qhull_ra.h>
#include <unistd.h>
#include <xxhash.h>

#include <bit>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <span>

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Numbers = std::vector<double>;  // a file's content: counts, coordinates [m] and numbers of vertices

fs::path caches_of_user() {
  const auto folder = [](const char* variable) {
    const char* value = std::getenv(variable);
    return fs::path(value ? value : "");
  };
  if (const fs::path stated = folder("REHEARSE_CACHE"); !stated.empty()) return stated == "off" ? fs::path() : stated;
  if (const fs::path caches = folder("XDG_CACHE_HOME"); caches.is_absolute()) return caches / "rehearse";
  if (const fs::path home = folder("HOME"); home.is_absolute()) return home / ".cache/rehearse";
  return {};
}

template <typename T, std::size_t extent>
std::uint64_t hash_of(std::span<T, extent> values, std::uint64_t seed = 0) {
  return XXH3_64bits_withSeed(values.data(), values.size_bytes(), seed);
}

Numbers numbers_of(const std::vector<ConvexHull>& hulls) {
  Numbers numbers;
  const auto add = [&numbers](auto number) { numbers.push_back(static_cast<double>(number)); };
  add(hulls.size());
  for (const ConvexHull& hull : hulls) {
    add(hull.vertices.size());
    for (const Eigen::Vector3d& vertex : hull.vertices) numbers.insert(numbers.end(), vertex.begin(), vertex.end());
    add(hull.faces.size());
    for (const std::vector<int>& face : hull.faces) {
      add(face.size());
      for (const int vertex : face) add(vertex);
    }
  }
  return numbers;
}

/// The numbers of a file whose hash is right; else none.
Numbers read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  Numbers numbers(bytes.size() / sizeof(double));
  if (numbers.empty() || bytes.size() % sizeof(double) != 0) return {};
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  const auto hash = std::bit_cast<std::uint64_t>(numbers.back());
  numbers.pop_back();
  return hash == hash_of(std::span(numbers)) ? numbers : Numbers();
}

}  // namespace

HullStore HullStore::of_user() {
  const fs::path caches = caches_of_user();
  return caches.empty() ? HullStore() : HullStore(caches / "convex-parts");
}

fs::path HullStore::file_of(const TriangleSoup& object) const {
  std::uint64_t hash = hash_of(std::span(qh_version, std::strlen(qh_version)), convex_parts_version);
  for (const Eigen::Vector3d& vertex : object.vertices) hash = hash_of(std::span(vertex.data(), 3), hash);
  return folder_ / fmt::format("{:016x}", hash_of(std::span(object.triangles), hash));
}

std::optional<std::vector<ConvexHull>> HullStore::find(const TriangleSoup& object) const {
  const Numbers numbers = folder_.empty() ? Numbers() : read(file_of(object));
  if (numbers.empty()) return std::nullopt;
  auto next = numbers.begin();  // the hash is that of the bytes that keep() wrote, so the counts are right
  const auto count = [&next] { return static_cast<std::size_t>(*next++); };
  std::vector<ConvexHull> hulls(count());
  for (ConvexHull& hull : hulls) {
    hull.vertices.resize(count());
    for (Eigen::Vector3d& vertex : hull.vertices)
      for (double& coordinate : vertex) coordinate = *next++;
    hull.faces.resize(count());
    for (std::vector<int>& face : hull.faces) {
      face.resize(count());
      for (int& vertex : face) vertex = static_cast<int>(*next++);
    }
  }
  return hulls;
}

void HullStore::keep(const TriangleSoup& object, const std::vector<ConvexHull>& hulls) const {
  if (folder_.empty()) return;
  std::error_code failed;
  fs::create_directories(folder_, failed);
  Numbers numbers = numbers_of(hulls);
  numbers.push_back(std::bit_cast<double>(hash_of(std::span(numbers))));
  const fs::path file = file_of(object), whole = fs::path(file).concat(fmt::format(".{}", getpid()));
  std::ofstream stream(whole, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(numbers.data()),
               static_cast<std::streamsize>(numbers.size() * sizeof(double)));
  stream.close();
  if (stream) fs::rename(whole, file, failed);
  if (!stream || failed) fs::remove(whole, failed);
}

}  // namespace rehearse
