#include "check_outcome.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <utility>

#include "base/write_hint.h"
#include "control_times.h"
#include "core/check/check_json.h"
#include "core/check/compared.h"
#include "core/compare/divergence_text.h"
#include "core/golden/run_folder.h"
#include "core/guard/answer.h"
#include "core/scenario/scenario_variations.h"
#include "core/scenario/trace_scenario.h"
#include "core/simulation/recorded_view.h"
#include "core/trace/run_facts.h"
#include "scenario_text.h"
#include "viewing/report/report_index.h"
#include "wings.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

std::string kind_of(bool has_golden) { return has_golden ? "golden" : "expectations"; }

Json json_of_check(const Checked& checked) {
  Json object = json_of(checked.report);
  if (!compared_anything(checked.report)) object["equal"] = object["within"] = false;
  object["scenario"] = checked.scenario;
  object["file"] = checked.file;
  object["message"] = checked.report.message;
  for (const std::string& note : checked.notes) object["remarks"].push_back(note);
  object["report"] = checked.page ? Json(checked.page->file.string()) : Json();
  object["control_times"] = json_of(control_times_of(checked.report));
  object["explanation"] = checked.explanation ? json_of(*checked.explanation) : Json();
  return object;
}

/// The verdict, the differences and what to do, in lines.
std::string details_of(const CheckReport& report) {
  const std::string bits = bits_sentence(report);
  return report.verdict.text() + '\n' + (bits.empty() ? "" : "  " + bits + '\n') + tables_text(report) + report.message;
}

/// A State of TestResult or CiCase.
template <class State>
State state_of(const CheckOutcome& outcome) {
  return outcome.exit == Exit::done ? State::passed : outcome.exit == Exit::differs ? State::differs : State::failed;
}

TestResult result_of(const CheckOutcome& outcome) {
  TestResult result;
  result.test = outcome.scenario;
  result.kind = outcome.kind;
  result.state = state_of<TestResult::State>(outcome);
  result.verdict = outcome.verdict;
  result.report = outcome.report;
  result.seconds = outcome.seconds;
  result.project = fs::path(outcome.file).parent_path();
  if (result.report.empty()) return result;
  if (outcome.tick) result.tick = *outcome.tick;
  const auto scenario = read_scenario(outcome.file);
  if (!scenario) return result;
  if (const auto trace = Trace::load(fs::path(result.report).replace_extension(".mcap")))
    result.picture = thumbnail_of(*scenario, *trace, result.tick.value_or(0));
  return result;
}

/// The summary of all scenarios: differs if any differs, else no golden, within, equal or proved if any is; not
/// compared if no scenario is.
std::string_view together(const std::vector<CheckOutcome>& all, LevelState CheckOutcome::*level) {
  for (const LevelState state :
       {LevelState::differs, LevelState::no_golden, LevelState::within, LevelState::equal, LevelState::proved})
    if (std::ranges::find(all, state, level) != all.end()) return to_string(state);
  return to_string(LevelState::not_compared);
}

/// The result of one scenario in continuous integration.
struct CiCase {
  enum class State { passed, differs, failed };  // failed: a controller failed, or nothing was compared

  std::string name;
  std::string file;  // of the scenario
  int line = 1;      // of the first violated expectation, else 1
  State state = State::passed;
  std::string verdict;   // one sentence
  std::string code;      // of the verdict
  std::string details;   // lines
  std::string report;    // an HTML file; empty: there is none
  double seconds = 0.0;  // wall time [s]
};

CiCase ci_case(const CheckOutcome& outcome) {
  CiCase one;
  one.name = outcome.scenario;
  one.file = outcome.file;
  one.verdict = headline(outcome.verdict);
  one.code = outcome.code;
  one.seconds = outcome.seconds;
  one.state = state_of<CiCase::State>(outcome);
  one.line = outcome.line;
  one.details = outcome.details;
  one.report = outcome.report;
  return one;
}

std::vector<CiCase> ci_cases(const std::vector<CheckOutcome>& all) {
  std::vector<CiCase> cases;
  for (const CheckOutcome& outcome : all) cases.push_back(ci_case(outcome));
  return cases;
}

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

const char* word_of(CiCase::State state) {
  constexpr const char* words[] = {"passed", "differs", "failed"};
  return words[static_cast<std::size_t>(state)];
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

/// The first differences with all their figures, a line each.
std::string figures_of(const CheckReport& report) {
  std::string text;
  const auto add = [&text](const char* what, const std::optional<Divergence>& place) {
    if (place) text += fmt::format("  {}: {}\n", what, describe_in_full(*place, when_text(*place)));
  };
  add("first in full", report.first);
  if (!bits_sentence(report).empty()) add("first bits in full", report.first_bit);
  return text;
}

}  // namespace

/// The members that answers pass, but `json`.
void each_member(Passed<CheckOutcome> auto& outcome, auto& each) {
  each(outcome.scenario), each(outcome.file), each(outcome.kind), each(outcome.exit), each(outcome.verdict);
  each(outcome.code), each(outcome.equal), each(outcome.within), each(outcome.proved), each(outcome.controller);
  each(outcome.plant), each(outcome.closed), each(outcome.report), each(outcome.tick), each(outcome.line);
  each(outcome.seconds), each(outcome.notes), each(outcome.details), each(outcome.history);
}

Result<Scenario> read_scenario(const std::string& file, const StatedValues& values) {
  if (!file.ends_with(".mcap")) return values.empty() ? Scenario::load(file) : load_with(file, values);
  if (!values.empty()) return error_in(file, "--with changes a scenario, and this is a recording");
  const auto trace = REHEARSE_TRY(mcap::Reader::open(file));
  if (RunFacts::of(*trace).is_of_log) return scenario_of(*trace);
  return error_in(file, "it isn't a recording of a robot's log", "check the scenario, with --golden and this trace");
}

Exit exit_of(const CheckReport& report) {
  if (report.failed()) return Exit::controller_failed;
  if (!compared_anything(report)) return Exit::bad_input;
  if (report.undecided()) return Exit::odd;
  return report.within() || report.golden_written ? Exit::done : Exit::differs;
}

void tell_verdict(const Checked& checked, bool verbose) {
  const CheckReport& report = checked.report;
  const std::string closest = report.within() ? closest_of(report.expectations) : "";
  const std::string shown = in_lines(
      fmt::format("{}: {}{}{}", checked.scenario, report.verdict.text(), closest.empty() ? "" : "; ", closest));
  fmt::print("{}\n", colored(shown, report.within() ? TextColor::green : TextColor::red));
  if (const std::string bits = bits_sentence(report); !bits.empty()) fmt::print("  {}\n", bits);
  fmt::print("  {}; {:.1f} s\n", levels_text(report), checked.seconds);
  std::fflush(stdout);
  if (report.failed() && !verbose) return;  // differences behind a crash are no news
  if (verbose) {
    fmt::print("{}{}", closest_lines(report.expectations), figures_of(report));
    tell_control_times(control_times_of(report));
  }
  // beside a difference, only a change may explain it
  if (!report.not_proved.empty() &&
      (report.within() || report.not_proved.ends_with(" changed since its golden was simulated")))
    fmt::print("  simulated, not proved: {}\n", report.not_proved);
  if (report.plant_run && !report.plant_run->from_the_start.empty())
    fmt::print("  without checkpoints, from the start: {}\n", report.plant_run->from_the_start);
  fmt::print("{}", tables_text(report));
  std::fflush(stdout);
}

namespace {

/// The command that stops at a failure is the last line of its message, and names the file, too.
std::string last_line_of(const std::string& message) { return message.substr(message.rfind('\n') + 1); }

}  // namespace

void tell_files(const Checked& checked, bool verbose) {
  const CheckReport& report = checked.report;
  const bool is_short = report.failed() && !verbose;
  if (!is_short)
    for (const std::string& remark : report.remarks) fmt::print("  note: {}\n", remark);
  if (!report.message.empty()) fmt::print("{}\n", is_short ? last_line_of(report.message) : report.message);
  if (checked.explanation) tell(*checked.explanation);
  if (!checked.line_advice.empty()) fmt::print("which line: {}\n", checked.line_advice);
  if (checked.page && is_ci()) fmt::print("report: {}\n", checked.page->file.string());
  if (checked.page && !is_ci())
    if constexpr (has_viewing)
      fmt::print("in a browser: {}\n", report_link(checked.page->file, checked.page->summary.first_tick));
  if (!checked.no_page.empty()) fmt::print("  note: there is no report to look at: {}\n", checked.no_page);
  std::fflush(stdout);  // before related output on stderr
  if (!report.run) return;
  const Diagnostic* ending = report.run->ending();
  if (is_short && ending && report.verdict.text().find(ending->message) != std::string::npos)
    tell_remarks(report.run->remarks, *ending);  // the verdict has said it
  else
    tell_remarks(*report.run);
}

CheckOutcome outcome_of(const Scenario& scenario, const Checked& checked, bool json) {
  const CheckReport& report = checked.report;
  CheckOutcome outcome{.scenario = checked.scenario,
                       .file = checked.file,
                       .kind = kind_of(!scenario.golden.empty()),
                       .exit = exit_of(report),
                       .verdict = report.verdict.text(),
                       .code = report.verdict.code(),
                       .equal = compared_anything(report) && report.equal(),
                       .within = compared_anything(report) && report.within(),
                       .proved = report.proved,
                       .controller = report.controller,
                       .plant = report.plant,
                       .closed = report.closed,
                       .seconds = checked.seconds,
                       .notes = checked.notes,
                       .details = details_of(report)};
  if (json) outcome.json = json_of_check(checked);
  if (const ExpectationResult* violation = first_violation(report.expectations))
    outcome.line = violation->expectation.place.line;
  if (checked.page) {
    outcome.report = checked.page->file.string();
    outcome.tick = checked.page->summary.first_tick;
  }
  return outcome;
}

CheckOutcome outcome_without_verdict(const std::string& scenario, const std::string& file, bool has_golden,
                                     const Diagnostics& errors) {
  CheckOutcome outcome{.scenario = scenario,
                       .file = file,
                       .kind = kind_of(has_golden),
                       .exit = Exit::bad_input,
                       .verdict = "not judged: " + errors.at(0).message,
                       .code = std::string(to_string(VerdictCode::undecided_bad_input)),
                       .details = to_string(errors)};
  outcome.json = {
      {"scenario", scenario}, {"file", file},    {"verdict", outcome.verdict},          {"code", outcome.code},
      {"equal", false},       {"within", false}, {"codes", Json::array({outcome.code})}};
  return outcome;
}

std::string form_of(const CheckOutcome& outcome) {
  AnswerWriter form;
  form(outcome);
  const Json& json = outcome.json;
  form(json.is_null() ? std::string() : json.dump(-1, ' ', false, Json::error_handler_t::replace));
  return form.text();
}

std::optional<CheckOutcome> outcome_in(std::string_view form) {
  CheckOutcome outcome;
  std::string json;
  AnswerReader reader(form);
  reader(outcome);
  reader(json);
  if (!json.empty()) outcome.json = Json::parse(json, nullptr, false);
  const bool is_whole = reader.is_whole() && !outcome.json.is_discarded();
  return is_whole ? std::optional(std::move(outcome)) : std::nullopt;
}

Json json_of_checks(const std::vector<CheckOutcome>& all) {
  const auto bad = std::ranges::find(all, false, &CheckOutcome::within);
  const auto all_are = [&](bool CheckOutcome::*member) {
    return std::ranges::all_of(all, [&](const CheckOutcome& outcome) { return outcome.*member; });
  };
  Json scenarios = Json::array();
  for (const CheckOutcome& outcome : all) scenarios.push_back(outcome.json);
  return {{"verdict", bad == all.end() ? fmt::format("{} as they should be", count_text(std::ssize(all), "scenario"))
                                       : bad->scenario + ": " + bad->verdict},
          {"code", bad == all.end() ? Json() : Json(bad->code)},
          {"equal", all_are(&CheckOutcome::equal)},
          {"within", bad == all.end()},
          {"proved", all_are(&CheckOutcome::proved)},
          {"levels",
           {{"controller", together(all, &CheckOutcome::controller)},
            {"plant", together(all, &CheckOutcome::plant)},
            {"closed", together(all, &CheckOutcome::closed)}}},
          {"first", bad == all.end() ? Json() : bad->json.value("first", Json())},
          {"scenarios", scenarios}};
}

void tell_unjudged(const std::vector<CheckOutcome>& all) {
  std::vector<std::string> names;
  for (const CheckOutcome& outcome : all)
    if (outcome.exit == Exit::bad_input) names.push_back(outcome.scenario);
  if (names.empty() || all.size() < 2) return;
  std::fflush(stdout);
  fmt::print(stderr, "{} of {} scenarios {} judged: {}\n", names.size(), all.size(),
             names.size() == 1 ? "wasn't" : "weren't", fmt::join(names, ", "));
}

void keep_index(const std::vector<CheckOutcome>& all, const fs::path& folder, bool tells) {
  if constexpr (has_viewing) {
    std::error_code ignored;
    const bool all_passed = std::ranges::all_of(all, &CheckOutcome::within);
    if (all_passed && !fs::exists(folder / "index.html", ignored)) return;
    const FolderLock alone(folder);
    for (const CheckOutcome& outcome : all) keep_result(folder, result_of(outcome));
    const auto index = refresh_index(folder);
    if (!index || all_passed || !tells) return;
    fmt::print("all reports: {}\n", is_ci() ? index->string() : report_link(*index));
  }
}

Result<void> write_junit(const fs::path& file, const std::vector<CheckOutcome>& all) {
  const std::vector<CiCase> cases = ci_cases(all);
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
      xml.PushAttribute("type", one.code.c_str());
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
  if (!stream)
    return error(fmt::format("can't write {}", file.string()), write_hint(file, "name another file with --junit"));
  return {};
}

Result<void> print_for_github(const std::vector<CheckOutcome>& all) {
  const std::vector<CiCase> cases = ci_cases(all);
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
