#include "explanation.h"

#include <fmt/format.h>

#include <optional>
#include <sstream>
#include <utility>

#include "core/check/changed_files.h"
#include "core/guard/source_line.h"
#include "line_advice.h"
#include "viewing/report/call_stack.h"
#include "wings.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

Diagnostic place_at(std::string file, int line, std::string message) {
  Diagnostic place;
  place.severity = Severity::note;
  place.file = std::move(file);
  place.line = line;
  place.message = std::move(message);
  return place;
}

/// The line that writes the first differing command; none: gdb doesn't find it.
std::optional<Diagnostic> line_of_command(const Divergence& first, const fs::path& golden, const HostOptions& host) {
  if constexpr (has_viewing) {
    const std::size_t slash = first.channel.find('/', 1), end = first.channel.find('/', slash + 1);
    if (slash == std::string::npos) return std::nullopt;
    const auto stack = call_stack_at(golden, first.channel.substr(1, end - 1), first.element, first.tick, host);
    if (!stack) return std::nullopt;
    const StackFrame& frame = stack->frames[0];
    return place_at(frame.file, frame.line,
                    fmt::format("{} writes {}, which differs at tick {}", frame.function, first.element, first.tick));
  }
  return std::nullopt;
}

}  // namespace

Explanation explain(const Scenario& scenario, const CheckReport& report, const fs::path& golden,
                    const HostOptions& host) {
  Explanation explanation;
  const auto add = [&](std::optional<Diagnostic> place) {
    if (place) explanation.places.push_back(*std::move(place));
  };
  const Diagnostic* ending = report.run ? report.run->ending() : nullptr;
  if (!ending && report.replay && report.replay->failure) ending = &*report.replay->failure;
  if (const auto line = SourceLine::at_beginning_of(ending ? ending->message : ""))
    add(place_at(line->file.string(), line->line, ending->message));
  for (const std::optional<Comparison>* compared : {&report.plant_comparison, &report.comparison}) {
    if (!*compared || (*compared)->changed_files.empty() || golden.empty()) continue;
    const auto recorded = Trace::load(golden);
    if (!recorded) break;
    for (const Diagnostic& place : places_of_changes(scenario, *recorded, (*compared)->changed_files)) add(place);
    break;
  }
  if (const auto first = first_differing_command(report)) {
    add(line_of_command(*first, golden, host));
    const std::string beside = line_of(words_beside(scenario, report, golden, host));  // it builds the project twice
    if (!beside.empty()) explanation.next.push_back(beside);
    explanation.next.push_back(fmt::format("rehearse step {}{}", golden.string(), words_of_libraries(host)));
  }
  for (const ExpectationResult& result : report.expectations)
    if (!result.holds && !result.undecided)
      add(place_at(scenario.file, result.expectation.place.line, result.sentence));
  std::istringstream lines(report.message);
  for (std::string line; std::getline(lines, line);)
    if (const std::size_t command = line.find(": rehearse "); command != std::string::npos)
      explanation.next.push_back(line.substr(command + 2));
  return explanation;
}

Json json_of(const Explanation& explanation) {
  return {{"places", json_of(explanation.places)}, {"next", explanation.next}};
}

void tell(const Explanation& explanation) {
  for (const Diagnostic& place : explanation.places) fmt::print("look at {}\n", to_string(place));
  if (explanation.places.empty()) fmt::print("no place in a file is known that explains it\n");
  for (const std::string& command : explanation.next) fmt::print("next: {}\n", command);
}

}  // namespace rehearse::tool
