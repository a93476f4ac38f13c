// The names and lines in a library's symbols and debug information.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

struct Dwfl;
struct Dwfl_Module;

namespace rehearse {

/// The table of lines of one file, by the debug information. A row's instructions end where the next row begins.
struct LineTable {
  struct Row {
    std::uint64_t address = 0;  // virtual
    int file = 0;               // index in `files`
    int line = 0;               // 0: no line has these instructions
    bool is_statement = false;  // a statement of this line begins here
    bool is_implicit = false;   // it belongs to a member function that the source doesn't define
  };
  std::vector<std::string> files;  // absolute paths, unless the compiler left out its folder
  std::vector<Row> rows;           // by address
};

/// The symbols of one file. Missing information is an empty text, because a library may be stripped.
class Symbols {
 public:
  explicit Symbols(const std::filesystem::path& file);

  struct Found {
    /// Demangled: "Filter::update()". For inlined functions the innermost that isn't in a header of the system.
    std::string function;
    std::string line;         // of the same function: "filter.cpp:31"
    bool is_systems = false;  // the line is in a header of the compiler or of another package
  };
  /// The function and the line at a virtual address.
  Found find(std::uint64_t address) const;
  /// "Filter::update() (filter.cpp:31)", or a part of it if information is missing, at least "BadFilter.so+0x1139".
  std::string describe(std::uint64_t address) const;
  /// "BadFilter.so+0x1139"
  std::string address_text(std::uint64_t address) const;
  /// Without rows if there is no debug information.
  LineTable lines() const;
  /// The compilers and their options, by the debug information: "GNU C++17 12.2.0 -O2 -g -fPIC"; empty without it.
  std::string compilers() const;

 private:
  struct Close {
    void operator()(Dwfl* session) const;
  };
  std::string name_;
  std::unique_ptr<Dwfl, Close> session_;
  Dwfl_Module* module_ = nullptr;
};

/// True for the path of a header of the compiler or of another package, and for the sources of Rust's own libraries.
bool is_systems_source(std::string_view path);

/// The demangled form of a symbol; the symbol itself if it isn't mangled.
std::string demangled(const char* symbol);

}  // namespace rehearse
