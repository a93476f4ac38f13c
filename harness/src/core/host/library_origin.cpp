#include "library_origin.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <system_error>

#include "core/guard/libdw.h"
#include "core/guard/reader_process.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

// The child's output: a line for each fact, which begins with its kind.
constexpr std::string_view source_line = "source ", needed_line = "needed ", searched_line = "searched ";

/// Writes the names of all source files in the line information. One below the compiler's working folder is written as
/// relative, too: a compiler cache states the folder of the build that it was filled by.
void print_sources(const Libdw& dw, int file, std::FILE* to) {
  Dwarf* const session = dw.begin(file, DWARF_C_READ);
  if (!session) return;
  std::set<std::string> names;
  std::size_t header = 0;
  for (Dwarf_Off unit = 0, next = 0; dw.next_unit(session, unit, &next, &header, nullptr, nullptr, nullptr) == 0;
       unit = next) {
    Dwarf_Die entry;
    Dwarf_Files* files = nullptr;
    std::size_t count = 0;
    if (!dw.entry_at(session, unit + header, &entry) || dw.files_of(&entry, &files, &count) != 0) continue;
    const fs::path folder = dw.folder_of(entry);
    const std::string below = folder.string() + '/';
    for (std::size_t i = 0; i < count; ++i) {
      const char* const stated = dw.file_in(files, i, nullptr, nullptr);
      if (!stated) continue;
      const std::string name = (folder / stated).string();
      names.insert(name);
      if (!folder.empty() && name.starts_with(below)) names.insert(name.substr(below.size()));
    }
  }
  for (const std::string& name : names) fmt::print(to, "{}{}\n", source_line, name);
  dw.end(session);
}

/// Writes what the dynamic section states about linked libraries.
void print_linked(const Libdw& dw, int file, std::FILE* to) {
  dw.version(EV_CURRENT);
  Elf* const elf = dw.begin_elf(file, ELF_C_READ, nullptr);
  Elf_Scn* section = nullptr;
  while (elf && (section = dw.next_section(elf, section)) != nullptr) {
    GElf_Shdr header;
    Elf_Data* const data = dw.data_of(section, nullptr);
    if (!dw.header_of(section, &header) || header.sh_type != SHT_DYNAMIC || !data) continue;
    GElf_Dyn entry;
    for (int i = 0; dw.dynamic_in(data, i, &entry) && entry.d_tag != DT_NULL; ++i) {
      const bool is_needed = entry.d_tag == DT_NEEDED;
      if (!is_needed && entry.d_tag != DT_RUNPATH && entry.d_tag != DT_RPATH) continue;
      if (const char* text = dw.text_at(elf, header.sh_link, entry.d_un.d_val))
        fmt::print(to, "{}{}\n", is_needed ? needed_line : searched_line, text);
    }
  }
  if (elf) dw.end_elf(elf);
}

void print_facts(const fs::path& library, std::FILE* to) {
  const auto dw = Libdw::load();
  const int file = dw ? ::open(library.c_str(), O_RDONLY | O_CLOEXEC) : -1;
  if (file < 0) return;
  print_linked(*dw, file, to);
  print_sources(*dw, file, to);
}

void add_folders(const std::string& list, std::vector<std::string>& folders) {
  std::istringstream parts(list);
  for (std::string folder; std::getline(parts, folder, ':');)
    if (!folder.empty()) folders.push_back(folder);
}

/// The folder of a search, with that of the library in place of $ORIGIN.
fs::path folder_of_search(std::string folder, const fs::path& library) {
  for (const std::string_view word : {"${ORIGIN}", "$ORIGIN"})
    if (const std::size_t at = folder.find(word); at != std::string::npos)
      folder.replace(at, word.size(), library.parent_path().string());
  return folder;
}

}  // namespace

LibraryOrigin origin_of(const fs::path& library) {
  LibraryOrigin origin;
  std::istringstream lines(text_of_child([&](std::FILE* to) { print_facts(library, to); }));
  for (std::string line; std::getline(lines, line);) {
    const auto rest = [&line](std::string_view kind) { return line.substr(kind.size()); };
    if (line.starts_with(source_line)) origin.sources.push_back(rest(source_line));
    if (line.starts_with(needed_line)) origin.needed.push_back(rest(needed_line));
    if (line.starts_with(searched_line)) add_folders(rest(searched_line), origin.searched);
  }
  return origin;
}

std::vector<fs::path> files_of_linked(const LibraryOrigin& origin, const fs::path& library) {
  std::vector<fs::path> files;
  for (const std::string& name : origin.needed) {
    const bool is_path = name.find('/') != std::string::npos;
    std::vector<fs::path> places;
    if (is_path) places.emplace_back(name);
    if (!is_path)
      for (const std::string& folder : origin.searched) places.push_back(folder_of_search(folder, library) / name);
    std::error_code missing;
    const auto there = [&missing](const fs::path& place) { return fs::is_regular_file(place, missing); };
    const auto found = std::ranges::find_if(places, there);
    if (found == places.end()) continue;
    if (fs::path file = fs::canonical(*found, missing); !missing) files.push_back(std::move(file));
  }
  return files;
}

}  // namespace rehearse
