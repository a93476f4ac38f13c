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
#include "core/golden/moment.h"
#include "core/trace/message_json.h"
#include "html_text.h"
#include "small_page.h"

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

/// The kept result in a file; null: there is none.
Json read_result(const fs::path& file) {
  std::ifstream stream(file);
  Json result = Json::parse(stream, nullptr, false);
  const bool is_one = result.is_object() && !text_in(result, "test").empty() && !text_in(result, "state").empty();
  return is_one ? result : Json();
}

std::vector<Json> read_results(const fs::path& folder) {
  std::vector<Json> results;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    if (!entry->path().filename().string().ends_with(result_extension)) continue;
    if (Json result = read_result(entry->path()); !result.is_null()) results.push_back(std::move(result));
  }
  std::ranges::stable_sort(results, comes_first);
  return results;
}

/// "0.31 s"; empty: unknown.
std::string time_of(const Json& result) {
  const auto seconds = result.find("seconds");
  return seconds != result.end() && seconds->is_number() ? fmt::format("{:.2f} s", seconds->get<double>()) : "";
}

/// "2026-11-27 06:50 UTC"; empty: unknown.
std::string moment_of(const Json& result) {
  std::string text = text_in(result, "moment");
  if (text.size() >= 16) text = fmt::format("{} {} UTC", text.substr(0, 10), text.substr(11, 5));
  return text;
}

std::string commit_of(const Json& result) { return text_in(result, "commit").substr(0, 7); }

/// A button for each previous run, the oldest first; it shows the words on that run.
std::string marks_of(const Json& result) {
  const auto previous = result.find("previous");
  if (previous == result.end() || !previous->is_array() || previous->empty()) return "";
  std::string marks;
  for (const Json& run : *previous) {
    const std::string commit = commit_of(run), state = text_in(run, "state");
    const std::string words =
        fmt::format("{}{}{}: {}", moment_of(run), commit.empty() ? "" : ", commit ", commit, text_in(run, "verdict"));
    marks +=
        fmt::format("<li><button type=\"button\" class=\"{0}\" title=\"{1}\" aria-label=\"{0}, {1}\">{2}</button></li>",
                    html_text(state), html_text(words), state == "passed" ? "✓" : "✕");
  }
  return fmt::format("<ol class=\"runs\" aria-label=\"previous runs\">{}</ol><output></output>", marks);
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
  const std::string commit = html_text(commit_of(result));
  return fmt::format(
      "<tr class=\"{0}\"{9}><td>{1}</td><td>{0}</td><td>{2}<br><small>{3}</small></td><td>{4}</td><td>{5}</td>"
      "<td>{6}{7}</td><td>{8}</td></tr>\n",
      text("state"), image, linked(text("test")), text("kind"), text("verdict"), time_of(result), moment_of(result),
      commit.empty() ? "" : fmt::format("<br><small>commit <code>{}</code></small>", commit), marks_of(result),
      has_passed(result) ? "" : " data-finding");
}

constexpr std::string_view tools =
    "<div class=\"tools\" hidden><input type=\"search\" placeholder=\"Search\" aria-label=\"search in tests and "
    "verdicts\">"
    "<select aria-label=\"which tests\"><option value=\"\">all tests</option><option>failed</option>"
    "<option>passed</option></select><output class=\"note\"></output></div>\n";

std::string index_of(const std::vector<Json>& results) {
  const auto bad = std::ranges::count_if(results, [](const Json& result) { return !has_passed(result); });
  std::string rows;
  for (const Json& result : results) rows += row_of(result);
  return small_page(
      {.magic = index_magic,
       .kind = "Tests",
       .is_bad = bad > 0,
       .title = fmt::format("{} of {} {} failed", bad, results.size(), results.size() == 1 ? "test" : "tests"),
       .content = fmt::format(
           "<section class=\"panel filtered\" aria-label=\"tests\">\n{}<div class=\"scroll\" tabindex=\"0\" "
           "role=\"group\" aria-label=\"table of tests\"><table class=\"tests\">\n<thead><tr><th>picture</th>"
           "<th>verdict</th><th>test</th><th>sentence</th><th>duration</th><th>time</th>"
           "<th>previous runs</th></tr></thead>\n<tbody>\n{}</tbody></table></div></section>\n",
           tools, rows)});
}

/// The first line of a file; empty: it can't be read.
std::string line_in(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

/// The results before this one, as it keeps them: the oldest first.
Json previous_of(const Json& earlier) {
  constexpr std::size_t most = 10;
  Json runs = Json::array();
  if (const auto older = earlier.find("previous"); older != earlier.end() && older->is_array()) runs = *older;
  Json run = Json::object();
  for (const char* key : {"state", "verdict", "moment", "commit", "seconds"})
    if (const auto found = earlier.find(key); found != earlier.end()) run[key] = *found;
  runs.push_back(std::move(run));
  if (runs.size() > most) runs.erase(runs.begin(), runs.end() - most);
  return runs;
}

/// The commit that is checked out in the git repository of a folder, read from its files; empty: there is none.
std::string head_commit_of(const fs::path& folder) {
  std::error_code failed;
  fs::path place = folder.empty() ? folder : fs::absolute(folder, failed);
  while (!place.empty() && !fs::exists(place / ".git", failed))
    place = place == place.parent_path() ? "" : place.parent_path();
  if (place.empty()) return {};
  fs::path git = place / ".git";
  constexpr std::string_view link = "gitdir: ", reference = "ref: ";
  if (fs::is_regular_file(git, failed)) {  // of a work tree, or of a submodule
    const std::string line = line_in(git);
    if (!line.starts_with(link)) return {};
    git = place / line.substr(link.size());
  }
  const std::string head = line_in(git / "HEAD");
  if (!head.starts_with(reference)) return head;
  const std::string name = head.substr(reference.size());
  const std::string shared = line_in(git / "commondir");
  const fs::path common = shared.empty() ? git : git / shared;
  if (const std::string commit = line_in(common / name); !commit.empty()) return commit;
  std::ifstream packed(common / "packed-refs");
  for (std::string line; std::getline(packed, line);)
    if (line.ends_with(" " + name)) return line.substr(0, line.find(' '));
  return {};
}

}  // namespace

void keep_result(const fs::path& folder, const TestResult& result) {
  Json note{{"test", result.test},
            {"kind", result.kind},
            {"state", state_names[static_cast<std::size_t>(result.state)]},
            {"verdict", result.verdict},
            {"report", result.report.filename().string()}};
  if (const auto moment = moment_of_now()) note["moment"] = *moment;
  if (const std::string commit = head_commit_of(result.project); !commit.empty()) note["commit"] = commit;
  if (result.seconds) note["seconds"] = *result.seconds;
  if (result.tick) note["tick"] = *result.tick;
  const fs::path file = file_of(folder, result.test, result.kind);
  if (const Json earlier = read_result(file); !earlier.is_null()) note["previous"] = previous_of(earlier);
  if (!result.picture.empty()) {
    std::string picture;
    append_base64(picture, std::as_bytes(std::span(result.picture)));
    note["picture"] = std::move(picture);
  }
  write_text(file, note.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
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
