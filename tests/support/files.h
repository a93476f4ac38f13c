// Whole files, as text and as bytes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rehearse::test {

using Buffer = std::vector<std::byte>;

/// Empty if the file can't be read.
inline std::string read_file(const std::filesystem::path& file) {
  std::ostringstream text;  // an iterator over the stream takes seconds for a large file in a build with sanitizers
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return std::move(text).str();
}

inline Buffer read_bytes(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  return {begin, begin + text.size()};
}

inline void write_bytes(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace rehearse::test
