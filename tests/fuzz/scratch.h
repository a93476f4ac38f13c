// A file or folder of one fuzz test, in memory where there is a file system for that.
#pragma once

#include <unistd.h>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace rehearse {

/// Removed with the object.
struct Scratch {
  explicit Scratch(const char* name) {
    std::error_code none;
    const std::filesystem::path shared = "/dev/shm";
    const bool there = std::filesystem::is_directory(shared, none);
    path = (there ? shared : std::filesystem::temp_directory_path()) /
           ("rehearse_fuzz_" + std::to_string(getpid()) + name);
  }
  ~Scratch() {
    std::error_code none;
    std::filesystem::remove_all(path, none);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  std::vector<std::byte> read() const {
    std::ifstream in(path, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
    return {bytes, bytes + text.size()};
  }

  std::filesystem::path path;
};

}  // namespace rehearse
