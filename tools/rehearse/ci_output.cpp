#include "ci_output.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string_view>

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

std::string environment(const char* variable) {
  const char* value = std::getenv(variable);
  return value ? value : "";
}

std::string replaced(std::string_view text, std::string_view from, std::string_view to) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const bool found = text.substr(at, from.size()) == from;
    result += found ? to : text.substr(at, 1);
    at += found ? from.size() : 1;
  }
  return result;
}

/// A value of a workflow command; `in_property`: between `::error ` and `::`.
std::string escaped(std::string_view text, bool in_property) {
  std::string result = replaced(replaced(replaced(text, "%", "%25"), "\r", "%0D"), "\n", "%0A");
  if (in_property) result = replaced(replaced(result, ":", "%3A"), ",", "%2C");
  return result;
}

/// A cell of a Markdown table.
std::string cell(std::string_view text) { return replaced(replaced(text, "|", "\\|"), "\n", "<br>"); }

std::string_view word_of(CiCase::State state) {
  switch (state) {
    case CiCase::State::passed: return "passed";
    case CiCase::State::differs: return "differs";
    case CiCase::State::failed: return "failed";
  }
  return "";
}

std::int64_t count_of(const std::vector<CiCase>& cases, CiCase::State state) {
  return std::ranges::count(cases, state, &CiCase::state);
}

std::string summary_of(const std::vector<CiCase>& cases) {
  std::string text = "### rehearse check\n\n| scenario | | verdict | report |\n| --- | --- | --- | --- |\n";
  for (const CiCase& one : cases)
    text += fmt::format("| {} | {} | {} | {} |\n", cell(one.name), word_of(one.state), cell(one.verdict),
                        cell(fs::path(one.report).filename().string()));
  return text;
}

}  // namespace

Result<void> write_junit(const fs::path& file, const std::vector<CiCase>& cases) {
  double seconds = 0.0;
  for (const CiCase& one : cases) seconds += one.seconds;
  tinyxml2::XMLPrinter xml;
  xml.PushHeader(false, true);
  const auto push_totals = [&] {
    xml.PushAttribute("tests", static_cast<int64_t>(cases.size()));
    xml.PushAttribute("failures", static_cast<int64_t>(count_of(cases, CiCase::State::differs)));
    xml.PushAttribute("errors", static_cast<int64_t>(count_of(cases, CiCase::State::failed)));
    xml.PushAttribute("time", fmt::format("{:.3f}", seconds).c_str());
  };
  xml.OpenElement("testsuites");
  push_totals();
  xml.OpenElement("testsuite");
  xml.PushAttribute("name", "rehearse check");
  push_totals();
  for (const CiCase& one : cases) {
    xml.OpenElement("testcase");
    xml.PushAttribute("name", one.name.c_str());
    xml.PushAttribute("classname", "rehearse.check");
    xml.PushAttribute("time", fmt::format("{:.3f}", one.seconds).c_str());
    if (one.state != CiCase::State::passed) {
      xml.OpenElement(one.state == CiCase::State::differs ? "failure" : "error");
      xml.PushAttribute("message", one.verdict.c_str());
      xml.PushAttribute("type", std::string(word_of(one.state)).c_str());
      xml.PushText(fmt::format("{}:{}\n{}", one.file, one.line, one.details).c_str());
      xml.CloseElement();
    }
    xml.CloseElement();
  }
  xml.CloseElement();
  xml.CloseElement();
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << xml.CStr();
  stream.close();
  if (!stream) return error(fmt::format("can't write {}", file.string()), "name a file in a folder that is there");
  return {};
}

Result<void> print_for_github(const std::vector<CiCase>& cases) {
  for (const CiCase& one : cases)
    if (one.state != CiCase::State::passed)
      fmt::print("::error file={},line={}::{}\n", escaped(one.file, true), one.line,
                 escaped(one.name + ": " + one.verdict, false));
  const std::string summary = environment("GITHUB_STEP_SUMMARY");
  if (summary.empty()) return {};
  std::ofstream stream(summary, std::ios::binary | std::ios::app);
  stream << summary_of(cases);
  stream.close();
  if (!stream) return error(fmt::format("can't write the job's summary {}", summary));
  return {};
}

bool is_github() { return environment("GITHUB_ACTIONS") == "true"; }

}  // namespace rehearse::tool
