// The tests that compare with each golden, as reported by the tests when they run. Names are made by macros, parameters
// and types, so a search of the sources doesn't find them.
#include <fmt/format.h>
#include <rehearse/golden.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "golden_files.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// The folder with a file for each golden, which has a line for each test.
fs::path owners_folder(const fs::path& pending) { return pending / ".owners"; }

std::vector<std::string> lines_of(const fs::path& file) {
  std::vector<std::string> lines;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);)
    if (!line.empty()) lines.push_back(line);
  return lines;
}

std::string own_program_as_named() {
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  const fs::path relative = program.lexically_proximate(fs::current_path(failed));
  return *relative.begin() == ".." ? program.string() : relative.string();
}

}  // namespace

void report_golden_owner(const fs::path& pending, const std::string& golden, const std::string& test) {
  if (golden.empty() || golden.find('/') != std::string::npos) return;
  const fs::path file = owners_folder(pending) / golden;
  const std::string line = fmt::format("{} of {}", test, own_program_as_named());
  std::error_code failed;
  fs::create_directories(file.parent_path(), failed);
  std::vector<std::string> lines = lines_of(file);
  if (std::find(lines.begin(), lines.end(), line) != lines.end()) return;
  std::ofstream(file, std::ios::app) << line + "\n";  // in one write, because tests run in parallel
}

std::map<std::string, std::vector<std::string>> reported_golden_owners(const fs::path& pending) {
  std::map<std::string, std::vector<std::string>> owners;
  std::error_code failed;
  for (fs::directory_iterator entry(owners_folder(pending), failed), end; !failed && entry != end;
       entry.increment(failed)) {
    std::vector<std::string> tests = lines_of(entry->path());
    std::sort(tests.begin(), tests.end());
    owners[entry->path().filename().string()] = std::move(tests);
  }
  return owners;
}

}  // namespace rehearse
