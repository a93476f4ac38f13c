// The files that a mesh is read from: the mesh file, and the files that it names (materials, buffers, pictures).
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace rehearse {

inline constexpr std::size_t max_mesh_bytes = std::size_t{512} << 20;  // 512 MiB, of each file

/// The bytes of a regular file. Errors contain the path as their file.
Result<std::string> read_mesh_file(const std::filesystem::path& file);

/// The only files that a reader may open. Each file is read once and as a whole, and only if it is a regular file of at
/// most max_mesh_bytes.
class MeshInput {
 public:
  /// `bytes`: the content of `file`, whatever is on the disk.
  MeshInput(const std::filesystem::path& file, std::string bytes);
  MeshInput(const MeshInput&) = delete;
  MeshInput& operator=(const MeshInput&) = delete;

  /// The content of a file that the mesh names, relative to the mesh; null if it can't be read.
  const std::string* named(const std::string& path);

  const std::string& bytes() const { return *own_; }
  /// The bytes that the reader gets. The digest stays that of the original bytes.
  std::string& bytes() { return *own_; }
  const std::filesystem::path& file() const { return file_; }

  /// The named files that couldn't be read, in the order of the attempts.
  const std::vector<std::string>& missing() const { return missing_; }
  /// The files that were read in addition to the mesh itself, by real path.
  const std::map<std::string, std::unique_ptr<std::string>>& others() const { return others_; }

  /// XXH3 of the mesh's bytes, then of each file that was read for it, in the order of reading, with the previous hash
  /// as the seed. 16 hexadecimal digits.
  std::string digest() const;

  /// True if the reader may open the file of that path.
  bool exists(const std::string& path) const;
  /// The content of the file that the reader opens; null: it is missing from now on.
  const std::string* open(const std::string& path);

 private:
  const std::string* read(const std::filesystem::path& path);

  std::filesystem::path file_;
  std::unique_ptr<std::string> own_;
  std::map<std::string, std::unique_ptr<std::string>> others_;
  std::vector<std::string> missing_;
  std::uint64_t hash_;
};

}  // namespace rehearse
