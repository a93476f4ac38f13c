// Tables as CSV (RFC 4180). Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// A cell: in quotes if it has commas, quotes or line breaks.
inline std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + '"';
}

/// The cells of a line.
inline std::vector<std::string> csv_cells(std::string_view line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += '"';
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

/// The rows of a file, a line each, with at least the first. Empty lines and those that begin with # are left out.
inline Result<std::vector<std::vector<std::string>>> read_csv(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(stream, line);)
    if (!line.empty() && line != "\r" && line[0] != '#') rows.push_back(csv_cells(line));
  if (!stream.is_open() || stream.bad()) return error_in(file.string(), "the table can't be read");
  if (rows.empty()) return error_in(file.string(), "the table is empty", "expected names of columns in its first line");
  return rows;
}

}  // namespace rehearse
