// The line of a source that an address of the code belongs to, by the debug information.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace rehearse {

struct SourceLine {
  std::filesystem::path file;  // absolute, unless the compiler left out its folder
  int line = 0;

  /// "walk.cpp:42: ", for the beginning of a message.
  std::string text() const;
  /// The line at the beginning of a message, as text() writes it: the file without its folder. None: there is none.
  static std::optional<SourceLine> at_beginning_of(std::string_view message);
};

/// The line at a virtual address of a library. Of a function that was inlined from a header of another package, the
/// line that calls it. None: the library has no debug information there, or libdw isn't installed. A child process
/// reads it.
std::optional<SourceLine> source_line_at(const std::filesystem::path& library, std::uint64_t address);

/// The same for an address in this process. Null: none.
std::optional<SourceLine> source_line_of(const void* place);
/// Of calls, the innermost first and null behind the last one: the line of the first that isn't in a header of another
/// package, or else of the first.
std::optional<SourceLine> source_line_of(std::span<const void* const> calls);

}  // namespace rehearse
