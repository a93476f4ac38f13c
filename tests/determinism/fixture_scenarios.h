// The scenarios of the fixtures.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace rehearse {

/// Their names, without .yaml, sorted.
inline std::vector<std::string> fixture_scenarios() {
  std::vector<std::string> names;
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(FIXTURES_DIR "/scenarios"))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace rehearse
