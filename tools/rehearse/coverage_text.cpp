#include "coverage_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "output.h"

namespace rehearse::tool {
namespace {

constexpr std::size_t most_rows = 20;

/// The lines of a source file; none if it can't be read.
std::vector<std::string> source_of(const std::filesystem::path& file) {
  std::vector<std::string> lines;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string text_at(const std::vector<std::string>& source, int line) {
  if (line > static_cast<int>(source.size())) return "";
  const std::string& text = source[static_cast<std::size_t>(line - 1)];
  const std::size_t begin = text.find_first_not_of(" \t");
  return begin == std::string::npos ? "" : plain_text(text.substr(begin));
}

/// "Filter::update(double) const": "Filter::update()"
std::string without_parameters(const std::string& function) {
  int depth = 0;
  for (std::size_t at = function.rfind(')'); at < function.size(); --at) {
    depth += function[at] == ')' ? 1 : function[at] == '(' ? -1 : 0;
    if (depth == 0) return function.substr(0, at) + "()";
  }
  return function;
}

bool goes_one_way(const CoveredLine& line) {
  return line.first && std::ranges::any_of(line.ways, [](const CoveredWay& way) { return !way.first && way.is_known; });
}

/// The rows of a file's lines that were never executed. Lines that follow each other in a function are one row.
void append_unexecuted(const CoveredFile& file, std::vector<TableRow>& rows) {
  const std::vector<std::string> source = source_of(file.file);
  const std::string name = file.file.filename().string();
  for (auto line = file.lines.begin(); line != file.lines.end(); ++line) {
    if (line->first) continue;
    auto last = line;
    while (last + 1 != file.lines.end() && !(last + 1)->first && (last + 1)->function == line->function) ++last;
    rows.push_back(
        {last == line ? fmt::format("{}:{}", name, line->line) : fmt::format("{}:{}-{}", name, line->line, last->line),
         without_parameters(line->function), text_at(source, line->line)});
    line = last;
  }
}

void append_one_way(const CoveredFile& file, std::vector<TableRow>& rows) {
  const std::vector<std::string> source = source_of(file.file);
  for (const CoveredLine& line : file.lines)
    if (goes_one_way(line))
      rows.push_back({fmt::format("{}:{}", file.file.filename().string(), line.line), without_parameters(line.function),
                      text_at(source, line.line)});
}

/// The first row is the heading.
void print_rows(std::vector<TableRow> rows, bool verbose) {
  const std::size_t left_out = verbose || rows.size() <= most_rows + 1 ? 0 : rows.size() - most_rows - 1;
  rows.resize(rows.size() - left_out);
  if (rows.size() > 1) print_table(rows);
  if (left_out > 0) fmt::print("  {} more: -v lists them\n", left_out);
}

}  // namespace

void tell_coverage(const CoverageReport& report, bool verbose) {
  fmt::print("{}\n", report.verdict);
  std::vector<TableRow> unexecuted{{"never executed", "function", "source"}};
  std::vector<TableRow> one_way{{"only one way", "function", "source"}};
  for (const CoveredFile& file : report.files) {
    append_unexecuted(file, unexecuted);
    append_one_way(file, one_way);
  }
  print_rows(std::move(unexecuted), verbose);
  print_rows(std::move(one_way), verbose);
  std::fflush(stdout);  // before related output on stderr
  tell_remarks(report.remarks, report.failure);
}

}  // namespace rehearse::tool
