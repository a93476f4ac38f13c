#include "libdw.h"

#include <dwarf.h>

#include "reader_process.h"

namespace rehearse {

std::optional<Libdw> Libdw::load() {
  Libdw dw;
  const LibraryFunctions find("libdw.so.1");
  const bool found =
      find("dwarf_begin", dw.begin) && find("dwarf_end", dw.end) && find("dwarf_nextcu", dw.next_unit) &&
      find("dwarf_offdie", dw.entry_at) && find("dwarf_haspc", dw.has_address) &&
      find("dwarf_getsrc_die", dw.line_at) && find("dwarf_lineno", dw.number_of) && find("dwarf_linesrc", dw.file_of) &&
      find("dwarf_getscopes", dw.scopes_at) && find("dwarf_getscopes_die", dw.scopes_of) &&
      find("dwarf_tag", dw.tag_of) && find("dwarf_attr", dw.attribute_of) && find("dwarf_formudata", dw.number_in) &&
      find("dwarf_formstring", dw.text_in) && find("dwarf_getsrcfiles", dw.files_of) &&
      find("dwarf_filesrc", dw.file_in) && find("elf_version", dw.version) && find("elf_begin", dw.begin_elf) &&
      find("elf_end", dw.end_elf) && find("elf_nextscn", dw.next_section) && find("gelf_getshdr", dw.header_of) &&
      find("elf_getdata", dw.data_of) && find("gelf_getdyn", dw.dynamic_in) && find("elf_strptr", dw.text_at);
  return found ? std::optional(dw) : std::nullopt;
}

std::filesystem::path Libdw::folder_of(Dwarf_Die& unit) const {
  Dwarf_Attribute attribute;
  const char* const folder = text_in(attribute_of(&unit, DW_AT_comp_dir, &attribute));
  return folder ? folder : "";
}

Dwarf_Word Libdw::number(Dwarf_Die& entry, unsigned name) const {
  Dwarf_Attribute attribute;
  Dwarf_Word value = 0;
  return number_in(attribute_of(&entry, name, &attribute), &value) == 0 ? value : 0;
}

}  // namespace rehearse
