// The names and lines in a library's symbols and debug information.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

struct Dwfl;
struct Dwfl_Module;

namespace rehearse {

/// Of one file. All that can't be found out is an empty text: a library may be stripped, and is somebody else's.
class Symbols {
 public:
  explicit Symbols(const std::filesystem::path& file);

  /// The function at a virtual address, demangled: "Filter::update()". Of inlined functions the innermost that isn't in
  /// a header of the system.
  std::string function_at(std::uint64_t address) const;
  /// "filter.cpp:31", of the same function.
  std::string line_at(std::uint64_t address) const;
  /// "Filter::update() (filter.cpp:31)", or as much of it as there is, at least "BadFilter.so+0x1139".
  std::string describe(std::uint64_t address) const;
  /// Its line is one of the compiler's or another package's header; false if it has no line.
  bool is_in_system_header(std::uint64_t address) const;
  /// "BadFilter.so+0x1139"
  std::string address_text(std::uint64_t address) const;
  bool has_lines() const;

 private:
  struct Found {
    std::string function;
    std::string line;
    bool is_systems = false;
  };
  Found find(std::uint64_t address) const;

  struct Close {
    void operator()(Dwfl* session) const;
  };
  std::string name_;
  std::unique_ptr<Dwfl, Close> session_;
  Dwfl_Module* module_ = nullptr;
};

/// A symbol as a person writes it; itself if it isn't mangled.
std::string demangled(const char* symbol);

}  // namespace rehearse
