// Each test that is compared leaves a note, traces/TEST.report.json, and the index is made of all existing notes. Tests
// may run in one program or in many at once, and in any order.
#include "test_reports.h"

#include <fmt/format.h>
#include <rehearse/report.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "golden/run_folder.h"
#include "mcap/replaceable.h"

namespace rehearse::internal {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::string_view index_magic = "<!doctype html><!-- the tests that Rehearse compared -->";
constexpr std::string_view note_extension = ".report.json";

enum class Wanted { never, of_failures, always };

Wanted wanted() {
  const char* stated = std::getenv("REHEARSE_REPORT");
  const std::string_view word = stated ? stated : "";
  return word == "always" ? Wanted::always : word == "never" ? Wanted::never : Wanted::of_failures;
}

/// Writes the file completely or not at all.
void write_text(const fs::path& file, const std::string& text) {
  const fs::path draft = file.string() + ".part";
  std::ofstream stream(draft, std::ios::binary);
  stream << text;
  stream.close();
  std::error_code ignored;
  if (stream)
    fs::rename(draft, file, ignored);
  else
    fs::remove(draft, ignored);
}

/// The notes of all tests, by name.
std::vector<Json> read_notes(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed))
    if (entry->path().filename().string().ends_with(note_extension)) files.push_back(entry->path());
  std::sort(files.begin(), files.end());
  std::vector<Json> notes;
  for (const fs::path& file : files) {
    std::ifstream stream(file);
    Json note = Json::parse(stream, nullptr, false);
    if (note.is_object() && note.contains("test") && note.contains("passed")) notes.push_back(std::move(note));
  }
  return notes;
}

std::string html_text(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '<': safe += "&lt;"; break;
      case '>': safe += "&gt;"; break;
      case '&': safe += "&amp;"; break;
      case '"': safe += "&quot;"; break;
      default: safe += c;
    }
  }
  return safe;
}

/// A row of the index. Links are relative, because the folder may be viewed on a different machine.
std::string row_of(const Json& note) {
  const auto text = [&](const char* key) { return html_text(note.value(key, std::string())); };
  const bool passed = note["passed"].is_boolean() && note["passed"].get<bool>();
  std::string link = text("report");
  std::replace(link.begin(), link.end(), ' ', '+');  // names of tests contain no blanks
  if (!link.empty() && note.contains("tick") && note["tick"].is_number_integer())
    link += fmt::format("#tick={}", note["tick"].get<std::int64_t>());
  const std::string name = link.empty() ? text("test") : fmt::format("<a href=\"{}\">{}</a>", link, text("test"));
  return fmt::format("<tr class=\"{}\"><td>{}</td><td>{}</td><td>{}</td></tr>\n", passed ? "passed" : "failed",
                     passed ? "passed" : "failed", name, text("verdict"));
}

std::string index_of(std::vector<Json> notes) {
  std::stable_partition(notes.begin(), notes.end(), [](const Json& note) { return note["passed"] == false; });
  const auto failed =
      std::count_if(notes.begin(), notes.end(), [](const Json& note) { return note["passed"] == false; });
  std::string rows;
  for (const Json& note : notes) rows += row_of(note);
  return fmt::format(
      "{}\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{} of {} failed</title><style>\n"
      ":root {{ color-scheme: light dark; font: 15px/1.4 system-ui, sans-serif }}\n"
      "body {{ margin: 2rem auto; max-width: 72rem; padding: 0 1rem }}\n"
      "td {{ padding: .4rem .8rem; vertical-align: top; border-top: 1px solid #8884 }}\n"
      ".failed td:first-child {{ color: light-dark(#b3261e, #ff8a80); font-weight: 600 }}\n"
      ".passed td:first-child {{ color: light-dark(#1b7a37, #7ddc97) }}\n"
      "</style></head><body>\n<h1>{} of {} tests that were compared with a golden failed</h1>\n<table>\n{}</table>\n"
      "</body></html>\n",
      index_magic, failed, notes.size(), failed, notes.size(), rows);
}

/// Makes the index of all present notes; the caller must hold the folder. Without a failed test and without an existing
/// index none is made.
void refresh_index(const fs::path& folder) {
  const std::vector<Json> notes = read_notes(folder);
  const fs::path index = folder / "index.html";
  std::error_code ignored;
  const bool any_failed =
      std::any_of(notes.begin(), notes.end(), [](const Json& note) { return note["passed"] == false; });
  if (!any_failed && !fs::exists(index, ignored) && wanted() != Wanted::always) return;
  if (check_replaceable(index, index_magic, "index of tests")) write_text(index, index_of(notes));
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

ReportOptions options_of(const TestVerdict& verdict, const ComparedTest& compared) {
  ReportOptions options;
  options.tolerances = compared.tolerances;
  options.horizon = compared.horizon;
  options.scenario = compared.scenario;
  if (compared.checked)
    options.verdict = report_verdict(*compared.checked);
  else if (!verdict.passed)
    options.verdict = ReportVerdict{first_line(verdict.message), "beyond"};
  return options;
}

}  // namespace

std::string keep_test_report(const Trace& trace, const std::string& test, const TestVerdict& verdict,
                             const ComparedTest& compared) {
  if (wanted() == Wanted::never) return {};
  const fs::path folder = fs::path(test_folders().output) / "traces";
  const fs::path file = folder / (test + ".html");
  std::error_code ignored;
  const FolderLock alone(folder);  // programs that run in parallel may run the same test
  std::string told;
  const std::string sentence = compared.checked ? compared.checked->verdict
                               : verdict.passed ? "as its golden"
                                                : first_line(verdict.message);
  Json note{{"test", test}, {"passed", verdict.passed}, {"verdict", sentence}};
  const bool has_golden = fs::is_regular_file(compared.golden, ignored);
  if (!verdict.passed || wanted() == Wanted::always) {
    const auto golden = has_golden ? std::optional(compared.golden) : std::nullopt;
    const auto written = write_report(trace.file(), golden, file, options_of(verdict, compared));
    if (written) {
      note["report"] = file.filename().string();
      if (written->first_tick) note["tick"] = *written->first_tick;
      told = is_ci() ? "\nreport: " + file.lexically_proximate(fs::current_path()).string()
                     : "\nin a browser: " + report_link(file, written->first_tick);
    } else {
      told = "\nthere is no report to look at: " + written.errors()[0].message;
    }
  } else {
    fs::remove(file, ignored);  // the report of an earlier run, in which it failed
  }
  write_text(folder / (test + std::string(note_extension)),
             note.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  refresh_index(folder);
  return told;
}

}  // namespace rehearse::internal
