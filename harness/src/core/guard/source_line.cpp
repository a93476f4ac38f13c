#include "source_line.h"

#include <dlfcn.h>
#include <dwarf.h>
#include <fcntl.h>
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include "base/text.h"
#include "libdw.h"
#include "reader_process.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

bool is_of_another_package(std::string_view file) {
  if (file.starts_with("/usr/")) return true;
  for (const std::string_view folder : {"/cnoid/", "/Eigen/"})
    if (file.find(folder) != std::string_view::npos) return true;
  return false;
}

/// The line at an address of a unit that has it.
SourceLine line_in(const Libdw& dw, Dwarf_Die& unit, Dwarf_Addr address) {
  SourceLine found;
  Dwarf_Line* const row = dw.line_at(&unit, address);
  const char* file = row ? dw.file_of(row, nullptr, nullptr) : nullptr;
  if (!file || dw.number_of(row, &found.line) != 0) return {};
  // The outer scopes of an inlined function are those of its definition; those of the entry are its callers.
  Dwarf_Die *innermost = nullptr, *scopes = nullptr;
  const int count = dw.scopes_at(&unit, address, &innermost) > 0 ? dw.scopes_of(innermost, &scopes) : 0;
  Dwarf_Files* files = nullptr;
  for (int i = 0; i < count && is_of_another_package(file); ++i) {
    if (dw.tag_of(&scopes[i]) != DW_TAG_inlined_subroutine) continue;
    if (dw.files_of(&unit, &files, nullptr) != 0) break;
    const char* const caller = dw.file_in(files, dw.number(scopes[i], DW_AT_call_file), nullptr, nullptr);
    if (!caller) break;
    file = caller;
    found.line = static_cast<int>(dw.number(scopes[i], DW_AT_call_line));
  }
  found.file = (dw.folder_of(unit) / file).lexically_normal();
  return found;
}

void print_line_at(const fs::path& library, Dwarf_Addr address, std::FILE* to) {
  const auto dw = Libdw::load();
  const int file = dw ? ::open(library.c_str(), O_RDONLY | O_CLOEXEC) : -1;
  Dwarf* const session = file < 0 ? nullptr : dw->begin(file, DWARF_C_READ);
  if (!session) return;
  std::size_t header = 0;
  for (Dwarf_Off unit = 0, next = 0; dw->next_unit(session, unit, &next, &header, nullptr, nullptr, nullptr) == 0;
       unit = next) {
    Dwarf_Die entry;
    if (!dw->entry_at(session, unit + header, &entry) || dw->has_address(&entry, address) <= 0) continue;
    const SourceLine found = line_in(*dw, entry, address);
    if (found.line > 0) fmt::print(to, "{} {}", found.line, found.file.string());
    return;
  }
}

}  // namespace

std::string SourceLine::text() const { return fmt::format("{}:{}: ", file.filename().string(), line); }

std::optional<SourceLine> SourceLine::at_beginning_of(std::string_view message) {
  const std::size_t colon = message.find(':'), end = message.find(": ", colon + 1);
  if (colon == std::string_view::npos || end == std::string_view::npos) return std::nullopt;
  const std::string_view file = message.substr(0, colon);
  const auto line = number_in<int>(message.substr(colon + 1, end - colon - 1));
  if (!line || file.empty() || file.find(' ') != std::string_view::npos) return std::nullopt;
  return SourceLine{std::string(file), *line};
}
std::optional<SourceLine> source_line_at(const fs::path& library, std::uint64_t address) {
  const std::string text = text_of_child([&](std::FILE* to) { print_line_at(library, address, to); });
  const std::size_t space = text.find(' ');
  if (space == std::string::npos) return std::nullopt;
  return SourceLine{text.substr(space + 1), std::atoi(text.c_str())};
}

std::optional<SourceLine> source_line_of(const void* place) {
  Dl_info object{};
  if (!place || ::dladdr(place, &object) == 0 || !object.dli_fname) return std::nullopt;
  const auto distance = static_cast<const char*>(place) - static_cast<const char*>(object.dli_fbase);
  return source_line_at(object.dli_fname, static_cast<std::uint64_t>(distance));
}

std::optional<SourceLine> source_line_of(std::span<const void* const> calls) {
  std::optional<SourceLine> first;
  for (const void* const place : calls) {
    if (!place) break;
    std::optional<SourceLine> line = source_line_of(place);
    if (line && !is_of_another_package(line->file.native())) return line;
    if (!first) first = std::move(line);
  }
  return first;
}

}  // namespace rehearse
