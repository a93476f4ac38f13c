// Each result is a file, and the index is made of all existing files. Tests may run in one program or in many at once,
// and in any order.
#include "report_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <tuple>

#include "base/replaceable.h"
#include "core/trace/message_json.h"
#include "html_text.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::string_view index_magic = "<!doctype html><!-- the tests that Rehearse compared -->";
constexpr std::string_view result_extension = ".report.json";
constexpr std::array state_names{"passed", "differs", "failed"};

fs::path file_of(const fs::path& folder, const std::string& test, const std::string& kind) {
  return folder / fmt::format("{}.{}{}", test, kind, result_extension);
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

std::string text_in(const Json& result, const char* key) {
  const auto found = result.find(key);
  return found != result.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// Failed tests first, then differing ones; by name.
bool comes_first(const Json& a, const Json& b) {
  const auto key = [](const Json& result) {
    const std::string state = text_in(result, "state");
    return std::tuple(state == "failed"    ? 0
                      : state == "differs" ? 1
                                           : 2,
                      text_in(result, "test"), text_in(result, "kind"));
  };
  return key(a) < key(b);
}

bool has_passed(const Json& result) { return text_in(result, "state") == "passed"; }

std::vector<Json> read_results(const fs::path& folder) {
  std::vector<Json> results;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    if (!entry->path().filename().string().ends_with(result_extension)) continue;
    std::ifstream stream(entry->path());
    Json result = Json::parse(stream, nullptr, false);
    if (result.is_object() && !text_in(result, "test").empty() && !text_in(result, "state").empty())
      results.push_back(std::move(result));
  }
  std::ranges::stable_sort(results, comes_first);
  return results;
}

/// A row of the index. Links are relative, because the folder may be viewed on a different machine.
std::string row_of(const Json& result) {
  const auto text = [&](const char* key) { return html_text(text_in(result, key)); };
  std::string link = text("report");
  std::ranges::replace(link, ' ', '+');  // names of tests contain no blanks
  const auto tick = result.find("tick");
  const bool has_tick = tick != result.end() && tick->is_number_integer();
  if (!link.empty() && has_tick) link += fmt::format("#tick={}", tick->get<std::int64_t>());
  const auto linked = [&](const std::string& content) {
    return link.empty() ? content : fmt::format("<a href=\"{}\">{}</a>", link, content);
  };
  const std::string picture = text("picture");
  const std::string alt = has_tick ? fmt::format("the robot at tick {}", tick->get<std::int64_t>()) : "the robot";
  const std::string image =
      picture.empty() ? "" : linked(fmt::format("<img alt=\"{}\" src=\"data:image/png;base64,{}\">", alt, picture));
  return fmt::format("<tr class=\"{0}\"><td>{1}</td><td>{0}</td><td>{2}<br><small>{3}</small></td><td>{4}</td></tr>\n",
                     text("state"), image, linked(text("test")), text("kind"), text("verdict"));
}

std::string index_of(const std::vector<Json>& results) {
  const auto bad = std::ranges::count_if(results, [](const Json& result) { return !has_passed(result); });
  std::string rows;
  for (const Json& result : results) rows += row_of(result);
  const std::string title =
      fmt::format("{} of {} {} failed", bad, results.size(), results.size() == 1 ? "test" : "tests");
  return fmt::format(
      "{0}\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{1}</title>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><style>\n"
      "{3}"
      "td:nth-child(-n+2) {{ width: 1%; white-space: nowrap }}\n"
      "td:nth-child(3) {{ min-width: 14rem }}\n"
      "img {{ display: block; width: 160px; height: 120px; border-radius: 4px }}\n"
      "small {{ opacity: .75 }}\n"
      ":is(.differs, .failed) td:nth-child(2) {{ color: light-dark(#b3261e, #ff8a80); font-weight: 600 }}\n"
      ".passed td:nth-child(2) {{ color: light-dark(#1b7a37, #7ddc97) }}\n"
      "@media (max-width: 600px) {{ tr {{ display: block }} td {{ display: inline-block; border: none }} "
      "td:last-child {{ display: block }} }}\n"
      "</style></head><body>\n<h1>{1}</h1>\n<table>\n{2}</table>\n</body></html>\n",
      index_magic, title, rows, html_style);
}

}  // namespace

void keep_result(const fs::path& folder, const TestResult& result) {
  Json note{{"test", result.test},
            {"kind", result.kind},
            {"state", state_names[static_cast<std::size_t>(result.state)]},
            {"verdict", result.verdict},
            {"report", result.report.filename().string()}};
  if (result.tick) note["tick"] = *result.tick;
  if (!result.picture.empty()) {
    std::string picture;
    append_base64(picture, std::as_bytes(std::span(result.picture)));
    note["picture"] = std::move(picture);
  }
  write_text(file_of(folder, result.test, result.kind),
             note.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

void drop_result(const fs::path& folder, const std::string& test, const std::string& kind) {
  std::error_code ignored;
  fs::remove(file_of(folder, test, kind), ignored);
}

std::optional<fs::path> refresh_index(const fs::path& folder, bool always) {
  const std::vector<Json> results = read_results(folder);
  fs::path index = folder / "index.html";
  std::error_code ignored;
  if (std::ranges::all_of(results, has_passed) && !always && !fs::exists(index, ignored)) return std::nullopt;
  if (!check_replaceable(index, index_magic, "index of tests")) return std::nullopt;
  write_text(index, index_of(results));
  return index;
}

}  // namespace rehearse
