#include "sanitizer.h"

#include <dlfcn.h>
#include <elf.h>
#include <fcntl.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>

#include "base/file_descriptor.h"

namespace rehearse {
namespace {

constexpr Sanitizer sanitizers[] = {
    {"AddressSanitizer", "address", "__asan_init", "libasan.so"},
    {"ThreadSanitizer", "thread", "__tsan_init", "libtsan.so"},
    {"MemorySanitizer", "memory", "__msan_init", ""},
    {"UndefinedBehaviorSanitizer", "undefined", "__ubsan_handle_", "", false},
};

template <class Part>
bool read_at(int file, std::uint64_t offset, Part& part) {
  return ::pread(file, &part, sizeof part, static_cast<off_t>(offset)) == static_cast<ssize_t>(sizeof part);
}

/// The program headers of a library for 64 bits; none of another file.
std::vector<Elf64_Phdr> segments_of(int file) {
  std::vector<Elf64_Phdr> segments;
  Elf64_Ehdr header;
  if (!read_at(file, 0, header) || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) return {};
  if (header.e_ident[EI_CLASS] != ELFCLASS64 || header.e_phentsize != sizeof(Elf64_Phdr)) return {};
  for (int i = 0; i < header.e_phnum; ++i)
    if (!read_at(file, header.e_phoff + i * sizeof(Elf64_Phdr), segments.emplace_back())) return {};
  return segments;
}

/// The names in the dynamic section, each with a zero before it and behind it; empty if there are none.
std::string dynamic_names(int file) {
  constexpr std::uint64_t most = 1 << 28;  // [B], of a damaged file
  const std::vector<Elf64_Phdr> segments = segments_of(file);
  std::uint64_t address = 0, size = 0;
  for (const Elf64_Phdr& segment : segments) {
    if (segment.p_type != PT_DYNAMIC) continue;
    Elf64_Dyn entry;
    for (std::uint64_t at = 0; at + sizeof entry <= segment.p_filesz; at += sizeof entry) {
      if (!read_at(file, segment.p_offset + at, entry) || entry.d_tag == DT_NULL) break;
      if (entry.d_tag == DT_STRTAB) address = entry.d_un.d_ptr;
      if (entry.d_tag == DT_STRSZ) size = entry.d_un.d_val;
    }
  }
  if (size == 0 || size > most) return {};
  for (const Elf64_Phdr& segment : segments) {
    const bool has_it = segment.p_type == PT_LOAD && segment.p_vaddr <= address &&
                        address - segment.p_vaddr < segment.p_filesz &&
                        size <= segment.p_filesz - (address - segment.p_vaddr);
    if (!has_it) continue;
    std::string names(size, '\0');
    const std::uint64_t offset = segment.p_offset + (address - segment.p_vaddr);
    if (::pread(file, names.data(), size, static_cast<off_t>(offset)) == static_cast<ssize_t>(size)) return names;
  }
  return {};
}

}  // namespace

std::vector<Sanitizer> sanitizers_of(const std::filesystem::path& library) {
  std::vector<Sanitizer> found;
  const FileDescriptor file(::open(library.c_str(), O_RDONLY | O_CLOEXEC));
  if (file < 0) return found;
  const std::string names = dynamic_names(file);
  for (const Sanitizer& sanitizer : sanitizers) {
    std::string wanted = '\0' + std::string(sanitizer.symbol);
    if (!sanitizer.symbol.ends_with('_')) wanted += '\0';
    if (names.find(wanted) != std::string::npos) found.push_back(sanitizer);
  }
  return found;
}

bool is_in_process(const Sanitizer& sanitizer) {
  return ::dlsym(RTLD_DEFAULT, std::string(sanitizer.symbol).c_str()) != nullptr;
}

}  // namespace rehearse
