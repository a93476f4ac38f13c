#include "source_age.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "base/file_identity.h"
#include "base/hashing.h"
#include "controller_host.h"
#include "core/scenario/project.h"
#include "hosted_language.h"
#include "library_origin.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

bool is_below(const fs::path& file, const fs::path& folder) {
  const fs::path inside = file.lexically_relative(folder);
  return !inside.empty() && *inside.begin() != "..";
}

/// The build that made the library: the nearest folder above it with CMake's cache; empty: none.
fs::path build_of(const fs::path& library) {
  std::error_code ignored;
  for (fs::path folder = library.parent_path(); folder != folder.parent_path(); folder = folder.parent_path())
    if (fs::is_regular_file(folder / "CMakeCache.txt", ignored)) return folder;
  return {};
}

/// The sources below the project, which exist, without those in builds. A relative name is one in the folder of the
/// build or of the project.
std::set<fs::path> sources_in(const std::vector<std::string>& names, const fs::path& project, const fs::path& build) {
  const std::vector<fs::path> builds = build_folders(project);
  std::set<fs::path> sources;
  const auto add = [&](const fs::path& name) {
    std::error_code missing;
    const fs::path file = fs::weakly_canonical(name, missing);
    const auto has_it = [&file](const fs::path& folder) { return is_below(file, folder); };
    if (!missing && fs::is_regular_file(file, missing) && is_below(file, project) &&
        std::ranges::none_of(builds, has_it) && (build.empty() || !has_it(build)))
      sources.insert(file);
  };
  for (const fs::path name : names) {
    add(project / name);  // an absolute name stays as it is
    if (name.is_relative() && !build.empty()) add(build / name);
  }
  return sources;
}

/// The libraries below the project or its build that a library links.
std::set<fs::path> linked_in(const LibraryOrigin& origin, const fs::path& library, const fs::path& project,
                             const fs::path& build) {
  std::set<fs::path> linked;
  for (const fs::path& file : files_of_linked(origin, library))
    if (is_below(file, project) || (!build.empty() && is_below(file, build))) linked.insert(file);
  return linked;
}

/// The sources of a library, what is known of their content when it was built, and the libraries that it links.
struct BuiltSources {
  static constexpr const char* unknown = "-";
  static constexpr const char* link = "+";   // in place of a hash: the file is a library
  static constexpr const char* state = "=";  // in place of a hash: identity_text() of the library follows

  std::string library;                     // its hash and the time of its file
  std::string identity;                    // of its file, which then has that hash; empty: it may have another one
  std::map<fs::path, std::string> hashes;  // unknown: the source was newer already
  std::set<fs::path> linked;

  static BuiltSources read(const fs::path& file) {
    BuiltSources known;
    std::ifstream stream(file);
    std::getline(stream, known.library);
    for (std::string hash, path; stream >> hash && std::getline(stream >> std::ws, path);) {
      if (hash == link)
        known.linked.insert(path);
      else if (hash == state)
        known.identity = path;
      else
        known.hashes[path] = hash;
    }
    return known;
  }
  void write(const fs::path& file) const {
    std::error_code failed;
    fs::create_directories(file.parent_path(), failed);
    const fs::path whole = fs::path(file).concat(fmt::format(".{}", ::getpid()));
    std::ofstream stream(whole);
    stream << library << '\n';
    if (!identity.empty()) stream << state << ' ' << identity << '\n';
    for (const auto& [path, hash] : hashes) stream << hash << ' ' << path.string() << '\n';
    for (const fs::path& path : linked) stream << link << ' ' << path.string() << '\n';
    stream.close();
    if (stream) fs::rename(whole, file, failed);
    if (!stream || failed) fs::remove(whole, failed);  // the next check has to read the library again
  }
};

/// The state of a file in one line. Empty: a later change might leave it as it is.
std::string identity_text(const fs::path& file) {
  constexpr std::chrono::seconds settled{2};
  const auto known = FileIdentity::of(file);
  if (!known || !known->is_older_than(settled)) return {};
  return fmt::format("{} {} {} {} {}", known->device, known->inode, known->size, known->modified, known->changed);
}

/// What is known of the library; looked up, or else found out now and stored. The library is read only if its file has
/// changed.
BuiltSources built_sources(const fs::path& library, fs::file_time_type built, const fs::path& project) {
  const fs::path build = build_of(library);
  const std::string key = library.string() + '\n' + project.string();  // sources outside the project aren't in the file
  const fs::path file = build / "rehearse-sources" / hash_text(hash_bytes(key.data(), key.size()));
  BuiltSources before, now;
  if (!build.empty()) before = BuiltSources::read(file);
  now.identity = identity_text(library);
  if (!now.identity.empty() && before.identity == now.identity) return before;
  now.library = fmt::format("{} {}", content_hash_of(library), built.time_since_epoch().count());
  if (identity_text(library) != now.identity) now.identity.clear();  // it was changed meanwhile
  if (before.library == now.library) {
    before.identity = now.identity;
    if (!before.identity.empty()) before.write(file);
    return before;
  }
  const LibraryOrigin origin = origin_of(library);
  now.linked = linked_in(origin, library, project, build);
  for (const fs::path& source : sources_in(origin.sources, project, build)) {
    std::error_code missing;
    const bool is_older = fs::last_write_time(source, missing) <= built;
    now.hashes[source] = is_older ? content_hash_of(source) : BuiltSources::unknown;
  }
  if (!build.empty()) now.write(file);
  return now;
}

std::string sentence(const std::vector<fs::path>& newer, const fs::path& library) {
  std::error_code ignored;
  const auto as_seen = [&ignored](const fs::path& path) { return fs::proximate(path, ignored).string(); };
  const fs::path build = build_of(library);
  const std::string others = newer.size() > 1 ? fmt::format(" and {} more are", newer.size() - 1) : " is";
  return fmt::format("{}{} newer than {}: built before your last change; {}", as_seen(newer.front()), others,
                     library.filename().string(), build.empty() ? "build it" : "cmake --build " + as_seen(build));
}

/// What was found out about a library.
struct LibraryAge {
  std::string note;  // empty: it is up to date, or nothing is known
  std::set<fs::path> linked;
};

LibraryAge age_of(const fs::path& library) {
  std::error_code missing;
  const fs::file_time_type built = fs::last_write_time(library, missing);
  auto project = find_project(library);
  if (!project) project = find_project("./");
  if (missing || !project) return {};
  const BuiltSources sources = built_sources(library, built, fs::canonical(*project, missing));
  std::vector<fs::path> newer;
  for (const auto& [source, hash] : sources.hashes) {
    const fs::file_time_type written = fs::last_write_time(source, missing);
    if (!missing && written > built && content_hash_of(source) != hash) newer.push_back(source);
  }
  return {newer.empty() ? std::string() : sentence(newer, library), sources.linked};
}

/// Adds the notes of a library and of those that it links. `seen`: the libraries whose notes are in the list.
void add_notes(const fs::path& library, std::set<fs::path>& seen, std::vector<std::string>& notes) {
  static auto& ages = *new std::map<fs::path, LibraryAge>;
  std::error_code missing;
  const fs::path file = fs::canonical(library, missing);
  if (missing || !seen.insert(file).second) return;
  const auto [known, is_new] = ages.try_emplace(file);
  if (is_new) known->second = age_of(file);
  if (!known->second.note.empty()) notes.push_back(known->second.note);
  for (const fs::path& linked : known->second.linked) add_notes(linked, seen, notes);
}

}  // namespace

std::vector<std::string> notes_on_old_library(const fs::path& library) {
  std::set<fs::path> seen;
  std::vector<std::string> notes;
  add_notes(library, seen, notes);
  return notes;
}

std::vector<std::string> notes_on_old_libraries(const Scenario& scenario, const HostOptions& options) {
  std::set<fs::path> seen;
  std::vector<std::string> notes;
  const auto look = [&](const ScenarioBody& body, const ScenarioController& controller) {
    const auto library = library_of(scenario, controller, body.name + "/" + controller.name, options);
    if (!library) return;  // a run reports a library that is missing
    std::string chosen = note_on_builds_of(scenario, controller, body.name + "/" + controller.name, options);
    if (!chosen.empty() && std::ranges::find(notes, chosen) == notes.end()) notes.push_back(std::move(chosen));
    add_notes(*library, seen, notes);
    // runs in forks of this process find the hash that they need of it
    if (!hosted_name(*library)) static_cast<void>(content_hash_of(fs::absolute(*library)));
  };
  for (const ScenarioBody& body : scenario.bodies)
    for (const ScenarioController& controller : body.controllers) {
      look(body, controller);
      for (const ScenarioController& child : controller.children) look(body, child);
    }
  return notes;
}

void tell_old_libraries(const std::vector<std::string>& notes) {
  static auto& told = *new std::set<std::string>;
  for (const std::string& note : notes)
    if (told.insert(note).second) fmt::print(stderr, "note: {}\n", note);
}

}  // namespace rehearse
