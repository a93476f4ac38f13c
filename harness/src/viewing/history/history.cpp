#include "history.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <utility>

#include "base/file_descriptor.h"
#include "base/text.h"
#include "base/write_hint.h"
#include "core/compare/report_json.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using SortedJson = nlohmann::json;

constexpr int line_version = 1;  // it increases if a member is removed or changes its meaning

SortedJson json_of(const HistoryMargin& margin) {
  return {{"text", margin.text},   {"margin", margin.margin ? SortedJson(*margin.margin) : SortedJson()},
          {"value", margin.value}, {"bound", margin.bound},
          {"unit", margin.unit},   {"share", margin.share ? SortedJson(*margin.share) : SortedJson()},
          {"tick", margin.tick}};
}

/// A member of an object; `problem` is the first mistake.
class Members {
 public:
  Members(const SortedJson& object, std::string& problem) : object_(object), problem_(problem) {}

  template <class Value>
  void take(const char* name, Value& value, bool (SortedJson::*has_type)() const noexcept, const char* type) {
    const auto found = object_.find(name);
    if (found == object_.end()) return tell(fmt::format("it has no '{}'", name));
    if (!((*found).*has_type)()) return tell(fmt::format("its '{}' is no {}", name, type));
    found->get_to(value);
  }
  void take(const char* name, std::string& value) { take(name, value, &SortedJson::is_string, "text"); }
  void take(const char* name, bool& value) { take(name, value, &SortedJson::is_boolean, "true or false"); }
  void take(const char* name, double& value) { take(name, value, &SortedJson::is_number, "number"); }
  void take(const char* name, std::int64_t& value) {
    take(name, value, &SortedJson::is_number_integer, "whole number");
  }
  void take(const char* name, std::optional<double>& value) {
    const auto found = object_.find(name);
    if (found != object_.end() && found->is_null()) return value.reset();
    take(name, value.emplace());
  }

 private:
  void tell(std::string what) {
    if (problem_.empty()) problem_ = std::move(what);
  }

  const SortedJson& object_;
  std::string& problem_;
};

HistoryMargin margin_in(const SortedJson& object, std::string& problem) {
  HistoryMargin margin;
  if (!object.is_object()) {
    problem = "a margin is no object";
    return margin;
  }
  Members members(object, problem);
  members.take("text", margin.text);
  members.take("margin", margin.margin);
  members.take("value", margin.value);
  members.take("bound", margin.bound);
  members.take("unit", margin.unit);
  members.take("share", margin.share);
  members.take("tick", margin.tick);
  return margin;
}

void take_costs(const SortedJson& object, HistoryLine& line, std::string& problem) {
  const auto found = object.find("costs");
  if (found == object.end()) return;
  for (const auto& [controller, counts] : found->items()) {
    if (!counts.is_object()) problem = "the costs of a controller are no object";
    for (const auto& [name, count] : counts.items()) {
      if (!count.is_number_unsigned()) problem = fmt::format("the cost '{}' is no count", name);
      if (problem.empty()) line.costs[controller][name] = count.get<std::uint64_t>();
    }
  }
}

/// `problem` stays empty if the object is a line of a history.
HistoryLine line_in(const SortedJson& object, std::string& problem) {
  HistoryLine line;
  if (!object.is_object()) {
    problem = "it is no object";
    return line;
  }
  std::int64_t version = 0;
  Members members(object, problem);
  members.take("history", version);
  if (problem.empty() && version != line_version)
    problem = fmt::format("it has the version {}, and this program reads {}", version, line_version);
  members.take("commit", line.stamp.commit);
  members.take("changed", line.stamp.changed);
  members.take("date", line.stamp.date);
  members.take("scenario", line.scenario);
  members.take("code", line.code);
  members.take("proved", line.proved);
  const auto margins = object.find("margins");
  if (problem.empty() && (margins == object.end() || !margins->is_array())) problem = "it has no list 'margins'";
  if (!problem.empty()) return line;
  for (const SortedJson& margin : *margins) line.margins.push_back(margin_in(margin, problem));
  take_costs(object, line, problem);
  line.first = object.value("first", SortedJson());
  return line;
}

/// The mistake of a line that is no JSON.
Diagnostic bad_line(const fs::path& file, int number, const std::string& text, std::size_t column) {
  Diagnostic problem =
      error_in(file.string(), "this line is no JSON: " + in_quotes(text),
               text.starts_with("<<<<<<<") || text.starts_with("=======") || text.starts_with(">>>>>>>")
                   ? "git left it: keep the lines of both sides, and remove its marks"
                   : "remove the line; all others are read");
  problem.line = number;
  problem.column = static_cast<int>(column);
  return problem;
}

}  // namespace

HistoryLine line_of(const HistoryStamp& stamp, const std::string& scenario, const CheckReport& report) {
  HistoryLine line;
  line.stamp = stamp;
  line.scenario = scenario;
  line.code = report.verdict.code();
  line.proved = report.proved;
  for (const ExpectationResult& result : report.expectations) {
    HistoryMargin margin;
    margin.text = result.text;
    if (result.closest && std::isfinite(result.closest->margin)) {
      margin.margin = result.closest->margin;
      margin.value = result.closest->value;
      margin.bound = result.closest->bound;
      margin.unit = result.closest->unit;
      margin.share = result.closest->share;
      margin.tick = result.closest->tick;
    }
    line.margins.push_back(std::move(margin));
  }
  if (report.run)
    for (const ControlTimes& control : report.run->control_times)
      if (control.costs)
        for (const ControlCosts::Count& count : control.costs->counts)
          line.costs[control.controller][std::string(count.name)] = count.total;
  line.first = SortedJson(json_of(report.first));
  return line;
}

std::string text_of(const HistoryLine& line) {
  SortedJson object{{"history", line_version}, {"commit", line.stamp.commit},    {"changed", line.stamp.changed},
                    {"date", line.stamp.date}, {"scenario", line.scenario},      {"code", line.code},
                    {"proved", line.proved},   {"margins", SortedJson::array()}, {"first", line.first}};
  for (const HistoryMargin& margin : line.margins) object["margins"].push_back(json_of(margin));
  if (!line.costs.empty()) object["costs"] = line.costs;
  return object.dump(-1, ' ', false, SortedJson::error_handler_t::replace);
}

Result<void> append_to_history(const fs::path& file, const std::vector<std::string>& lines) {
  const auto failed = [&file] {
    return error_in(file.string(), fmt::format("the history can't be written: {}", std::strerror(errno)),
                    write_hint(file, "name another file"));
  };
  const FileDescriptor stream(::open(file.c_str(), O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC, 0666));
  if (stream < 0 || ::flock(stream, LOCK_EX) != 0) return failed();
  std::string text;
  const off_t size = ::lseek(stream, 0, SEEK_END);
  char last = '\n';
  if (size > 0 && ::pread(stream, &last, 1, size - 1) != 1) return failed();
  if (last != '\n') text = "\n";
  for (const std::string& line : lines) text += line + '\n';
  const ssize_t written = ::write(stream, text.data(), text.size());
  if (written == static_cast<ssize_t>(text.size())) return {};
  if (written >= 0) errno = ENOSPC;
  const Diagnostic problem = failed();
  if (written > 0 && size >= 0) (void)!::ftruncate(stream, size);  // no half line remains
  return problem;
}

Result<History> read_history(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::error_code ignored;
  if (!stream || fs::is_directory(file, ignored))
    return error_in(file.string(), "the history can't be read", "rehearse check --history FILE writes it");
  History history;
  int number = 0;
  for (std::string text; std::getline(stream, text);) {
    ++number;
    if (text.find_first_not_of(" \t\r") == std::string::npos) continue;
    SortedJson object;
    try {
      object = SortedJson::parse(text);
    } catch (const SortedJson::parse_error& found) {
      history.bad.push_back(bad_line(file, number, text, found.byte));
      continue;
    }
    std::string problem;
    HistoryLine line = line_in(object, problem);
    if (problem.empty()) {
      history.lines.push_back(std::move(line));
      continue;
    }
    history.bad.push_back(
        error_in(file.string(), "this is no line of a history: " + problem, "remove the line; all others are read"));
    history.bad.back().line = number;
  }
  return history;
}

}  // namespace rehearse
