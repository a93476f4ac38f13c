// Output of verbs: text for people, JSON for programs, and files, which don't replace files of a different kind.
#pragma once

#include <rehearse/diagnostic.h>

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text.h"
#include "core/compare/report_json.h"

namespace rehearse::tool {

using Json = nlohmann::ordered_json;

Json json_of(const Diagnostics& diagnostics);
/// The remarks of a command's result, and after them sentences that were printed as notes.
Json json_of_remarks(Diagnostics remarks, const std::vector<std::string>& notes);

/// The version of the JSON objects' form: it increases if a member is removed or changes its meaning.
inline constexpr int json_schema = 1;

/// Writes a file. Fails if there is no room, or no folder.
Result<void> write_text(const std::filesystem::path& file, const std::string& text);

/// Prints the object on stdout, with `schema` first, and a newline. In text that isn't UTF-8, bad bytes are replaced.
void print(const Json& object);
/// Prints a line on stdout, as a result (result_stream.h).
void print_line(std::string_view text);
/// True if one of these has printed anything.
bool has_printed_results();

/// The text as one word of a shell's command line: unchanged if a shell reads it as one word, else in single quotes.
std::string shell_word(std::string_view text);

/// The number of characters of UTF-8 text.
std::size_t width_of(std::string_view text);

/// Breaks text into lines of at most `width` columns. `indent` spaces come before each line but the first, which begins
/// at that column already.
std::string wrapped(std::string_view text, std::size_t width, std::size_t indent);

/// A sentence in at most 160 characters, for one line of a log: cut after a word, with "..." if anything is left out.
std::string headline(std::string_view sentence);

/// The number of columns of the terminal on stdout; 0 if stdout is not a terminal: then text isn't broken into lines.
std::size_t terminal_width();
/// A sentence in lines of the terminal's width, as wrapped() breaks it; as it is if stdout is no terminal.
std::string in_lines(std::string_view sentence, std::size_t indent = 0);
/// From now on, text is formed as for the present stdout, wherever that is redirected to.
void keep_terminal();

enum class TextColor { red, green, yellow };
/// The text in a colour if stdout is a terminal and NO_COLOR isn't set; else the text unchanged.
std::string colored(std::string_view text, TextColor color);

/// "812 bytes", "5.4 MB".
std::string file_size_text(std::uintmax_t bytes);

/// Prints remarks on stderr, except those that contain the message of the failure.
void tell_remarks(const Diagnostics& remarks, const std::optional<Diagnostic>& failure);

/// A log time as text: seconds, or a date if the number is too large for a simulation.
std::string time_text(std::uint64_t time_ns);

using TableRow = std::vector<std::string>;
/// Prints cells in columns as wide as their widest cell; the first row is the heading.
void print_table(const std::vector<TableRow>& rows);

}  // namespace rehearse::tool
