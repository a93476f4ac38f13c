// Which goldens there are, and who owns them.
#include <fmt/format.h>
#include <rehearse/golden.h>
#include <rehearse/mcap.h>

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

#include "golden_files.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

using Owners = std::map<std::string, std::vector<std::string>>;  // by golden

constexpr std::string_view blanks = " \t\r\n";

std::string_view without_blanks(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

/// `golden: NAME` at the beginning of a line.
void find_in_scenario(std::string_view text, const std::string& file, Owners& owners) {
  constexpr std::string_view key = "golden:";
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    at = end + 1;
    if (!line.starts_with(key)) continue;
    line = without_blanks(line.substr(key.size(), line.find('#') - key.size()));
    if (line.size() >= 2 && (line.front() == '"' || line.front() == '\'')) line = line.substr(1, line.size() - 2);
    if (!line.empty()) owners[std::string(line)].push_back(file);
  }
}

/// TEST(Suite, Test), TEST_F and TEST_P, in a source that compares with goldens.
void find_in_test(std::string_view text, const std::string& file, Owners& owners) {
  if (text.find("EXPECT_MATCHES_GOLDEN") == std::string_view::npos) return;
  for (const std::string_view macro : {"TEST(", "TEST_F(", "TEST_P("}) {
    for (std::size_t at = text.find(macro); at != std::string_view::npos; at = text.find(macro, at + 1)) {
      const std::size_t open = at + macro.size(), close = std::min(text.find(')', open), text.size());
      const std::string_view names = text.substr(open, close - open);
      const std::size_t comma = names.find(',');
      if (comma == std::string_view::npos) continue;
      owners[fmt::format("{}.{}", without_blanks(names.substr(0, comma)), without_blanks(names.substr(comma + 1)))]
          .push_back(file);
    }
  }
}

void find_in_file(const fs::path& file, Owners& owners) {
  const std::string ending = file.extension().string();
  const bool scenario = ending == ".yaml" || ending == ".yml";
  if (!scenario && ending != ".cpp" && ending != ".cc") return;
  const auto text = read_text(file);
  if (!text) return;
  if (scenario)
    find_in_scenario(*text, file.string(), owners);
  else
    find_in_test(*text, file.string(), owners);
}

Owners find_owners(const std::vector<fs::path>& sources) {
  std::set<fs::path> files;  // in an order that doesn't depend on the folder's own
  std::error_code ignored;
  for (const fs::path& source : sources) {
    if (fs::is_regular_file(source, ignored)) files.insert(source);
    auto entry = fs::recursive_directory_iterator(source, fs::directory_options::skip_permission_denied, ignored);
    for (; entry != fs::recursive_directory_iterator(); entry.increment(ignored)) {
      const std::string name = entry->path().filename().string();
      if (entry->is_directory(ignored)) {
        if (name.starts_with('.') || name.starts_with("build")) entry.disable_recursion_pending();
      } else {
        files.insert(entry->path().lexically_normal());
      }
    }
  }
  Owners owners;
  for (const fs::path& file : files) find_in_file(file, owners);
  return owners;
}

/// What the recording itself says: who wrote it, and whether it can be read.
void describe(const GoldenStore& store, GoldenEntry& entry) {
  std::error_code ignored;
  if (!store.has(entry.name)) {
    entry.problem = "there is a digest, but no recording";
    return;
  }
  entry.bytes = fs::file_size(store.trace_file(entry.name), ignored);
  const auto reader = mcap::Reader::open(store.trace_file(entry.name));
  if (!reader) {
    entry.problem = reader.errors()[0].message;
    return;
  }
  for (const mcap::Metadata& metadata : (*reader)->metadata()) {
    if (metadata.name != "rehearse") continue;
    for (const char* fact : {"rehearse", "physics", "libc"}) {
      const auto found = metadata.values.find(fact);
      if (found == metadata.values.end()) continue;
      entry.recorded_by += (entry.recorded_by.empty() ? "" : ", ") +
                           std::string(fact == std::string_view("rehearse") ? "rehearse " : "") + found->second;
    }
  }
  if (const auto digest = store.check_digest(entry.name); !digest) entry.problem = digest.errors()[0].message;
}

}  // namespace

Result<std::vector<GoldenEntry>> list_goldens(const GoldenStore& store, const std::vector<fs::path>& sources) {
  std::error_code failed;
  std::set<std::string> names;
  for (const fs::directory_entry& file : fs::directory_iterator(store.folder(), failed)) {
    const fs::path path = file.path();
    const bool golden = path.extension() == ".mcap" || path.extension() == ".txt";
    if (golden && path.stem().string().find('.') != std::string::npos) names.insert(path.stem().string());
  }
  if (failed)
    return error(fmt::format("the goldens in {} can't be listed: {}", store.folder().string(), failed.message()));
  const Owners owners = find_owners(sources);
  std::vector<GoldenEntry> entries;
  for (const std::string& name : names) {
    GoldenEntry& entry = entries.emplace_back();
    entry.name = name;
    if (const auto known = owners.find(name); known != owners.end()) entry.owners = known->second;
    entry.pending = fs::is_regular_file(store.pending_file(name), failed);
    describe(store, entry);
  }
  return entries;
}

}  // namespace rehearse
