// rehearse doctor: reports what `recover` would lose or mend of files, and deviations from Rehearse's trace format.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "core/trace/trace_doctor.h"
#include "log_verbs.h"
#include "options.h"
#include "output.h"
#include "progress.h"

namespace rehearse::tool {
namespace {

struct DoctorSettings {
  std::vector<std::string> files;
  bool json = false;
};

/// The result of one file.
struct Visit {
  std::string file;
  Diagnostics unreadable;  // not empty if the file couldn't be examined
  mcap::Examination examination;
  bool is_mcap = true;    // false: it was converted, and the examination's places are those of the conversion
  Diagnostics container;  // findings about metadata.yaml, or about a database

  std::uint64_t count(Severity severity) const {
    return examination.findings.count(severity) +
           static_cast<std::uint64_t>(std::ranges::count_if(
               container, [=](const Diagnostic& finding) { return finding.severity == severity; }));
  }
  Exit exit() const {
    if (!unreadable.empty()) return Exit::bad_input;
    if (count(Severity::error) > 0) return Exit::differs;
    return count(Severity::warning) > 0 ? Exit::odd : Exit::done;
  }
};

Visit visit(const std::string& file) {
  Visit visit{file, {}, {}, true, {}};
  TraceCheck content;
  mcap::ExamineOptions options;
  options.content = &content;
  StoppableProgress progress("examining");
  options.progress = [&](std::uint64_t done, std::uint64_t all) {
    progress.show(static_cast<std::int64_t>(done), static_cast<std::int64_t>(all));
  };
  auto examination = mcap::examine(file, options);
  if (examination)
    visit.examination = std::move(*examination);
  else
    visit.unreadable = examination.errors();
  if (auto findings = findings_of_container(file)) {
    visit.is_mcap = false;
    visit.container = *std::move(findings);
  }
  return visit;
}

/// The visits of a rosbag2 folder: its metadata.yaml, then its files.
std::vector<Visit> visit_folder(const std::string& path) {
  const auto folder = read_folder_of_log(path);
  if (!folder) return {{path, folder.errors(), {}, true, {}}};
  std::vector<Visit> visits;
  bool readable = true;
  for (const std::filesystem::path& file : folder->files) {
    visits.push_back(visit(file.string()));
    readable = readable && visits.back().unreadable.empty();
  }
  Visit metadata{folder->metadata.empty() ? path : folder->metadata.string(), {}, {}, false, {}};
  std::error_code ignored;
  if (folder->metadata.empty()) {
    metadata.container = {error_in(path, "it has no metadata.yaml", "ros2 bag reindex makes it from the files")};
    metadata.container.back().severity = Severity::warning;
    visits.insert(visits.begin(), std::move(metadata));
    return visits;
  }
  metadata.examination.size = std::filesystem::file_size(folder->metadata, ignored);
  if (readable) metadata.container = findings_of_metadata(*folder, path);
  visits.insert(visits.begin(), std::move(metadata));
  return visits;
}

std::string place_text(const mcap::Place& place) {
  if (place.inside) return fmt::format("chunk at byte {}, byte {} inside", place.offset, *place.inside);
  return fmt::format("byte {}", place.offset);
}

std::string amount_text(const Visit& visit) {
  std::string text;
  const auto add = [&](Severity severity, const char* noun) {
    const std::uint64_t count = visit.count(severity);
    if (count > 0) text += (text.empty() ? "" : ", ") + count_text(count, noun);
  };
  add(Severity::error, "error");
  add(Severity::warning, "warning");
  add(Severity::note, "note");
  return text.empty() ? "no findings" : text;
}

void tell(const Visit& visit) {
  if (!visit.unreadable.empty()) {
    std::fflush(stdout);
    fmt::print(stderr, "{}", to_string(visit.unreadable));
    return;
  }
  const mcap::Examination& examination = visit.examination;
  fmt::print("{}", to_string(visit.container));
  for (const mcap::Finding& finding : examination.findings.list())
    fmt::print("{}: {}{}: {}\n", visit.file, visit.is_mcap ? place_text(finding.place) + ": " : "",
               to_string(finding.severity), finding.message);
  fmt::print("{}: {}; {}", visit.file, amount_text(visit), file_size_text(examination.size));
  if (examination.messages > 0 || visit.is_mcap) fmt::print(", {}", count_text(examination.messages, "message"));
  fmt::print("{}\n", visit.is_mcap ? " in " + count_text(examination.chunks, "chunk") : "");
}

Json findings_json(const Visit& visit) {
  Json list = Json::array();
  for (const Diagnostic& diagnostic : visit.unreadable)
    list.push_back({{"file", visit.file},
                    {"offset", nullptr},
                    {"inside", nullptr},
                    {"severity", to_string(diagnostic.severity)},
                    {"message", diagnostic.message}});
  for (const Diagnostic& finding : visit.container)
    list.push_back({{"file", finding.file},
                    {"line", finding.line > 0 ? Json(finding.line) : Json(nullptr)},
                    {"offset", nullptr},
                    {"inside", nullptr},
                    {"severity", to_string(finding.severity)},
                    {"message", finding.message}});
  for (const mcap::Finding& finding : visit.examination.findings.list())
    list.push_back({{"file", visit.file},
                    {"offset", visit.is_mcap ? Json(finding.place.offset) : Json(nullptr)},
                    {"inside", visit.is_mcap && finding.place.inside ? Json(*finding.place.inside) : Json(nullptr)},
                    {"severity", to_string(finding.severity)},
                    {"message", finding.message}});
  return list;
}

Json visits_json(const std::vector<Visit>& visits) {
  Json files = Json::array(), findings = Json::array();
  std::uint64_t errors = 0, warnings = 0, notes = 0;
  for (const Visit& visit : visits) {
    files.push_back({{"file", visit.file},
                     {"readable", visit.unreadable.empty()},
                     {"size", visit.examination.size},
                     {"messages", visit.examination.messages},
                     {"chunks", visit.examination.chunks},
                     {"errors", visit.count(Severity::error) + visit.unreadable.size()},
                     {"warnings", visit.count(Severity::warning)},
                     {"notes", visit.count(Severity::note)}});
    errors += visit.count(Severity::error) + visit.unreadable.size();
    warnings += visit.count(Severity::warning);
    notes += visit.count(Severity::note);
    for (Json& finding : findings_json(visit)) findings.push_back(std::move(finding));
  }
  return {{"errors", errors}, {"warnings", warnings}, {"notes", notes}, {"files", files}, {"findings", findings}};
}

Exit run_doctor(const DoctorSettings& settings) {
  std::vector<Visit> visits;
  Exit exit = Exit::done;
  for (const std::string& file : settings.files) {
    const std::string folder = folder_of_log(file).string();
    for (Visit& one : folder.empty() ? std::vector{visit(file)} : visit_folder(folder)) {
      exit = worse(exit, one.exit());
      if (!settings.json) tell(one);
      visits.push_back(std::move(one));
    }
  }
  if (settings.json) print(visits_json(visits));
  return exit;
}

std::function<Exit()> declare_doctor(CLI::App& options) {
  const auto settings = std::make_shared<DoctorSettings>();
  options.add_option("FILE", settings->files, "recordings, other MCAP files, rosbag2 folders or databases")
      ->required()
      ->type_name("");
  add_json_flag(options, settings->json);
  return [settings] { return run_doctor(*settings); };
}

}  // namespace

extern const Verb doctor_verb{
    "doctor",
    "  rehearse doctor walk.mcap\n"
    "  rehearse doctor golden/*.mcap --json\n"
    "  rehearse doctor friday/\n"
    "\n"
    "error: data are lost, or a reader is misled; warning: some readers miss data; note: without harm.\n"
    "Exit status: 0 at most notes, 1 errors, 2 a file can't be read or is no log, 4 warnings and no "
    "errors.\n",
    declare_doctor};

}  // namespace rehearse::tool
