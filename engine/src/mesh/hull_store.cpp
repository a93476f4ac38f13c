#define XXH_INLINE_ALL
#include "hull_store.h"

#include <fmt/format.h>
#include <libqhull_r/qhull_ra.h>
#include <xxhash.h>

#include <array>
#include <cstring>
#include <iterator>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "base/user_cache.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Numbers = std::vector<double>;  // hulls: counts, coordinates [m] and numbers of vertices

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

/// Reverses numbers_of(). The hash of the file is right, so the counts are.
std::vector<ConvexHull> hulls_of(const Numbers& numbers) {
  auto next = numbers.begin();
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

constexpr char between_fields = '\t';  // messages and hints of hulls are single lines without it

/// A line for each remark.
std::string text_of(const Diagnostics& remarks) {
  std::string text;
  for (const Diagnostic& remark : remarks)
    text += fmt::format("{}{}{}{}{}\n", static_cast<int>(remark.severity), between_fields, remark.message,
                        between_fields, remark.hint);
  return text;
}

Diagnostics remarks_of(const std::string& text) {
  Diagnostics remarks;
  std::istringstream lines(text);
  for (std::string severity, message, hint; std::getline(lines, severity, between_fields) &&
                                            std::getline(lines, message, between_fields) &&
                                            std::getline(lines, hint);) {
    Diagnostic& remark = remarks.emplace_back(error(message, hint));
    remark.severity = static_cast<Severity>(std::atoi(severity.c_str()));
  }
  return remarks;
}

/// The content of a file: the hash of all that follows, the count of numbers, the numbers, the remarks.
struct Header {
  std::uint64_t hash = 0;
  std::uint64_t numbers = 0;
};

std::uint64_t hash_of_content(const Numbers& numbers, const std::string& remarks) {
  return hash_of(std::span(remarks), hash_of(std::span(numbers)));
}

std::optional<ConvexHulls> read(const fs::path& file) {
  const std::string bytes = read_from_cache(file).value_or("");
  Header header;
  if (bytes.size() < sizeof header) return std::nullopt;
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.numbers > (bytes.size() - sizeof header) / sizeof(double)) return std::nullopt;
  Numbers numbers(header.numbers);
  std::memcpy(numbers.data(), bytes.data() + sizeof header, numbers.size() * sizeof(double));
  const std::string remarks = bytes.substr(sizeof header + numbers.size() * sizeof(double));
  if (numbers.empty() || header.hash != hash_of_content(numbers, remarks)) return std::nullopt;
  return ConvexHulls{hulls_of(numbers), remarks_of(remarks)};
}

}  // namespace

HullStore HullStore::of_user() {
  const fs::path caches = user_cache();
  return caches.empty() ? HullStore() : HullStore(caches / "hulls");
}

fs::path HullStore::file_of(const MeshData& mesh, MeshContact contact) const {
  std::uint64_t hash = hash_of(std::span(qh_version, std::strlen(qh_version)), hulls_version);
  const std::uint64_t in_parts = contact == MeshContact::parts ? 1 : 0;
  hash = hash_of(std::span(&in_parts, 1), hash);
  for (const MeshPart& part : mesh.parts) {
    const std::array<std::uint64_t, 3> counts{static_cast<std::uint64_t>(part.object), part.vertices.size(),
                                              part.triangles.size()};
    hash = hash_of(std::span(counts), hash);
    hash = hash_of(std::span(part.vertices), hash);
    hash = hash_of(std::span(part.triangles), hash);
  }
  return folder_ / fmt::format("{:016x}", hash);
}

std::optional<ConvexHulls> HullStore::find(const MeshData& mesh, MeshContact contact) const {
  return folder_.empty() ? std::nullopt : read(file_of(mesh, contact));
}

void HullStore::keep(const MeshData& mesh, MeshContact contact, const ConvexHulls& hulls) const {
  if (folder_.empty()) return;
  const Numbers numbers = numbers_of(hulls.hulls);
  const std::string remarks = text_of(hulls.remarks);
  const Header header{hash_of_content(numbers, remarks), numbers.size()};
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
  bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
  keep_in_cache(file_of(mesh, contact), bytes + remarks);
}

}  // namespace rehearse
