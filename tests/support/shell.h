// Runs programs for tests.
#pragma once

#include <sys/wait.h>
#include <array>
#include <cstdio>
#include <filesystem>
#include <string>

namespace rehearse::test {

namespace fs = std::filesystem;

struct Output {
  std::string text;  // stdout and stderr
  int status = 0;
};

inline Output run(const std::string& command) {
  Output output;
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return {"popen failed", -1};
  std::array<char, 4096> part;
  while (const std::size_t size = std::fread(part.data(), 1, part.size(), pipe)) output.text.append(part.data(), size);
  output.status = ::pclose(pipe);
  return output;
}

inline std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

}  // namespace rehearse::test
