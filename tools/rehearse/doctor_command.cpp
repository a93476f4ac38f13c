// rehearse doctor: reports all deviations of files from the MCAP specification and from Rehearse's trace format.
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "trace/trace_doctor.h"

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

  Exit exit() const {
    if (!unreadable.empty()) return Exit::bad_input;
    return examination.findings.has_error() ? Exit::differs : Exit::done;
  }
};

Visit visit(const std::string& file) {
  Visit visit{file, {}, {}};
  TraceCheck content;
  mcap::DoctorOptions options;
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
  return visit;
}

std::string place_text(const mcap::Place& place) {
  if (place.inside) return fmt::format("chunk at byte {}, byte {} inside", place.offset, *place.inside);
  return fmt::format("byte {}", place.offset);
}

std::string amount_text(const mcap::Findings& findings) {
  std::string text;
  const auto add = [&](Severity severity, const char* noun) {
    const std::uint64_t count = findings.count(severity);
    if (count > 0) text += (text.empty() ? "" : ", ") + count_text(count, noun);
  };
  add(Severity::error, "error");
  add(Severity::warning, "warning");
  add(Severity::note, "note");
  return text.empty() ? "nothing to find fault with" : text;
}

void tell(const Visit& visit) {
  if (!visit.unreadable.empty()) {
    std::fflush(stdout);
    fmt::print(stderr, "{}", to_string(visit.unreadable));
    return;
  }
  const mcap::Examination& examination = visit.examination;
  for (const mcap::Finding& finding : examination.findings.list())
    fmt::print("{}: {}: {}: {}\n", visit.file, place_text(finding.place), to_string(finding.severity), finding.message);
  fmt::print("{}: {}; {}, {} in {}\n", visit.file, amount_text(examination.findings), file_size_text(examination.size),
             count_text(examination.messages, "message"), count_text(examination.chunks, "chunk"));
}

Json findings_json(const Visit& visit) {
  Json list = Json::array();
  for (const Diagnostic& diagnostic : visit.unreadable)
    list.push_back({{"file", visit.file},
                    {"offset", nullptr},
                    {"inside", nullptr},
                    {"severity", to_string(diagnostic.severity)},
                    {"message", diagnostic.message}});
  for (const mcap::Finding& finding : visit.examination.findings.list())
    list.push_back({{"file", visit.file},
                    {"offset", finding.place.offset},
                    {"inside", finding.place.inside ? Json(*finding.place.inside) : Json(nullptr)},
                    {"severity", to_string(finding.severity)},
                    {"message", finding.message}});
  return list;
}

Json visits_json(const std::vector<Visit>& visits) {
  Json files = Json::array(), findings = Json::array();
  std::uint64_t errors = 0, warnings = 0, notes = 0;
  for (const Visit& visit : visits) {
    const mcap::Findings& found = visit.examination.findings;
    files.push_back({{"file", visit.file},
                     {"readable", visit.unreadable.empty()},
                     {"size", visit.examination.size},
                     {"messages", visit.examination.messages},
                     {"chunks", visit.examination.chunks},
                     {"errors", found.count(Severity::error) + visit.unreadable.size()},
                     {"warnings", found.count(Severity::warning)},
                     {"notes", found.count(Severity::note)}});
    errors += found.count(Severity::error) + visit.unreadable.size();
    warnings += found.count(Severity::warning);
    notes += found.count(Severity::note);
    for (Json& finding : findings_json(visit)) findings.push_back(std::move(finding));
  }
  return {{"errors", errors}, {"warnings", warnings}, {"notes", notes}, {"files", files}, {"findings", findings}};
}

Exit run_doctor(const DoctorSettings& settings) {
  std::vector<Visit> visits;
  Exit exit = Exit::done;
  for (const std::string& file : settings.files) {
    visits.push_back(visit(file));
    exit = std::max(exit, visits.back().exit());
    if (!settings.json) tell(visits.back());
  }
  if (settings.json) print(visits_json(visits));
  return exit;
}

std::function<Exit()> declare_doctor(CLI::App& options) {
  const auto settings = std::make_shared<DoctorSettings>();
  options.add_option("FILE", settings->files, "recordings, or any other MCAP files")->required()->type_name("");
  add_json_flag(options, settings->json);
  return [settings] { return run_doctor(*settings); };
}

}  // namespace

const Verb doctor_verb{"doctor",
                       "  rehearse doctor walk.mcap\n"
                       "  rehearse doctor golden/*.mcap --json\n"
                       "\n"
                       "error: against the specification; warning: against its advice; note: unusual, and allowed.\n"
                       "Exit status: 0 no errors, 1 errors, 2 a file can't be read or is no MCAP file.\n",
                       declare_doctor};

}  // namespace rehearse::tool
