#include "yaml_mistakes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {
namespace {

constexpr std::size_t none = std::string_view::npos;

/// A line that isn't blank and no comment.
struct Line {
  int number = 0;           // 1-based
  std::size_t indent = 0;   // characters before its first one
  std::string_view inside;  // without indentation and comment
  bool has_tab = false;     // in the indentation

  bool is_item() const { return inside == "-" || inside.starts_with("- "); }
  /// The key of "key: value" or of "- key: value"; empty if it has none.
  std::string_view key() const {
    const std::string_view rest = inside.substr(item_width());
    if (rest.empty() || std::string_view("{[\"'|>").find(rest[0]) != none) return {};
    const std::size_t colon = rest.ends_with(':') ? std::min(rest.find(": "), rest.size() - 1) : rest.find(": ");
    return colon == none ? std::string_view() : rest.substr(0, colon);
  }
  /// The width of "- ", or 0.
  std::size_t item_width() const { return is_item() ? std::min(inside.find_first_not_of(' ', 1), inside.size()) : 0; }
};

std::vector<Line> lines_of(std::string_view text) {
  std::vector<Line> lines;
  for (int number = 1; !text.empty(); ++number) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    const std::size_t indent = std::min(line.find_first_not_of(" \t"), line.size());
    const bool has_tab = line.substr(0, indent).find('\t') != none;
    line.remove_prefix(indent);
    if (line.starts_with('#')) continue;
    line = line.substr(0, line.find(" #"));
    line = line.substr(0, line.find_last_not_of(" \t\r") + 1);
    if (!line.empty()) lines.push_back({number, indent, line, has_tab});
  }
  return lines;
}

struct Bracket {
  char opening;
  int line;
  int column;
};

/// The last bracket before the place that isn't closed, outside of quotes.
std::optional<Bracket> open_bracket(const std::vector<Line>& lines, int line, int column) {
  std::vector<Bracket> open;
  for (const Line& one : lines) {
    char quote = '\0';
    for (std::size_t i = 0; i < one.inside.size(); ++i) {
      const char c = one.inside[i];
      const int at = static_cast<int>(one.indent + i) + 1;
      if (one.number > line || (one.number == line && at >= column)) break;
      if (quote != '\0') {
        if (c == quote) quote = '\0';
      } else if ((c == '"' || c == '\'') && (i == 0 || std::string_view(" [{,").find(one.inside[i - 1]) != none)) {
        quote = c;
      } else if (c == '[' || c == '{') {
        open.push_back({c, one.number, at});
      } else if ((c == ']' || c == '}') && !open.empty()) {
        open.pop_back();
      }
    }
  }
  return open.empty() ? std::nullopt : std::optional<Bracket>(open.back());
}

/// The columns, from 0, at which keys or items above the line may continue.
std::set<std::size_t> open_indents(const std::vector<Line>& lines, std::size_t index) {
  std::set<std::size_t> indents;
  std::size_t least = none;
  for (std::size_t i = index; i-- > 0;) {
    const Line& line = lines[i];
    if (line.is_item() && !line.key().empty() && line.indent + line.item_width() < least)
      indents.insert(line.indent + line.item_width());
    if (line.indent < least) indents.insert(least = line.indent);
  }
  return indents;
}

/// The line of a level above that is a sibling of the line; null if there is none.
const Line* sibling_of(const std::vector<Line>& lines, std::size_t index) {
  for (std::size_t i = index; i-- > 0;) {
    if (lines[i].indent == lines[index].indent) return &lines[i];
    if (lines[i].indent < lines[index].indent) return nullptr;
  }
  return nullptr;
}

struct Mistake {
  std::string message;
  std::string hint;
  int line = 0, column = 0;  // 0: as they were
};

Mistake at_indentation(const Line& line, std::string message, std::string hint) {
  return {std::move(message), std::move(hint), line.number, static_cast<int>(line.indent) + 1};
}

/// "column 1, 3 or 5".
std::string columns_text(const std::set<std::size_t>& indents) {
  std::string text = "column ";
  for (auto indent = indents.begin(); indent != indents.end(); ++indent) {
    if (indent != indents.begin()) text += std::next(indent) == indents.end() ? " or " : ", ";
    text += std::to_string(*indent + 1);
  }
  return text;
}

Mistake wrong_indentation(const std::vector<Line>& lines, std::size_t index) {
  return at_indentation(lines[index], "the indentation of this line fits no line above",
                        fmt::format("it begins in column {}, those above it in {}", lines[index].indent + 1,
                                    columns_text(open_indents(lines, index))));
}

/// The mistake of a line that neither continues the map or list above nor ends it.
std::optional<Mistake> misplaced(const std::vector<Line>& lines, std::size_t index) {
  const Line& line = lines[index];
  if (open_indents(lines, index).count(line.indent) == 0) return wrong_indentation(lines, index);
  const Line* sibling = sibling_of(lines, index);
  if (sibling == nullptr || sibling->is_item() == line.is_item()) return std::nullopt;
  if (line.is_item())
    return at_indentation(line, "an item of a list ('- ') stands among keys", "indent it below the key of its list");
  return at_indentation(line, "a key stands among the items of a list",
                        "begin an item with '- ', or indent a key as far as the other keys of its item");
}

/// The mistake before a ':' that begins no value.
std::optional<Mistake> value_without_key(const std::vector<Line>& lines, std::size_t index, int column) {
  const Line& line = lines[index];
  const std::size_t colon = static_cast<std::size_t>(column) - 1 - line.indent;
  if (line.inside.substr(0, colon).find(": ") != none)
    return Mistake{"there is a second ': ' in this line", "put text that contains ': ' in quotes"};
  if (index == 0) return std::nullopt;
  const Line& above = lines[index - 1];
  if (!above.key().empty() && line.indent > above.indent) return wrong_indentation(lines, index);
  if (!above.key().empty() || above.is_item()) return std::nullopt;
  if (above.inside.find(':') != none)
    return at_indentation(above, "a blank is missing after the ':' of this line", "expected KEY: VALUE");
  return at_indentation(above, "this line has no ':'", "expected KEY: VALUE");
}

std::optional<Mistake> mistake_of(const std::vector<Line>& lines, const Diagnostic& raw) {
  const std::string& message = raw.message;
  const auto found = std::ranges::find_if(lines, [&](const Line& line) { return line.number == raw.line; });
  if (found != lines.end() && found->has_tab)
    return Mistake{"there is a tab in the indentation of this line", "indent with spaces"};
  const bool is_value = message == "illegal map value";
  if (is_value && found != lines.end() && found->inside[0] == '-' && !found->is_item())
    return at_indentation(*found, "a blank is missing after the '-' of this line",
                          "an item of a list begins with '- '");
  if (message == "illegal flow end") return Mistake{"this bracket closes none", "remove it, or add the opening one"};
  const bool is_in_form = is_value || message == "illegal block entry" || message.ends_with(" not found");
  const auto open = open_bracket(lines, raw.line, raw.column);
  if (is_in_form && open && open_bracket(lines, std::numeric_limits<int>::max(), 0))
    return Mistake{fmt::format("this '{}' isn't closed", open->opening),
                   fmt::format("add the '{}'", open->opening == '[' ? ']' : '}'), open->line, open->column};
  if (message.ends_with(" flow not found"))
    return Mistake{"a ',' is missing here, or a ':' is one too many",
                   "in brackets: [A, B] or {KEY: VALUE, KEY: VALUE}"};
  if (found == lines.end()) return std::nullopt;
  const auto index = static_cast<std::size_t>(found - lines.begin());
  if (is_value) return value_without_key(lines, index, raw.column);
  if (message == "end of map not found" || message == "end of sequence not found") return misplaced(lines, index);
  if (message == "a second document in the file" && index > 0 && !found->inside.starts_with("---") &&
      !lines[index - 1].inside.starts_with("---"))
    return wrong_indentation(lines, index);
  return std::nullopt;
}

}  // namespace

void explain_yaml_mistake(std::string_view text, Diagnostic& diagnostic) {
  Mistake mistake = mistake_of(lines_of(text), diagnostic)
                        .value_or(Mistake{diagnostic.message,
                                          "expected one YAML document; check indentation, brackets and quotes around "
                                          "here"});
  diagnostic.message = "it can't be read as YAML: " + mistake.message;
  diagnostic.hint = std::move(mistake.hint);
  if (mistake.line > 0) diagnostic.line = mistake.line;
  if (mistake.column > 0) diagnostic.column = mistake.column;
}

}  // namespace rehearse
