// What verbs print and write: amounts for people, JSON for programs, files that don't replace something else.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/diagnostic.h>

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse::tool {

using Json = nlohmann::ordered_json;

/// JSON has no NaN and no infinities: they become the strings "NaN", "Infinity" and "-Infinity".
Json json_of(double number);
/// Null if there is none; else as to_json(Divergence).
Json json_of(const std::optional<Divergence>& divergence);
Json json_of(const Diagnostics& diagnostics);

/// The version of the form of JSON objects: a member that goes or means something else makes it one more.
inline constexpr int json_schema = 1;

/// The object, with its `schema` first, and a newline, on stdout. Text that isn't UTF-8 has its bad bytes replaced.
void print(const Json& object);

/// Text out of somebody's file, for a terminal: control characters and bytes that aren't UTF-8 as \xNN.
std::string plain_text(std::string_view text);

/// Text in lines of at most `width` columns; `indent` spaces stand before each but the first, which begins there already.
std::string wrapped(std::string_view text, std::size_t width, std::size_t indent);

/// A sentence in at most 160 characters, for a log's line: cut behind a clause, with "..." if anything is left out.
std::string headline(std::string_view sentence);

/// For people: columns of the terminal that stdout is; 0: it is none, and text stays in one line.
std::size_t terminal_width();

enum class TextColor { red, green, yellow };
/// The text in a colour if stdout is a terminal and NO_COLOR isn't set; else the text.
std::string colored(std::string_view text, TextColor color);

/// "812 bytes", "5.4 MB".
std::string file_size_text(std::uintmax_t bytes);
/// "1 link", "3 links".
std::string count_text(std::int64_t count, std::string_view noun);
std::string count_text(std::integral auto count, std::string_view noun) {
  return count_text(static_cast<std::int64_t>(count), noun);
}

/// A log time: seconds, or a date if it can only be one.
std::string time_text(std::uint64_t time_ns);

using TableRow = std::vector<std::string>;
/// Cells in columns as wide as their widest cell; the first row is the heading.
void print_table(const std::vector<TableRow>& rows);

}  // namespace rehearse::tool
