#include "output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

namespace rehearse::tool {
namespace {

/// Characters, of UTF-8.
std::size_t width_of(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

}  // namespace

Json json_of(double number) {
  if (std::isnan(number)) return "NaN";
  if (std::isinf(number)) return number > 0.0 ? "Infinity" : "-Infinity";
  return number;
}

Json json_of(const std::optional<Divergence>& divergence) {
  return divergence ? Json::parse(to_json(*divergence)) : Json(nullptr);
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

void print(const Json& object) { fmt::print("{}\n", object.dump(2, ' ', false, Json::error_handler_t::replace)); }

std::string file_size_text(std::uintmax_t bytes) {
  if (bytes < 1000) return count_text(static_cast<std::int64_t>(bytes), "byte");
  const char* const units[] = {"kB", "MB", "GB", "TB"};
  double amount = static_cast<double>(bytes) / 1000.0;
  std::size_t unit = 0;
  while (amount >= 999.95 && unit + 1 < std::size(units)) {
    amount /= 1000.0;
    ++unit;
  }
  return fmt::format("{:.1f} {}", amount, units[unit]);
}

std::string count_text(std::int64_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
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

Result<void> check_output(const std::filesystem::path& file, std::string_view magic, std::string_view kind) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    return error(fmt::format("can't write {}: it is a directory", file.string()));
  if (!std::filesystem::is_regular_file(file, ignored) || std::filesystem::file_size(file, ignored) == 0) return {};
  std::string begin(magic.size(), '\0');
  std::ifstream(file, std::ios::binary).read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (begin == magic) return {};
  return error(fmt::format("won't replace {}: it exists and is no {}", file.string(), kind),
               "name another file, or remove it first");
}

}  // namespace rehearse::tool
