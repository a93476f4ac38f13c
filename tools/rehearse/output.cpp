#include "output.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>

#include "base/text.h"
#include "base/write_hint.h"
#include "core/guard/result_stream.h"
#include "progress.h"

namespace rehearse::tool {

std::size_t width_of(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string shell_word(std::string_view text) {
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || std::strchr("_./+-,:=@%", c);
  };
  if (!text.empty() && std::ranges::all_of(text, is_plain)) return std::string(text);
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

Json json_of(const Diagnostics& diagnostics) {
  Json list = Json::array();
  for (const Diagnostic& diagnostic : diagnostics)
    list.push_back({{"file", diagnostic.file},
                    {"line", diagnostic.line},
                    {"column", diagnostic.column},
                    {"severity", to_string(diagnostic.severity)},
                    {"message", diagnostic.message},
                    {"hint", diagnostic.hint}});
  return list;
}

Json json_of_remarks(Diagnostics remarks, const std::vector<std::string>& notes) {
  for (const std::string& note : notes) {
    Diagnostic& remark = remarks.emplace_back();
    remark.severity = Severity::note;
    remark.message = note;
  }
  return json_of(remarks);
}

Result<void> write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  return stream ? Result<void>()
                : error_in(file.string(), "the file can't be written", write_hint(file, "name another file"));
}

void print(const Json& object) {
  Json numbered{{"schema", json_schema}};
  numbered.update(object);
  print_line(numbered.dump(2, ' ', false, Json::error_handler_t::replace));
}

namespace {
bool printed_any = false;
}

void print_line(std::string_view text) {
  printed_any = true;
  std::FILE* const results = result_stream();  // fmt would throw on a full disk
  std::fwrite(text.data(), 1, text.size(), results);
  std::fputc('\n', results);
}

bool has_printed_results() { return printed_any; }

std::string wrapped(std::string_view text, std::size_t width, std::size_t indent) {
  std::string lines;
  std::size_t column = indent;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::size_t needed = width_of(word) + (column > indent ? 1 : 0);
    if (column > indent && column + needed > width) {
      lines += '\n' + std::string(indent, ' ');
      column = indent;
    } else if (column > indent) {
      lines += ' ';
      ++column;
    }
    lines += word;
    column += width_of(word);
  }
  return lines;
}

std::string headline(std::string_view sentence) {
  constexpr std::size_t longest = 160;
  if (width_of(sentence) <= longest) return std::string(sentence);
  return fmt::format("{} ...", sentence.substr(0, sentence.rfind(' ', longest - 4)));
}

namespace {
std::optional<std::size_t> kept_width;  // of the terminal; 0: there is none
}

void keep_terminal() { kept_width = terminal_width(); }

std::string in_lines(std::string_view sentence, std::size_t indent) {
  return terminal_width() > 0 ? wrapped(sentence, terminal_width(), indent) : std::string(sentence);
}

std::size_t terminal_width() {
  if (kept_width) return *kept_width;
  if (!is_terminal(stdout)) return 0;
  winsize size{};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col : 80;
}

std::string colored(std::string_view text, TextColor color) {
  const char* refused = std::getenv("NO_COLOR");
  if ((refused && *refused) || terminal_width() == 0) return std::string(text);
  const int code = color == TextColor::red ? 31 : color == TextColor::green ? 32 : 33;
  return fmt::format("\x1b[{}m{}\x1b[0m", code, text);
}

std::string file_size_text(std::uintmax_t bytes) {
  if (bytes < 1000) return count_text(bytes, "byte");
  const char* const units[] = {"kB", "MB", "GB", "TB"};
  double amount = static_cast<double>(bytes) / 1000.0;
  std::size_t unit = 0;
  while (amount >= 999.95 && unit + 1 < std::size(units)) {
    amount /= 1000.0;
    ++unit;
  }
  return fmt::format("{:.1f} {}", amount, units[unit]);
}

void tell_remarks(const Diagnostics& remarks, const std::optional<Diagnostic>& failure) {
  for (const Diagnostic& remark : remarks)
    if (!failure || remark.message.find(failure->message) == std::string::npos)
      fmt::print(stderr, "{}\n", to_string(remark));
}

std::string time_text(std::uint64_t time_ns) {
  constexpr std::uint64_t wall_clock_begins = 100'000'000'000'000'000;  // [ns]
  if (time_ns < wall_clock_begins) return fmt::format("{:.15g} s", static_cast<double>(time_ns) / 1e9);
  const auto seconds = static_cast<std::time_t>(time_ns / 1'000'000'000);
  return fmt::format("{:%Y-%m-%d %H:%M:%S}.{:09} UTC", fmt::gmtime(seconds), time_ns % 1'000'000'000);
}

void print_table(const std::vector<TableRow>& rows) {
  std::vector<std::size_t> widths(rows[0].size(), 0);
  for (const TableRow& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width_of(row[i]));
  for (const TableRow& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i)
      line += "  " + row[i] + std::string(i + 1 == row.size() ? 0 : widths[i] - width_of(row[i]), ' ');
    fmt::print("{}\n", line);
  }
}

}  // namespace rehearse::tool
