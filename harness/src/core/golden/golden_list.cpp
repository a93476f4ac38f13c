// Lists the goldens and their owners.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/golden.h>
#include <rehearse/mcap.h>

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

#include "core/kinds/channel_name.h"
#include "core/trace/run_facts.h"
#include "golden_files.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

using Owners = std::map<std::string, GoldenOwners>;  // by golden

constexpr std::uintmax_t largest_scenario = 4 << 20;  // [bytes]
constexpr std::string_view blanks = " \t\r\n";

std::string_view without_blanks(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

std::string_view without_comment(std::string_view line) { return without_blanks(line.substr(0, line.find('#'))); }

/// The value of `name` in a map, in one line with braces or in indented lines; `text` begins after the map's key.
std::string_view name_in_map(std::string_view text) {
  constexpr std::string_view key = "name:";
  for (bool is_first = true; !text.empty(); is_first = false) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    if (!is_first && !line.starts_with(' ')) return {};
    const std::string_view entries = without_comment(line);
    const std::size_t name = entries.find(key);
    if (name == std::string_view::npos) continue;
    const std::string_view value = entries.substr(name + key.size());
    return without_blanks(value.substr(0, value.find_first_of(",}")));
  }
  return {};
}

/// Finds `golden: NAME` or `golden: {name: NAME}` at the beginning of a line, the key quoted or not.
void find_in_scenario(std::string_view text, const std::string& file, Owners& owners) {
  constexpr std::string_view key = "golden:";
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    const bool quoted = line.starts_with("\"golden\":") || line.starts_with("'golden':");
    const std::size_t value = at + key.size() + (quoted ? 2 : 0);
    at = end + 1;
    if (!quoted && !line.starts_with(key)) continue;
    std::string_view name = without_comment(text.substr(value, end - value));
    if (name.empty() || name.starts_with('{')) name = name_in_map(text.substr(value));
    if (name.size() >= 2 && (name.front() == '"' || name.front() == '\'')) name = name.substr(1, name.size() - 2);
    if (!name.empty()) owners[std::string(name)].scenarios.push_back(file);
  }
}

bool may_be_scenario(const fs::path& file) {
  const std::string_view name = file.native();
  return name.ends_with(".yaml") || name.ends_with(".yml");
}

void find_in_file(const fs::path& file, Owners& owners) {
  std::error_code ignored;
  if (fs::file_size(file, ignored) > largest_scenario) return;  // such a file is data, no scenario
  if (const auto text = read_text(file)) find_in_scenario(*text, file.string(), owners);
}

/// Hidden folders, folders of builds, of npm and of pending runs contain no scenarios of the project.
bool is_left_out(const std::string& folder) {
  return folder.starts_with('.') || folder.starts_with("build") || folder == "node_modules" ||
         folder == "rehearse-pending";
}

std::set<fs::path> scenario_files_in(const std::vector<fs::path>& sources) {
  std::set<fs::path> files;  // sorted, independent of the folder's order
  std::error_code ignored;
  for (const fs::path& source : sources) {
    if (may_be_scenario(source) && fs::is_regular_file(source, ignored)) files.insert(source);
    auto entry = fs::recursive_directory_iterator(source, fs::directory_options::skip_permission_denied, ignored);
    for (; entry != fs::recursive_directory_iterator(); entry.increment(ignored)) {
      if (entry->is_directory(ignored)) {
        if (is_left_out(entry->path().filename().string())) entry.disable_recursion_pending();
      } else if (may_be_scenario(entry->path())) {
        files.insert(entry->path().lexically_normal());
      }
    }
  }
  return files;
}

/// Notes the facts of a provenance that differ from those of this program.
void compare_versions(const mcap::StringMap& provenance, const mcap::StringMap& present, GoldenEntry& entry) {
  for (const auto& [fact, now] : present) {
    const auto then = provenance.find(fact);
    if (then == provenance.end() || then->second == now || now.empty()) continue;
    const char* what = fact == facts::rehearse ? "Rehearse " : "";
    entry.notes.push_back(fmt::format("recorded with {}{}; this is {}{}", what, then->second, what, now));
  }
}

void read_provenance(const mcap::Reader& reader, const mcap::StringMap& present, GoldenEntry& entry) {
  if (const auto provenance = RunFacts::of(reader).provenance) {
    for (const std::string fact : facts::versions) {
      const auto found = provenance->find(fact);
      if (found == provenance->end()) continue;
      entry.recorded_by += (entry.recorded_by.empty() ? "" : ", ") +
                           std::string(fact == facts::rehearse ? "rehearse " : "") + found->second;
    }
    compare_versions(*provenance, present, entry);
  }
  const std::vector<Acceptance> history = history_of(reader.metadata());
  entry.acceptances = static_cast<int>(history.size());
  if (!history.empty()) entry.accepted = history.back().date;
  const bool has_checkpoints = std::ranges::any_of(
      reader.channels(), [](const auto& channel) { return channel.second.topic == run_topics::checkpoint; });
  if (!has_checkpoints && reader.damage().empty())
    entry.notes.push_back("it has no checkpoints: its physics can't be checked piece by piece");
}

/// Reads the facts of the recording: its writer, and whether it can be read.
void describe(const GoldenStore& store, const mcap::StringMap& present, GoldenEntry& entry) {
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
  read_provenance(**reader, present, entry);
  if (const auto known = check_trace_version((*reader)->metadata(), (*reader)->name()); !known)
    entry.problem = known.errors()[0].message;
  else if (const auto digest = store.check_digest(entry.name); !digest)
    entry.problem = digest.errors()[0].message;
}

}  // namespace

std::string GoldenOwners::conflict() const {
  if (scenarios.size() > 1)
    return fmt::format("{} scenarios name it: {}", scenarios.size(), fmt::join(scenarios, ", "));
  if (sources.size() > 1)
    return fmt::format("{} sources have a test of its name: {}", sources.size(), fmt::join(sources, ", "));
  return {};
}

std::map<std::string, GoldenOwners> find_golden_owners(const fs::path& folder, const std::vector<fs::path>& sources) {
  std::map<fs::path, bool> of_folder;  // by the folder of a file: true if it belongs to these goldens
  Owners owners;
  for (const fs::path& file : scenario_files_in(sources)) {
    const auto [known, is_new] = of_folder.try_emplace(file.parent_path(), true);
    std::error_code ignored;
    if (is_new)
      if (const auto nearest = find_golden_folder(file)) known->second = fs::equivalent(*nearest, folder, ignored);
    if (known->second) find_in_file(file, owners);
  }
  return owners;
}

Result<std::vector<GoldenEntry>> list_goldens(const GoldenStore& store, const std::vector<fs::path>& sources,
                                              const mcap::StringMap& present) {
  std::error_code failed;
  std::set<std::string> names;
  for (const fs::directory_entry& file : fs::directory_iterator(store.folder(), failed)) {
    const fs::path path = file.path();
    const bool golden = path.extension() == ".mcap" || path.extension() == ".txt";
    if (golden && path.stem().string().find('.') != std::string::npos) names.insert(path.stem().string());
  }
  if (failed)
    return error(fmt::format("the goldens in {} can't be listed: {}", store.folder().string(), failed.message()));
  Owners owners = find_golden_owners(store.folder(), sources);
  for (auto& [name, reported] : reported_golden_owners(store)) {
    owners[name].tests = std::move(reported.tests);
    owners[name].sources = std::move(reported.sources);
  }
  std::vector<GoldenEntry> entries;
  for (const std::string& name : names) {
    GoldenEntry& entry = entries.emplace_back();
    entry.name = name;
    entry.pending = fs::is_regular_file(store.pending_file(name), failed);
    describe(store, present, entry);
    const auto known = owners.find(name);
    if (known == owners.end()) continue;
    entry.owners = known->second.scenarios;
    entry.owners.insert(entry.owners.end(), known->second.tests.begin(), known->second.tests.end());
    if (entry.problem.empty()) entry.problem = known->second.conflict();
  }
  return entries;
}

}  // namespace rehearse
