#include <fmt/format.h>
#include <rehearse/audit.h>
#include <rehearse/coverage.h>

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "base/text.h"
#include "code_map.h"
#include "core/compare/report_json.h"
#include "core/host/hosted_language.h"
#include "core/host/source_age.h"
#include "symbols.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using CoverageJson = nlohmann::ordered_json;

/// True for a function that isn't written in a controller's source: the API's macro of the factory or the compiler adds
/// it. Its branches aren't the controller's.
bool is_added(std::string_view function) {
  return function == "createSimpleController()" || function == "rehearseCnoidAbi()" ||
         function.starts_with("__static_initialization_and_destruction");
}

/// The executed code of one library in one recording.
struct Execution {
  const fs::path& recording;
  double time_step;  // [s]
  const ExecutedCode& code;
};

/// Adds up what recordings execute, line by line.
class CoverageSum {
 public:
  /// Adds a library of which a replay executed nothing yet. Fails as map_code(), and for a controller in Python.
  Result<void> add_library(const fs::path& file) {
    if (maps_.contains(file)) return {};
    const auto hosted = hosted_name(file);
    if (hosted && hosted->language.is_library)
      return error(fmt::format("the lines of controller '{}' can't be watched: it is one of {}",
                               file.filename().string(), hosted->language.name));
    if (hosted)
      return error(fmt::format("controller '{}' is written in {}: it has no machine code, in which lines are watched",
                               file.filename().string(), hosted->language.name),
                   fmt::format("{}'s own package coverage lists its lines", hosted->language.name));
    auto map = REHEARSE_TRY(map_code(file));
    maps_.emplace(file, std::move(map));
    return {};
  }
  void add(const fs::path& library, const Execution& execution) { executions_[library].push_back(execution); }

  std::vector<CoveredFile> files();
  bool is_empty() const { return maps_.empty(); }
  bool is_optimised(const fs::path& library) const { return maps_.at(library).is_optimised; }
  std::vector<fs::path> libraries() const {
    std::vector<fs::path> files;
    for (const auto& [library, map] : maps_) files.push_back(library);
    return files;
  }

 private:
  void add_lines(const fs::path& library, const CodeMap& map);

  std::map<fs::path, CodeMap> maps_;  // by library
  std::map<fs::path, std::vector<Execution>> executions_;
  std::map<std::string, std::map<int, CoveredLine>> lines_;  // by file and line
  /// Of optimised libraries, by file and line: true if the line has code of its own, and no part of it was executed.
  std::map<std::string, std::map<int, bool>> is_skipped_;
};

void note(std::optional<FirstExecution>& first, const Execution& execution, std::optional<std::int64_t> tick) {
  if (!tick || (first && (first->recording != execution.recording || first->tick <= *tick))) return;
  first = FirstExecution{execution.recording, *tick, std::nullopt};
  if (*tick >= 0) first->time = time_of(*tick, execution.time_step);
}

void CoverageSum::add_lines(const fs::path& library, const CodeMap& map) {
  const Symbols symbols(library);
  const std::vector<Execution>& executions = executions_[library];
  std::map<std::pair<int, int>, std::set<fs::path>> recordings;  // by index of the file and line
  const auto line_at = [&](int file, int line, std::uint64_t address) -> CoveredLine& {
    CoveredLine& covered = lines_[map.files[static_cast<std::size_t>(file)]][line];
    covered.line = line;
    if (covered.function.empty()) covered.function = symbols.find(address).function;
    return covered;
  };
  std::map<std::pair<int, int>, std::pair<bool, bool>> pieces;  // likewise: it has code; a part of it was executed
  for (const CodeMap::Statement& statement : map.statements) {
    auto& [has_code, is_executed] = pieces[{statement.file, statement.line}];
    has_code = has_code || (statement.begins && statement.has_code);
    CoveredLine* const line = statement.begins ? &line_at(statement.file, statement.line, statement.address) : nullptr;
    for (const Execution& execution : executions) {
      const auto found = execution.code.statements.find(statement.address);
      if (found == execution.code.statements.end()) continue;
      is_executed = is_executed || statement.has_code;
      if (!line) continue;
      note(line->first, execution, found->second);
      recordings[{statement.file, statement.line}].insert(execution.recording);
    }
  }
  for (const CodeMap::Jump& jump : map.jumps) {
    CoveredWay taken, passed;
    for (const Execution& execution : executions) {
      const auto found = execution.code.jumps.find(jump.address);
      if (found == execution.code.jumps.end()) continue;
      note(taken.first, execution, found->second.taken);
      note(passed.first, execution, found->second.passed);
      taken.is_known = passed.is_known = taken.is_known && found->second.is_complete;
    }
    CoveredLine& line = line_at(jump.file, jump.line, jump.address);
    if (is_added(symbols.find(jump.address).function)) continue;
    line.ways.insert(line.ways.end(), {taken, passed});
  }
  if (map.is_optimised)
    for (const auto& [place, piece] : pieces) {
      const std::string& file = map.files[static_cast<std::size_t>(place.first)];
      bool& is_skipped = is_skipped_[file].try_emplace(place.second, true).first->second;
      is_skipped = is_skipped && piece.first && !piece.second;
    }
  for (const auto& [place, executing] : recordings) {
    CoveredLine& line = lines_[map.files[static_cast<std::size_t>(place.first)]][place.second];
    line.recordings = std::max(line.recordings, static_cast<std::int64_t>(executing.size()));
  }
}

std::vector<CoveredFile> CoverageSum::files() {
  for (const auto& [library, map] : maps_) add_lines(library, map);
  std::vector<CoveredFile> files;
  for (auto& [path, lines] : lines_) {
    CoveredFile& file = files.emplace_back();
    file.file = path;
    const std::map<int, bool>& is_skipped = is_skipped_[path];
    for (auto& [number, line] : lines) {
      const auto found = is_skipped.find(number);
      if (!line.first && found != is_skipped.end() && !found->second)
        file.unknown.push_back(number);
      else
        file.lines.push_back(std::move(line));
    }
  }
  return files;
}

struct Counts {
  int lines = 0, executed = 0, ways = 0, executed_ways = 0, unknown = 0;
};

Counts counts_of(const CoverageReport& report) {
  Counts counts;
  for (const CoveredFile& file : report.files) {
    counts.unknown += static_cast<int>(file.unknown.size());
    for (const CoveredLine& line : file.lines) {
      ++counts.lines;
      counts.executed += line.first ? 1 : 0;
      for (const CoveredWay& way : line.ways) {
        if (!way.first && !way.is_known) continue;
        ++counts.ways;
        counts.executed_ways += way.first ? 1 : 0;
      }
    }
  }
  return counts;
}

std::string verdict_of(const CoverageReport& report) {
  const Counts counts = counts_of(report);
  const std::size_t recordings = report.recordings.size();
  std::string text = fmt::format("{} of {} lines", counts.executed, counts.lines);
  if (counts.ways > 0) text += fmt::format(" and {} of {} ways of branches", counts.executed_ways, counts.ways);
  text += recordings == 1 ? " are executed by 1 recording" : fmt::format(" are executed by {} recordings", recordings);
  if (counts.unknown > 0)
    text += fmt::format("; {} {} known", count_text(static_cast<std::size_t>(counts.unknown), "line"),
                        counts.unknown == 1 ? "isn't" : "aren't");
  const int missing = counts.lines - counts.executed;
  for (const CoveredFile& file : report.files)
    for (const CoveredLine& line : file.lines)
      if (!line.first)
        return text + fmt::format("; never: {}:{}{}", file.file.filename().string(), line.line,
                                  missing == 1   ? ""
                                  : missing == 2 ? " and one more line"
                                                 : fmt::format(" and {} more lines", missing - 1));
  return text;
}

CoverageJson object_of(const std::optional<FirstExecution>& first) {
  if (!first) return nullptr;
  return {{"recording", first->recording.string()},
          {"tick", first->tick},
          {"time", first->time ? CoverageJson(*first->time) : CoverageJson(nullptr)}};
}

}  // namespace

Result<CoverageReport> coverage(const std::vector<fs::path>& recordings, const AuditOptions& options) {
  CoverageReport report;
  report.recordings = recordings;
  CoverageSum sum;
  std::vector<AuditReport> audits;  // not moved: the executions refer to them
  audits.reserve(recordings.size());
  std::map<fs::path, Diagnostic> unwatched;  // by library
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    AuditOptions own = options;
    own.coverage = true;
    own.scratch = options.scratch / std::to_string(i);
    if (options.progress) {
      own.progress = nullptr;
      options.progress("replaying", static_cast<int>(i), static_cast<int>(recordings.size()));
    }
    auto audited = REHEARSE_TRY(audit(recordings[i], own));
    audits.push_back(std::move(audited));
    const AuditReport& replayed = audits.back();
    if (replayed.failure && !report.failure) {
      report.failure = replayed.failure;
      report.failure->message += fmt::format(" (replay of {})", recordings[i].string());
    }
    report.remarks.insert(report.remarks.end(), replayed.remarks.begin(), replayed.remarks.end());
    for (const ControllerAudit& controller : replayed.controllers) {
      if (const auto added = sum.add_library(controller.library); !added)
        unwatched.emplace(controller.library, added.errors()[0]);
      else if (controller.executed)
        sum.add(controller.library, {recordings[i], replayed.time_step, *controller.executed});
    }
  }
  for (const auto& [library, why] : unwatched) {
    if (sum.is_empty()) return why;
    report.remarks.push_back(warning(why.message + ": its lines aren't known", why.hint));
  }
  for (const fs::path& library : sum.libraries()) {
    if (sum.is_optimised(library))
      report.remarks.push_back(warning(fmt::format("{} is optimised: lines without code of their own aren't known, and "
                                                   "an executed line may stand for its neighbours",
                                                   library.filename().string()),
                                       "compile it with -O0 or -Og; COVERAGE in CMake does"));
    for (std::string& sentence : notes_on_old_library(library)) report.remarks.push_back(warning(std::move(sentence)));
  }
  report.files = sum.files();
  report.verdict = verdict_of(report);
  return report;
}

std::string to_json(const CoverageReport& report) {
  const Counts counts = counts_of(report);
  CoverageJson object{
      {"verdict", report.verdict},       {"lines", counts.lines}, {"lines_executed", counts.executed},
      {"lines_unknown", counts.unknown}, {"ways", counts.ways},   {"ways_executed", counts.executed_ways}};
  for (const fs::path& recording : report.recordings) object["recordings"].push_back(recording.string());
  object["files"] = CoverageJson::array();
  for (const CoveredFile& file : report.files) {
    CoverageJson lines = CoverageJson::array();
    for (const CoveredLine& line : file.lines) {
      CoverageJson ways = CoverageJson::array();
      for (const CoveredWay& way : line.ways)
        ways.push_back({{"first", object_of(way.first)}, {"known", way.is_known}});
      lines.push_back({{"line", line.line},
                       {"function", line.function},
                       {"recordings", line.recordings},
                       {"first", object_of(line.first)},
                       {"ways", ways}});
    }
    object["files"].push_back({{"file", file.file.string()}, {"lines", lines}, {"unknown", file.unknown}});
  }
  object["failure"] = report.failure ? CoverageJson(report.failure->message) : CoverageJson(nullptr);
  object["remarks"] = CoverageJson::array();
  for (const Diagnostic& remark : report.remarks)
    object["remarks"].push_back({{"severity", to_string(remark.severity)}, {"message", remark.message}});
  return text_of(object);
}

std::string to_lcov(const CoverageReport& report) {
  std::string text = "TN:rehearse\n";
  for (const CoveredFile& file : report.files) {
    text += fmt::format("SF:{}\n", file.file.string());
    int lines = 0, executed = 0, ways = 0, executed_ways = 0;
    for (const CoveredLine& line : file.lines) {
      for (std::size_t way = 0; way < line.ways.size(); ++way) {
        text += fmt::format("BRDA:{},{},{},{}\n", line.line, way / 2, way,
                            !line.first            ? "-"
                            : line.ways[way].first ? "1"
                                                   : "0");
        ++ways;
        executed_ways += line.ways[way].first ? 1 : 0;
      }
      text += fmt::format("DA:{},{}\n", line.line, line.recordings);
      ++lines;
      executed += line.first ? 1 : 0;
    }
    text += fmt::format("BRF:{}\nBRH:{}\nLF:{}\nLH:{}\nend_of_record\n", ways, executed_ways, lines, executed);
  }
  return text;
}

}  // namespace rehearse
