#include "pending_verdict.h"

#include <fmt/format.h>

#include <fstream>

#include "golden_files.h"
#include "trace/hashing.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

fs::path file_beside(const fs::path& trace) { return fs::path(trace).replace_extension(".verdict"); }

}  // namespace

Result<void> keep_verdict(const fs::path& trace, const std::string& verdict) {
  const auto content = hash_of_file(trace);
  if (!content) return content.errors();
  const fs::path file = file_beside(trace);
  std::ofstream stream(file, std::ios::binary);  // in the folder of the run, from where both are published
  stream << hash_text(*content) << '\n' << verdict << '\n';
  if (stream.flush()) return {};
  return error(fmt::format("{} can't be written", file.string()));
}

std::string kept_verdict(const fs::path& trace) {
  const auto content = hash_of_file(trace);
  const auto text = read_text(file_beside(trace));
  if (!content || !text) return "";
  const std::string mark = hash_text(*content) + "\n";
  if (!text->starts_with(mark) || !text->ends_with('\n')) return "";
  return text->substr(mark.size(), text->size() - mark.size() - 1);
}

void remove_verdict(const fs::path& trace) {
  std::error_code ignored;
  fs::remove(file_beside(trace), ignored);
}

}  // namespace rehearse
