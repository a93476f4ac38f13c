#include "mathematics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

namespace rehearse {

std::string mathematics_of_processor() {
  std::ifstream lines("/proc/cpuinfo");
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("flags") && !line.starts_with("Features")) continue;
    std::istringstream words(line.substr(std::min(line.find(':') + 1, line.size())));
    std::set<std::string> kept;
    for (std::string word; words >> word;)
      if (word == "fma" || word == "fma4" || word == "avx" || word == "avx2" || word == "asimd") kept.insert(word);
    return fmt::format("{}", fmt::join(kept, " "));
  }
  return {};
}

}  // namespace rehearse
