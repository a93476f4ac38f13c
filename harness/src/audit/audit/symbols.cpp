#include "symbols.h"

#include <cxxabi.h>
#include <dwarf.h>
#include <elfutils/libdw.h>
#include <elfutils/libdwfl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <iterator>
#include <map>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

namespace rehearse {
namespace {

namespace fs = std::filesystem;

std::string file_name(const char* path) { return fs::path(path).filename().string(); }

/// A function of C has no types in its symbol.
std::string with_parentheses(const std::string& name) {
  return name.find('(') == std::string::npos ? name + "()" : name;
}

/// The declaration of a function, where its class is.
Dwarf_Die declaration_of(Dwarf_Die function) {
  for (const unsigned link : {DW_AT_abstract_origin, DW_AT_specification}) {
    Dwarf_Attribute attribute;
    Dwarf_Die origin;
    if (dwarf_formref_die(dwarf_attr(&function, link, &attribute), &origin)) function = origin;
  }
  return function;
}

/// The prefix of a name that was declared in this scope: "Filter::"; empty for scopes without a name, or with an
/// ignored one.
std::string scope_name(Dwarf_Die& scope) {
  const char* const name = dwarf_diename(&scope);
  switch (dwarf_tag(&scope)) {
    case DW_TAG_namespace: return name ? std::string(name) + "::" : "";
    case DW_TAG_structure_type:
    case DW_TAG_class_type: return std::string(name ? name : "{lambda}") + "::";
    case DW_TAG_subprogram: return name ? std::string(name) + "()::" : "";
    default: return "";
  }
}

/// "Filter::update()", by the debug information.
std::string name_of(Dwarf_Die& function) {
  Dwarf_Attribute attribute;
  for (const unsigned name : {DW_AT_linkage_name, DW_AT_MIPS_linkage_name})
    if (const char* linkage = dwarf_formstring(dwarf_attr_integrate(&function, name, &attribute)))
      return demangled(linkage);
  Dwarf_Die declaration = declaration_of(function);
  const char* own_name = dwarf_diename(&declaration);
  if (!own_name) return {};
  std::string name = std::string(own_name) + "()";
  Dwarf_Die* scopes = nullptr;
  const int count = dwarf_getscopes_die(&declaration, &scopes);
  for (int i = 1; i < count; ++i)  // the first is the function itself
    name = scope_name(scopes[i]) + name;
  std::free(scopes);
  return name;
}

/// Appends the functions and blocks in `parent` around an address, outermost first; false if there are none. (libdw's
/// dwarf_getscopes() finds none in some units of clang.)
bool append_scopes(Dwarf_Die& parent, Dwarf_Addr pc, std::vector<Dwarf_Die>& scopes) {
  Dwarf_Die child;
  for (int end = dwarf_child(&parent, &child); end == 0; end = dwarf_siblingof(&child, &child)) {
    if (dwarf_haspc(&child, pc) > 0) {
      scopes.push_back(child);
      append_scopes(child, pc, scopes);
      return true;
    }
    const int tag = dwarf_tag(&child);  // the function may belong to one of these without being in its code
    const bool declares = tag == DW_TAG_namespace || tag == DW_TAG_structure_type || tag == DW_TAG_class_type ||
                          tag == DW_TAG_subprogram || tag == DW_TAG_lexical_block;
    if (declares && append_scopes(child, pc, scopes)) return true;
  }
  return false;
}

/// The functions and blocks around an address, innermost first, each within the next: an inlined function is in the
/// function that calls it.
std::vector<Dwarf_Die> scopes_around(Dwarf_Die& unit, Dwarf_Addr pc) {
  std::vector<Dwarf_Die> scopes;
  append_scopes(unit, pc, scopes);
  std::ranges::reverse(scopes);
  return scopes;
}

/// The place where an inlined function was called; the file is null if it is unknown.
struct CallSite {
  const char* file = nullptr;
  int line = 0;
};

CallSite call_site_of(Dwarf_Die& inlined, Dwarf_Die& unit) {
  Dwarf_Attribute attribute;
  Dwarf_Word file = 0;
  Dwarf_Word line = 0;
  Dwarf_Files* files = nullptr;
  if (dwarf_formudata(dwarf_attr(&inlined, DW_AT_call_file, &attribute), &file) != 0 ||
      dwarf_formudata(dwarf_attr(&inlined, DW_AT_call_line, &attribute), &line) != 0 ||
      dwarf_getsrcfiles(&unit, &files, nullptr) != 0)
    return {};
  return {dwarf_filesrc(files, file, nullptr, nullptr), static_cast<int>(line)};
}

/// The compilation unit with an address of the module, and the difference of the module's addresses from the unit's.
/// Null: the address has no debug information. clang writes no index of addresses (.debug_aranges), so each unit is
/// asked if the index doesn't have the address.
Dwarf_Die* unit_at(Dwfl_Module* module, Dwarf_Addr pc, Dwarf_Addr* bias) {
  if (Dwarf_Die* unit = dwfl_module_addrdie(module, pc, bias)) return unit;
  Dwarf_Die* unit = nullptr;
  while ((unit = dwfl_module_nextcu(module, unit, bias)))
    if (dwarf_haspc(unit, pc - *bias) > 0) return unit;
  return nullptr;
}

char* no_debug_path = nullptr;
const Dwfl_Callbacks callbacks{dwfl_build_id_find_elf, dwfl_standard_find_debuginfo, dwfl_offline_section_address,
                               &no_debug_path};

/// Calls `found` with the first address of each piece of the code of functions in `parent` whose declaration in their
/// class is the compiler's own, and with the address behind the piece.
template <class Found>
void find_implicit(Dwarf_Die& parent, const Found& found) {
  Dwarf_Die child;
  for (int end = dwarf_child(&parent, &child); end == 0; end = dwarf_siblingof(&child, &child)) {
    const int tag = dwarf_tag(&child);
    if (tag == DW_TAG_namespace) find_implicit(child, found);
    if (tag != DW_TAG_subprogram) continue;
    Dwarf_Die declaration = declaration_of(child);
    if (declaration.addr == child.addr || !dwarf_hasattr(&declaration, DW_AT_artificial)) continue;
    Dwarf_Addr base = 0, first = 0, last = 0;
    for (std::ptrdiff_t at = 0; (at = dwarf_ranges(&child, at, &base, &first, &last)) > 0;) found(first, last);
  }
}

/// Appends the rows of a unit. `bias`: of the file's addresses from the unit's.
void append_rows(Dwarf_Die& unit, std::uint64_t bias, std::map<std::string, int>& files, LineTable& table) {
  Dwarf_Lines* lines = nullptr;
  std::size_t count = 0;
  if (dwarf_getsrclines(&unit, &lines, &count) != 0) return;
  Dwarf_Attribute attribute;
  const char* const folder = dwarf_formstring(dwarf_attr(&unit, DW_AT_comp_dir, &attribute));
  std::map<Dwarf_Addr, Dwarf_Addr> implicit;  // the end of each piece, by its begin
  find_implicit(unit, [&](Dwarf_Addr first, Dwarf_Addr last) { implicit[first] = last; });
  for (std::size_t i = 0; i < count; ++i) {
    Dwarf_Line* line = dwarf_onesrcline(lines, i);
    Dwarf_Addr address = 0;
    LineTable::Row row;
    bool ends = false;
    const char* const path = dwarf_linesrc(line, nullptr, nullptr);
    if (!path || dwarf_lineaddr(line, &address) != 0 || dwarf_lineno(line, &row.line) != 0 ||
        dwarf_linebeginstatement(line, &row.is_statement) != 0 || dwarf_lineendsequence(line, &ends) != 0)
      continue;
    const auto [file, is_new] = files.try_emplace(((folder ? fs::path(folder) : fs::path()) / path).lexically_normal(),
                                                  static_cast<int>(table.files.size()));
    if (is_new) table.files.push_back(file->first);
    row.file = file->second;
    row.address = address + bias;
    const auto piece = implicit.upper_bound(address);
    row.is_implicit = piece != implicit.begin() && address < std::prev(piece)->second;
    if (ends) row.line = 0;
    row.is_statement = row.is_statement && row.line > 0;
    table.rows.push_back(row);
  }
}

}  // namespace

bool is_systems_source(std::string_view path) { return path.starts_with("/usr/") || path.starts_with("/rustc/"); }

std::string demangled(const char* symbol) {
  int status = 0;
  char* text = abi::__cxa_demangle(symbol, nullptr, nullptr, &status);
  std::string result = status == 0 && text ? text : symbol;
  std::free(text);
  constexpr std::string_view nameless = "(anonymous namespace)::";
  for (std::size_t at; (at = result.find(nameless)) != std::string::npos;) result.erase(at, nameless.size());
  return result;
}

void Symbols::Close::operator()(Dwfl* session) const { dwfl_end(session); }

Symbols::Symbols(const fs::path& file) : name_(file.filename().string()), session_(dwfl_begin(&callbacks)) {
  if (!session_) return;
  module_ = dwfl_report_offline(session_.get(), name_.c_str(), file.c_str(), -1);
  dwfl_report_end(session_.get(), nullptr, nullptr);
}

Symbols::Found Symbols::find(std::uint64_t address) const {
  if (!module_) return {};
  GElf_Addr bias = 0;
  if (!dwfl_module_getelf(module_, &bias)) return {};
  const Dwarf_Addr pc = address + bias;
  Found found;
  if (const char* name = dwfl_module_addrname(module_, pc)) found.function = with_parentheses(demangled(name));
  const std::string symbol = found.function;

  Dwarf_Addr debug_bias = 0;
  Dwarf_Die* unit = unit_at(module_, pc, &debug_bias);
  Dwarf_Line* line = unit ? dwarf_getsrc_die(unit, pc - debug_bias) : nullptr;
  int number = 0;
  const char* path = line && dwarf_lineno(line, &number) == 0 ? dwarf_linesrc(line, nullptr, nullptr) : nullptr;
  if (!path) return found;
  found.line = fmt::format("{}:{}", file_name(path), number);

  for (Dwarf_Die scope : scopes_around(*unit, pc - debug_bias)) {
    const int tag = dwarf_tag(&scope);
    if (tag != DW_TAG_inlined_subroutine && tag != DW_TAG_subprogram) continue;
    // The symbol of a function has more information, such as the types of its parameters.
    const bool has_symbol = tag == DW_TAG_subprogram && !symbol.empty();
    found.function = has_symbol ? symbol : name_of(scope);
    if (tag == DW_TAG_subprogram || !is_systems_source(path)) break;  // else its caller is reported
    const CallSite site = call_site_of(scope, *unit);
    if (!site.file) break;
    path = site.file;
    found.line = fmt::format("{}:{}", file_name(path), site.line);
  }
  found.is_systems = is_systems_source(path);
  return found;
}

LineTable Symbols::lines() const {
  LineTable table;
  GElf_Addr module_bias = 0;
  if (!module_ || !dwfl_module_getelf(module_, &module_bias)) return table;
  std::map<std::string, int> files;
  Dwarf_Addr unit_bias = 0;
  Dwarf_Die* unit = nullptr;
  while ((unit = dwfl_module_nextcu(module_, unit, &unit_bias)))
    append_rows(*unit, unit_bias - module_bias, files, table);
  // The end of a sequence comes before the begin of the next at one address.
  std::ranges::stable_sort(table.rows, {},
                           [](const LineTable::Row& row) { return std::pair(row.address, row.line > 0); });
  return table;
}

std::string Symbols::compilers() const {
  std::set<std::string> found;
  Dwarf_Addr bias = 0;
  Dwarf_Die* unit = nullptr;
  while (module_ && (unit = dwfl_module_nextcu(module_, unit, &bias))) {
    Dwarf_Attribute attribute;
    if (const char* producer = dwarf_formstring(dwarf_attr(unit, DW_AT_producer, &attribute))) found.insert(producer);
  }
  return fmt::format("{}", fmt::join(found, "; "));
}

std::string Symbols::describe(std::uint64_t address) const {
  const Found found = find(address);
  const std::string line = found.line.empty() ? address_text(address) : found.line;
  return found.function.empty() ? line : fmt::format("{} ({})", found.function, line);
}

std::string Symbols::address_text(std::uint64_t address) const { return fmt::format("{}+{:#x}", name_, address); }

}  // namespace rehearse
