// Programs that the shell runs.
#pragma once

#include <sys/wait.h>
#include <array>
#include <cstdio>
#include <string>

namespace rehearse::test {

/// A word for the shell.
inline std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

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

}  // namespace rehearse::test
