#include "elf_library.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gelf.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <string_view>

#include "base/file_descriptor.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// The opened file.
class ElfFile {
 public:
  explicit ElfFile(const fs::path& path) : descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    elf_version(EV_CURRENT);
    if (is_open()) elf_ = elf_begin(descriptor_, ELF_C_READ, nullptr);
  }
  ~ElfFile() { elf_end(elf_); }
  ElfFile(const ElfFile&) = delete;
  ElfFile& operator=(const ElfFile&) = delete;
  bool is_open() const { return descriptor_ >= 0; }
  Elf* get() const { return elf_; }

 private:
  FileDescriptor descriptor_;
  Elf* elf_ = nullptr;
};

struct Section {
  Elf_Scn* handle = nullptr;
  GElf_Shdr header{};
  std::string_view name;
  Elf_Data* data = nullptr;  // null: the file has no bytes for it
};

std::optional<std::string> why_unusable(Elf* elf) {
  GElf_Ehdr header;
  if (!elf || elf_kind(elf) != ELF_K_ELF || !gelf_getehdr(elf, &header)) return "is not a shared library";
  if (gelf_getclass(elf) != ELFCLASS64) return "is a library for 32-bit processors";
  if (header.e_machine != EM_X86_64) return "is a library for another kind of processor than x86-64";
  if (header.e_type != ET_DYN) return "is not a shared library, but an object file or a program";
  std::size_t sections = 0;
  if (elf_getshdrnum(elf, &sections) != 0) return "is damaged: its table of sections lies outside of the file";
  if (sections == 0) return "has no table of sections, so it can't be scanned";
  return std::nullopt;
}

/// All sections with their bytes; none if one of them is outside of the file.
std::optional<std::vector<Section>> sections_of(Elf* elf) {
  std::size_t names = 0;
  if (elf_getshdrstrndx(elf, &names) != 0) return std::nullopt;
  std::vector<Section> sections;
  for (Elf_Scn* handle = nullptr; (handle = elf_nextscn(elf, handle));) {
    Section& section = sections.emplace_back();
    section.handle = handle;
    if (!gelf_getshdr(handle, &section.header)) return std::nullopt;
    const char* name = elf_strptr(elf, names, section.header.sh_name);
    if (!name) return std::nullopt;
    section.name = name;
    if (section.header.sh_type == SHT_NOBITS || section.header.sh_size == 0) continue;
    section.data = elf_getdata(handle, nullptr);
    if (!section.data) return std::nullopt;
  }
  return sections;
}

bool holds(const Section& section, std::uint64_t address) {
  return address >= section.header.sh_addr && address - section.header.sh_addr < section.header.sh_size;
}

std::vector<std::uint64_t> startup_functions(const std::vector<Section>& sections) {
  const auto is_table = [](const Section& section) {
    return section.header.sh_type == SHT_INIT_ARRAY || section.name == ".ctors";
  };
  std::vector<std::uint64_t> functions;
  for (const Section& section : sections) {
    if (section.name == ".init") functions.push_back(section.header.sh_addr);
    if (section.header.sh_type != SHT_RELA || !section.data || section.header.sh_entsize == 0) continue;
    const int count = static_cast<int>(section.header.sh_size / section.header.sh_entsize);
    for (int i = 0; i < count; ++i) {
      GElf_Rela relocation;
      if (!gelf_getrela(section.data, i, &relocation) || GELF_R_TYPE(relocation.r_info) != R_X86_64_RELATIVE) continue;
      const auto in_table = [&](const Section& table) { return is_table(table) && holds(table, relocation.r_offset); };
      if (std::ranges::any_of(sections, in_table)) functions.push_back(static_cast<std::uint64_t>(relocation.r_addend));
    }
  }
  return functions;
}

std::vector<std::string> imported_symbols(Elf* elf, const std::vector<Section>& sections) {
  std::vector<std::string> names;
  for (const Section& section : sections) {
    if (section.header.sh_type != SHT_DYNSYM || !section.data || section.header.sh_entsize == 0) continue;
    const int count = static_cast<int>(section.header.sh_size / section.header.sh_entsize);
    for (int i = 0; i < count; ++i) {
      GElf_Sym symbol;
      if (!gelf_getsym(section.data, i, &symbol) || symbol.st_shndx != SHN_UNDEF) continue;
      const char* name = elf_strptr(elf, section.header.sh_link, symbol.st_name);
      if (name && *name) names.emplace_back(name);
    }
  }
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

}  // namespace

Result<ElfLibrary> read_library(const fs::path& path) {
  const std::string name = "controller library '" + path.filename().string() + "' ";
  const ElfFile file(path);
  if (!file.is_open()) return error(fmt::format("{}can't be read: {}", name, std::strerror(errno)));
  if (auto problem = why_unusable(file.get())) return error(name + *problem);
  const auto sections = sections_of(file.get());
  if (!sections) return error(name + "is damaged: a section of it lies outside of the file");

  ElfLibrary library;
  for (const Section& section : *sections) {
    if (!(section.header.sh_flags & SHF_EXECINSTR) || !section.data || section.name.starts_with(".plt")) continue;
    const auto* bytes = static_cast<const std::uint8_t*>(section.data->d_buf);
    library.code.push_back({section.header.sh_addr, {bytes, bytes + section.data->d_size}});
  }
  library.startup = startup_functions(*sections);
  library.imports = imported_symbols(file.get(), *sections);
  return library;
}

}  // namespace rehearse
