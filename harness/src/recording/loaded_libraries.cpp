#include "loaded_libraries.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>

#include <cstring>
#include <set>
#include <string_view>

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

/// Adds the file names of a library and of the libraries that its dynamic section names.
Result<void> add_needed(const char* library, std::set<std::string>& names) {
  void* handle = ::dlopen(library, RTLD_NOW | RTLD_LOCAL);  // stays loaded
  link_map* map = nullptr;
  if (!handle || ::dlinfo(handle, RTLD_DI_LINKMAP, &map) != 0)
    return error(fmt::format("{} can't be loaded: {}", library, ::dlerror()));
  if (!names.insert(file_name(map->l_name)).second) return {};
  const char* texts = nullptr;
  for (const ElfW(Dyn)* entry = map->l_ld; entry->d_tag != DT_NULL; ++entry)
    if (entry->d_tag == DT_STRTAB) texts = reinterpret_cast<const char*>(entry->d_un.d_ptr);
  for (const ElfW(Dyn)* entry = map->l_ld; entry->d_tag != DT_NULL; ++entry)
    if (entry->d_tag == DT_NEEDED)
      if (auto added = add_needed(texts + entry->d_un.d_val, names); !added) return added;
  return {};
}

}  // namespace

Result<std::map<std::string, LoadedLibrary>> load_library(const std::string& name) {
  std::set<std::string> needed;
  if (auto added = add_needed(name.c_str(), needed); !added) return added.errors();
  auto libraries = loaded_libraries();
  std::erase_if(libraries, [&needed](const auto& entry) { return !needed.contains(entry.first); });
  return libraries;
}

std::map<std::string, LoadedLibrary> loaded_libraries() {
  std::map<std::string, LoadedLibrary> libraries;
  const auto take = [](dl_phdr_info* library, std::size_t, void* into) {
    auto& found = *static_cast<std::map<std::string, LoadedLibrary>*>(into);
    found.emplace(file_name(library->dlpi_name), LoadedLibrary{library->dlpi_name, build_id(*library)});
    return 0;
  };
  dl_iterate_phdr(take, &libraries);
  return libraries;
}

}  // namespace rehearse
