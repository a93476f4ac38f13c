#include "library_origin.h"

#include <elfutils/libdw.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <gelf.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <system_error>

#include "reader_process.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// Functions of libdw and of the libelf that it links; they are loaded only to read libraries: no run depends on them.
struct Libdw {
  decltype(&dwarf_begin) begin = nullptr;
  decltype(&dwarf_end) end = nullptr;
  decltype(&dwarf_nextcu) next_unit = nullptr;
  decltype(&dwarf_offdie) entry_at = nullptr;
  decltype(&dwarf_getsrcfiles) files_of = nullptr;
  decltype(&dwarf_filesrc) name_of = nullptr;
  decltype(&elf_version) version = nullptr;
  decltype(&elf_begin) begin_elf = nullptr;
  decltype(&elf_end) end_elf = nullptr;
  decltype(&elf_nextscn) next_section = nullptr;
  decltype(&gelf_getshdr) header_of = nullptr;
  decltype(&elf_getdata) data_of = nullptr;
  decltype(&gelf_getdyn) entry_of = nullptr;
  decltype(&elf_strptr) text_at = nullptr;

  /// None: it isn't installed.
  static std::optional<Libdw> load() {
    Libdw functions;
    const LibraryFunctions find("libdw.so.1");
    const bool found = find("dwarf_begin", functions.begin) && find("dwarf_end", functions.end) &&
                       find("dwarf_nextcu", functions.next_unit) && find("dwarf_offdie", functions.entry_at) &&
                       find("dwarf_getsrcfiles", functions.files_of) && find("dwarf_filesrc", functions.name_of) &&
                       find("elf_version", functions.version) && find("elf_begin", functions.begin_elf) &&
                       find("elf_end", functions.end_elf) && find("elf_nextscn", functions.next_section) &&
                       find("gelf_getshdr", functions.header_of) && find("elf_getdata", functions.data_of) &&
                       find("gelf_getdyn", functions.entry_of) && find("elf_strptr", functions.text_at);
    return found ? std::optional(functions) : std::nullopt;
  }
};

// The child's output: a line for each fact, which begins with its kind.
constexpr std::string_view source_line = "source ", needed_line = "needed ", searched_line = "searched ";

/// Writes the names of all source files in the line information.
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
    for (std::size_t i = 0; i < count; ++i)
      if (const char* name = dw.name_of(files, i, nullptr, nullptr)) names.insert(name);
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
    for (int i = 0; dw.entry_of(data, i, &entry) && entry.d_tag != DT_NULL; ++i) {
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
