#include "loaded_libraries.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "base/hashing.h"
#include "core/turns/scheduler.h"

namespace rehearse {
namespace {

std::string build_id(const dl_phdr_info& library) {
  for (int i = 0; i < library.dlpi_phnum; ++i) {
    const ElfW(Phdr)& header = library.dlpi_phdr[i];
    if (header.p_type != PT_NOTE) continue;
    const char* at = reinterpret_cast<const char*>(library.dlpi_addr + header.p_vaddr);
    const char* const end = at + header.p_memsz;
    while (at + sizeof(ElfW(Nhdr)) <= end) {
      ElfW(Nhdr) note;
      std::memcpy(&note, at, sizeof note);
      const char* name = at + sizeof note;
      const char* content = name + (note.n_namesz + 3) / 4 * 4;
      if (content + note.n_descsz > end) break;
      if (note.n_type == NT_GNU_BUILD_ID && std::string_view(name, note.n_namesz) == std::string_view("GNU", 4))
        return std::string(content, note.n_descsz);
      at = content + (note.n_descsz + 3) / 4 * 4;
    }
  }
  return {};
}

std::string file_name(std::string_view path) { return std::string(path.substr(path.rfind('/') + 1)); }

/// The parts of the file that the linker loads, without the notes in them, and without the header of the file, which
/// states the size of the debug information.
std::vector<FilePart> parts_in_memory(const dl_phdr_info& library) {
  std::vector<FilePart> parts, notes{{0, sizeof(ElfW(Ehdr))}};
  for (int i = 0; i < library.dlpi_phnum; ++i) {
    const ElfW(Phdr)& header = library.dlpi_phdr[i];
    if (header.p_type == PT_LOAD) parts.push_back({header.p_offset, header.p_filesz});
    if (header.p_type == PT_NOTE) notes.push_back({header.p_offset, header.p_filesz});
  }
  for (const FilePart& note : notes) {
    const auto holds = [&](const FilePart& part) {
      return part.offset <= note.offset && note.offset + note.size <= part.offset + part.size;
    };
    const auto part = std::ranges::find_if(parts, holds);
    if (part == parts.end()) continue;
    const std::uint64_t end = part->offset + part->size, after = note.offset + note.size;
    part->size = note.offset - part->offset;
    parts.insert(part + 1, {after, end - after});
  }
  return parts;
}

/// The inodes of the files in this process's memory, by the address at which each part begins.
std::map<std::uint64_t, std::uint64_t> mapped_inodes() {
  std::map<std::uint64_t, std::uint64_t> inodes;
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    std::uint64_t begin = 0, inode = 0;  // BEGIN-END PERMISSIONS OFFSET DEVICE INODE
    if (std::sscanf(line.c_str(), "%" SCNx64 "-%*s %*s %*s %*s %" SCNu64, &begin, &inode) == 2) inodes[begin] = inode;
  }
  return inodes;
}

std::uint64_t inode_of(const dl_phdr_info& library, const std::map<std::uint64_t, std::uint64_t>& inodes) {
  for (int i = 0; i < library.dlpi_phnum; ++i) {
    if (library.dlpi_phdr[i].p_type != PT_LOAD) continue;
    const auto after = inodes.upper_bound(library.dlpi_addr + library.dlpi_phdr[i].p_vaddr);
    return after == inodes.begin() ? 0 : std::prev(after)->second;
  }
  return 0;
}

/// The loaded library with that file name; null: there is none.
const link_map* find_loaded(const link_map& any, std::string_view name) {
  const link_map* map = &any;
  while (map->l_prev) map = map->l_prev;
  while (map && file_name(map->l_name) != name) map = map->l_next;
  return map;
}

/// Adds the library and those that its dynamic section names, which are loaded with it.
void add_needed(const link_map& library, std::map<std::string, const link_map*>& needed) {
  if (!needed.emplace(file_name(library.l_name), &library).second) return;
  const char* texts = nullptr;
  for (const ElfW(Dyn)* entry = library.l_ld; entry->d_tag != DT_NULL; ++entry)
    if (entry->d_tag == DT_STRTAB) texts = reinterpret_cast<const char*>(entry->d_un.d_ptr);
  for (const ElfW(Dyn)* entry = library.l_ld; entry->d_tag != DT_NULL; ++entry)
    if (entry->d_tag == DT_NEEDED)
      if (const link_map* one = find_loaded(library, texts + entry->d_un.d_val)) add_needed(*one, needed);
}

std::map<std::string, const link_map*> needed_by(void* handle) {
  std::map<std::string, const link_map*> needed;
  link_map* map = nullptr;
  if (::dlinfo(handle, RTLD_DI_LINKMAP, &map) == 0) add_needed(*map, needed);
  return needed;
}

/// True if a relocation of the library refers to one of these functions.
bool refers_to(const link_map& library, const std::set<std::string_view>& functions) {
  const char* texts = nullptr;
  const ElfW(Sym)* symbols = nullptr;
  std::pair<const ElfW(Rela)*, std::size_t> tables[2] = {};  // with their sizes [bytes]
  for (const ElfW(Dyn)* entry = library.l_ld; entry->d_tag != DT_NULL; ++entry) {
    const auto table = [entry] { return reinterpret_cast<const ElfW(Rela)*>(entry->d_un.d_ptr); };   // NOLINT
    if (entry->d_tag == DT_STRTAB) texts = reinterpret_cast<const char*>(entry->d_un.d_ptr);         // NOLINT
    if (entry->d_tag == DT_SYMTAB) symbols = reinterpret_cast<const ElfW(Sym)*>(entry->d_un.d_ptr);  // NOLINT
    if (entry->d_tag == DT_RELA) tables[0].first = table();
    if (entry->d_tag == DT_RELASZ) tables[0].second = entry->d_un.d_val;
    if (entry->d_tag == DT_JMPREL) tables[1].first = table();
    if (entry->d_tag == DT_PLTRELSZ) tables[1].second = entry->d_un.d_val;
  }
  if (!texts || !symbols) return false;
  for (const auto& [table, size] : tables)
    for (std::size_t i = 0; table && i < size / sizeof(ElfW(Rela)); ++i)
      if (const auto symbol = ELF64_R_SYM(table[i].r_info);
          symbol != 0 && functions.contains(texts + symbols[symbol].st_name))
        return true;
  return false;
}

const std::set<std::string> at_start = [] {
  std::set<std::string> names;
  for (const auto& [name, id] : build_ids()) names.insert(name);
  return names;
}();

}  // namespace

const std::set<std::string>& libraries_at_start() { return at_start; }

std::map<std::string, std::string> linked_libraries(void* handle) {
  std::map<std::string, std::string> linked;
  const auto ids = build_ids();
  const link_map* own = nullptr;
  ::dlinfo(handle, RTLD_DI_LINKMAP, &own);
  for (const auto& [name, library] : needed_by(handle)) {
    if (at_start.contains(name) || library == own) continue;
    const auto id = ids.find(name);
    std::string text;
    if (id != ids.end())
      for (const char byte : id->second) text += fmt::format("{:02x}", static_cast<unsigned char>(byte));
    if (text.empty())
      if (const auto hash = hash_of_file(library->l_name)) text = hash_text(*hash);
    linked.emplace(name, text);
  }
  return linked;
}

bool can_start_threads(void* handle) {
  const std::set<std::string_view> functions = {
      "pthread_create", "thrd_create",
      "_ZNSt6thread15_M_start_threadESt10unique_ptrINS_6_StateESt14default_deleteIS1_EEPFvvE"};
  for (const auto& [name, library] : needed_by(handle)) {
    const bool has_no_turns = std::ranges::any_of(
        libraries_without_turns, [&file = name](const char* other) { return file.starts_with(other); });
    if (!at_start.contains(name) && !has_no_turns && refers_to(*library, functions)) return true;
  }
  return false;
}

Result<std::map<std::string, LoadedLibrary>> load_library(const std::string& name) {
  void* handle = ::dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);  // stays loaded
  if (!handle) return error(fmt::format("{} can't be loaded: {}", name, ::dlerror()));
  const auto needed = needed_by(handle);
  auto libraries = loaded_libraries();
  std::erase_if(libraries, [&needed](const auto& entry) { return !needed.contains(entry.first); });
  return libraries;
}

std::map<std::string, LoadedLibrary> loaded_libraries() {
  struct Found {
    std::map<std::uint64_t, std::uint64_t> inodes = mapped_inodes();
    std::map<std::string, LoadedLibrary> libraries = {};
  } found;
  const auto take = [](dl_phdr_info* library, std::size_t, void* into) {
    auto& [inodes, libraries] = *static_cast<Found*>(into);
    libraries.emplace(
        file_name(library->dlpi_name),
        LoadedLibrary{library->dlpi_name, build_id(*library), parts_in_memory(*library), inode_of(*library, inodes)});
    return 0;
  };
  dl_iterate_phdr(take, &found);
  return std::move(found.libraries);
}

std::map<std::string, std::string> build_ids() {
  std::map<std::string, std::string> ids;
  const auto take = [](dl_phdr_info* library, std::size_t, void* into) {
    static_cast<decltype(ids)*>(into)->emplace(file_name(library->dlpi_name), build_id(*library));
    return 0;
  };
  dl_iterate_phdr(take, &ids);
  return ids;
}

Result<std::string> code_hash_of(const LoadedLibrary& library) {
  const std::string path = library.file.empty() ? "/proc/self/exe" : library.file;
  struct stat found = {};
  std::ifstream file(path, std::ios::binary);
  if (!file || stat(path.c_str(), &found) != 0) return error(fmt::format("{} can't be read", path));
  if (found.st_ino != library.inode)
    return error(fmt::format("{} was replaced after this process had loaded it", path));
  RunningHash hash;
  std::array<char, 1 << 17> block;
  for (const FilePart& part : library.parts) {
    file.seekg(static_cast<std::streamoff>(part.offset));
    for (std::uint64_t left = part.size; left > 0;) {
      const std::uint64_t size = std::min<std::uint64_t>(left, block.size());
      if (!file.read(block.data(), static_cast<std::streamsize>(size)))
        return error(fmt::format("{} can't be read", path));
      hash.add(block.data(), size);
      left -= size;
    }
  }
  return hash_text(hash.value());
}

}  // namespace rehearse
