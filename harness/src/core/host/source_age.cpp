#include "source_age.h"

#include <dlfcn.h>
#include <elfutils/libdw.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <type_traits>
#include <utility>

#include "controller_host.h"
#include "core/mcap/hashing.h"
#include "core/scenario/project.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// Functions of libdw, which is loaded only to read line information: no run depends on it.
struct Libdw {
  decltype(&dwarf_begin) begin = nullptr;
  decltype(&dwarf_end) end = nullptr;
  decltype(&dwarf_nextcu) next_unit = nullptr;
  decltype(&dwarf_offdie) entry_at = nullptr;
  decltype(&dwarf_getsrcfiles) files_of = nullptr;
  decltype(&dwarf_filesrc) name_of = nullptr;

  /// None: it isn't installed.
  static std::optional<Libdw> load() {
    void* const library = ::dlopen("libdw.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!library) return std::nullopt;
    Libdw functions;
    const auto find = [library](const char* name, auto& function) {
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(::dlsym(library, name));
      return function != nullptr;
    };
    const bool found = find("dwarf_begin", functions.begin) && find("dwarf_end", functions.end) &&
                       find("dwarf_nextcu", functions.next_unit) && find("dwarf_offdie", functions.entry_at) &&
                       find("dwarf_getsrcfiles", functions.files_of) && find("dwarf_filesrc", functions.name_of);
    return found ? std::optional(functions) : std::nullopt;
  }
};

/// Writes the names of all source files in the library's line information, a line each.
void print_line_files(const fs::path& library, std::FILE* to) {
  const auto dw = Libdw::load();
  const int file = dw ? ::open(library.c_str(), O_RDONLY | O_CLOEXEC) : -1;
  Dwarf* const session = file < 0 ? nullptr : dw->begin(file, DWARF_C_READ);
  if (!session) return;
  std::set<std::string> names;
  std::size_t header = 0;
  for (Dwarf_Off unit = 0, next = 0; dw->next_unit(session, unit, &next, &header, nullptr, nullptr, nullptr) == 0;
       unit = next) {
    Dwarf_Die entry;
    Dwarf_Files* files = nullptr;
    std::size_t count = 0;
    if (!dw->entry_at(session, unit + header, &entry) || dw->files_of(&entry, &files, &count) != 0) continue;
    for (std::size_t i = 0; i < count; ++i)
      if (const char* name = dw->name_of(files, i, nullptr, nullptr)) names.insert(name);
  }
  for (const std::string& name : names) fmt::print(to, "{}\n", name);
  dw->end(session);
}

/// The names of all source files in the library's line information. A child process reads it: the memory of this one,
/// which runs controllers, stays as it is.
std::vector<std::string> line_files_of(const fs::path& library) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return {};
  const pid_t child = ::fork();
  if (child == 0) {
    if (std::FILE* const to = ::fdopen(ends[1], "w")) {
      print_line_files(library, to);
      std::fflush(to);
    }
    ::_exit(0);
  }
  ::close(ends[1]);
  std::string text;
  std::array<char, 4096> block{};
  for (ssize_t came = child < 0 ? 0 : 1; came != 0;) {
    came = ::read(ends[0], block.data(), block.size());
    if (came > 0) text.append(block.data(), static_cast<std::size_t>(came));
    if (came < 0 && errno != EINTR) break;
  }
  ::close(ends[0]);
  while (child > 0 && ::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
  }
  std::vector<std::string> names;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) names.push_back(line);
  return names;
}

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

/// The library's sources below its project, which exist, without those in builds.
std::set<fs::path> sources_of(const fs::path& library, const fs::path& project, const fs::path& build) {
  const std::vector<fs::path> builds = build_folders(project);
  std::set<fs::path> sources;
  for (const fs::path name : line_files_of(library)) {
    std::error_code missing;
    const fs::path file = fs::weakly_canonical(name.is_absolute() ? name : project / name, missing);
    const auto has_it = [&file](const fs::path& folder) { return is_below(file, folder); };
    if (!missing && fs::is_regular_file(file, missing) && is_below(file, project) &&
        std::ranges::none_of(builds, has_it) && (build.empty() || !has_it(build)))
      sources.insert(file);
  }
  return sources;
}

/// The sources of a library, and what is known of their content when it was built.
struct BuiltSources {
  static constexpr const char* unknown = "-";

  std::string library;                     // its hash and the time of its file
  std::map<fs::path, std::string> hashes;  // unknown: the source was newer already

  static BuiltSources read(const fs::path& file) {
    BuiltSources known;
    std::ifstream stream(file);
    std::getline(stream, known.library);
    for (std::string hash, path; stream >> hash && std::getline(stream >> std::ws, path);) known.hashes[path] = hash;
    return known;
  }
  void write(const fs::path& file) const {
    std::error_code failed;
    fs::create_directories(file.parent_path(), failed);
    const fs::path whole = fs::path(file).concat(fmt::format(".{}", ::getpid()));
    std::ofstream stream(whole);
    stream << library << '\n';
    for (const auto& [path, hash] : hashes) stream << hash << ' ' << path.string() << '\n';
    stream.close();
    if (stream) fs::rename(whole, file, failed);
    if (!stream || failed) fs::remove(whole, failed);  // the next check has to read the library again
  }
};

/// What is known of the library; looked up, or else found out now and stored.
BuiltSources built_sources(const fs::path& library, fs::file_time_type built, const fs::path& project) {
  const fs::path build = build_of(library);
  const fs::path file = build / "rehearse-sources" / hash_text(hash_bytes(library.c_str(), library.native().size()));
  BuiltSources now;
  now.library = fmt::format("{} {}", content_hash_of(library), built.time_since_epoch().count());
  if (!build.empty())
    if (BuiltSources before = BuiltSources::read(file); before.library == now.library) return before;
  for (const fs::path& source : sources_of(library, project, build)) {
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

}  // namespace

std::string note_on_old_library(const fs::path& named) {
  std::error_code missing;
  const fs::path library = fs::canonical(named, missing);
  if (missing) return {};
  const fs::file_time_type built = fs::last_write_time(library, missing);
  auto project = find_project(library);
  if (!project) project = find_project("./");
  if (missing || !project) return {};
  std::vector<fs::path> newer;
  for (const auto& [source, hash] : built_sources(library, built, fs::canonical(*project, missing)).hashes) {
    const fs::file_time_type written = fs::last_write_time(source, missing);
    if (!missing && written > built && content_hash_of(source) != hash) newer.push_back(source);
  }
  return newer.empty() ? std::string() : sentence(newer, library);
}

std::vector<std::string> notes_on_old_libraries(const Scenario& scenario, const HostOptions& options) {
  static auto& seen = *new std::set<fs::path>;
  std::vector<std::string> notes;
  const auto look = [&](const ScenarioBody& body, const ScenarioController& controller) {
    const auto library = library_of(scenario, controller, body.name + "/" + controller.name, options);
    if (!library || !seen.insert(*library).second) return;  // a run reports a library that is missing
    if (std::string note = note_on_old_library(*library); !note.empty()) notes.push_back(std::move(note));
  };
  for (const ScenarioBody& body : scenario.bodies)
    for (const ScenarioController& controller : body.controllers) {
      look(body, controller);
      for (const ScenarioController& child : controller.children) look(body, child);
    }
  return notes;
}

void tell_old_libraries(const Scenario& scenario, const HostOptions& options) {
  for (const std::string& note : notes_on_old_libraries(scenario, options)) fmt::print(stderr, "note: {}\n", note);
}

}  // namespace rehearse
