#include "obj_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string>

namespace rehearse {
namespace {

constexpr std::string_view blanks = " \t\r";

/// Removes the next word from the front of the rest of a line and returns it; empty if there is none.
std::string_view next_word(std::string_view& rest) {
  rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
  const std::string_view word = rest.substr(0, std::min(rest.find_first_of(blanks), rest.size()));
  rest.remove_prefix(word.size());
  return word;
}

class ObjCheck {
 public:
  /// Checks one line. The error doesn't contain the line number.
  std::optional<Diagnostic> read(std::string_view line, int number) {
    const std::string_view word = next_word(line);
    if (word == "v") return read_vertex(line);
    if (word == "vt") ++kinds_[1].count;
    if (word == "vn") ++kinds_[2].count;
    if (word == "f") return read_face(line, number);
    return std::nullopt;
  }

  /// Checks references to elements that follow later in the file; possible only at the end.
  std::optional<Diagnostic> finish() const {
    for (const Kind& kind : kinds_) {
      if (kind.highest > kind.count) return beyond(kind, kind.highest, kind.line);
    }
    return std::nullopt;
  }

 private:
  struct Kind {
    const char* name;
    long count = 0;
    long highest = 0;  // index to which a face refers
    int line = 0;      // of that face
  };

  static Diagnostic beyond(const Kind& kind, long index, int line) {
    Diagnostic problem = error(fmt::format("a face refers to {} {}, and there are {}; the file may be truncated",
                                           kind.name, index, kind.count));
    problem.line = line;
    return problem;
  }

  std::optional<Diagnostic> read_vertex(std::string_view rest) {
    ++kinds_[0].count;
    for (int i = 0; i < 3; ++i) {
      if (next_word(rest).empty()) return error("a vertex has fewer than three numbers; the file may be truncated");
    }
    return std::nullopt;
  }

  std::optional<Diagnostic> read_face(std::string_view rest, int line) {
    int corners = 0;
    for (std::string_view corner = next_word(rest); !corner.empty(); corner = next_word(rest), ++corners) {
      if (auto problem = read_corner(corner, line)) return problem;
    }
    if (corners < 3) return error("a face has fewer than three corners; the file may be truncated");
    return std::nullopt;
  }

  /// A corner is vertex, texture coordinate and normal as in 1, 1/2, 1//3 and 1/2/3; negative indices count back from
  /// the current line.
  std::optional<Diagnostic> read_corner(std::string_view corner, int line) {
    const std::string whole(corner.substr(0, 40));
    for (std::size_t k = 0; k < kinds_.size() && (k == 0 || !corner.empty()); ++k) {
      Kind& kind = kinds_[k];
      if (k > 0) corner.remove_prefix(1);  // the slash
      const bool is_left_out = k > 0 && (corner.empty() || corner.front() == '/');
      if (is_left_out) continue;
      long index = 0;
      const auto [end, problem] = std::from_chars(corner.data(), corner.data() + corner.size(), index);
      corner.remove_prefix(static_cast<std::size_t>(end - corner.data()));
      if (problem != std::errc() || index == 0 || !(corner.empty() || corner.front() == '/')) {
        return error(fmt::format("a face has the corner '{}'", whole), "as in 1, 1/2, 1//3 or 1/2/3");
      }
      if (-index > kind.count) return beyond(kind, index, line);
      if (index > kind.highest) {
        kind.highest = index;
        kind.line = line;
      }
    }
    return std::nullopt;
  }

  std::array<Kind, 3> kinds_{{{"vertex"}, {"texture coordinate"}, {"normal"}}};
};

}  // namespace

Result<void> check_obj(std::string_view text) {
  ObjCheck check;
  std::string joined;  // a line that ends with a backslash continues on the next line
  int number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.ends_with('\\') && !text.empty()) {
      line.remove_suffix(1);
      joined.append(line).append(" ");
      continue;
    }
    if (!joined.empty()) joined.append(line);
    auto problem = check.read(joined.empty() ? line : std::string_view(joined), number);
    joined.clear();
    if (!problem) continue;
    if (problem->line == 0) problem->line = number;
    return *problem;
  }
  if (auto problem = check.finish()) return *problem;
  return {};
}

}  // namespace rehearse
