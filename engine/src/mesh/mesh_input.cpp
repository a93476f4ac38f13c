#define XXH_INLINE_ALL
#include "mesh_input.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <fstream>
#include <system_error>

#include "mesh_paths.h"

namespace rehearse {
Result<std::string> read_mesh_file(const std::filesystem::path& file) {
  std::error_code problem;
  const auto status = std::filesystem::status(file, problem);
  if (!std::filesystem::exists(status)) {
    Diagnostic absent = no_such_file(file);
    absent.file = file.string();
    return absent;
  }
  if (std::filesystem::is_directory(status)) return error_in(file.string(), "it is a directory");
  if (!std::filesystem::is_regular_file(status)) return error_in(file.string(), "it is not a file that can be read");
  const auto size = std::filesystem::file_size(file, problem);
  if (!problem && size > max_mesh_bytes) {
    return error_in(file.string(), fmt::format("it has {} bytes, more than {} MiB", size, max_mesh_bytes >> 20));
  }
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(problem ? 0 : size, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (problem || !stream.good() || static_cast<std::size_t>(stream.gcount()) != bytes.size()) {
    return error_in(file.string(), "it can't be read", "look at its permissions");
  }
  return bytes;
}

MeshInput::MeshInput(const std::filesystem::path& file, std::string bytes)
    : file_(file),
      own_(std::make_unique<std::string>(std::move(bytes))),
      hash_(XXH3_64bits(own_->data(), own_->size())) {}

const std::string* MeshInput::named(const std::string& path) {
  std::string slashes = path;
  std::ranges::replace(slashes, '\\', '/');
  const std::string* bytes = read(file_.parent_path() / slashes);
  if (bytes == nullptr) bytes = read(file_.parent_path() / percent_decoded(slashes));
  return bytes;
}

std::string MeshInput::digest() const { return fmt::format("{:016x}", hash_); }

const std::string* MeshInput::read(const std::filesystem::path& path) {
  const std::string key = path.lexically_normal().string();
  if (const auto known = others_.find(key); known != others_.end()) return known->second.get();
  Result<std::string> bytes = read_mesh_file(path);
  if (!bytes) return nullptr;
  hash_ = XXH3_64bits_withSeed(bytes->data(), bytes->size(), hash_);
  return others_.emplace(key, std::make_unique<std::string>(*std::move(bytes))).first->second.get();
}

bool MeshInput::exists(const std::string& path) const {
  std::error_code ignored;
  return path == file_.string() || std::filesystem::is_regular_file(path, ignored);
}

const std::string* MeshInput::open(const std::string& path) {
  const std::string* bytes = path == file_.string() ? own_.get() : read(path);
  if (bytes == nullptr) bytes = read(percent_decoded(path));
  if (bytes == nullptr)
    missing_.push_back(std::filesystem::path(path).lexically_relative(file_.parent_path()).string());
  return bytes;
}

}  // namespace rehearse
