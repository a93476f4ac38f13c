#include "loaded_libraries.h"

#include <link.h>

#include <cstring>
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

}  // namespace

std::map<std::string, LoadedLibrary> loaded_libraries() {
  std::map<std::string, LoadedLibrary> libraries;
  const auto take = [](dl_phdr_info* library, std::size_t, void* into) {
    const std::string_view path = library->dlpi_name;
    auto& found = *static_cast<std::map<std::string, LoadedLibrary>*>(into);
    found.emplace(path.substr(path.rfind('/') + 1), LoadedLibrary{std::string(path), build_id(*library)});
    return 0;
  };
  dl_iterate_phdr(take, &libraries);
  return libraries;
}

}  // namespace rehearse
