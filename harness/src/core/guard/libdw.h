// Functions of libdw and of the libelf that it links. They are loaded only to read libraries: no run depends on them.
#pragma once

#include <elfutils/libdw.h>
#include <gelf.h>

#include <filesystem>
#include <optional>

namespace rehearse {

struct Libdw {
  decltype(&dwarf_begin) begin = nullptr;
  decltype(&dwarf_end) end = nullptr;
  decltype(&dwarf_nextcu) next_unit = nullptr;
  decltype(&dwarf_offdie) entry_at = nullptr;
  decltype(&dwarf_haspc) has_address = nullptr;
  decltype(&dwarf_getsrc_die) line_at = nullptr;
  decltype(&dwarf_lineno) number_of = nullptr;
  decltype(&dwarf_linesrc) file_of = nullptr;
  decltype(&dwarf_getscopes) scopes_at = nullptr;
  decltype(&dwarf_getscopes_die) scopes_of = nullptr;
  decltype(&dwarf_tag) tag_of = nullptr;
  decltype(&dwarf_attr) attribute_of = nullptr;
  decltype(&dwarf_formudata) number_in = nullptr;
  decltype(&dwarf_formstring) text_in = nullptr;
  decltype(&dwarf_getsrcfiles) files_of = nullptr;
  decltype(&dwarf_filesrc) file_in = nullptr;
  decltype(&elf_version) version = nullptr;
  decltype(&elf_begin) begin_elf = nullptr;
  decltype(&elf_end) end_elf = nullptr;
  decltype(&elf_nextscn) next_section = nullptr;
  decltype(&gelf_getshdr) header_of = nullptr;
  decltype(&elf_getdata) data_of = nullptr;
  decltype(&gelf_getdyn) dynamic_in = nullptr;
  decltype(&elf_strptr) text_at = nullptr;

  /// None: it isn't installed.
  static std::optional<Libdw> load();

  /// The working folder of the compiler, to which relative names of the unit's files refer; empty: it isn't stated.
  std::filesystem::path folder_of(Dwarf_Die& unit) const;

  /// The number of an attribute; 0: it has none.
  Dwarf_Word number(Dwarf_Die& entry, unsigned name) const;
};

}  // namespace rehearse
