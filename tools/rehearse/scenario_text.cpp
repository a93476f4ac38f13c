#include "scenario_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "base/names.h"
#include "output.h"

namespace rehearse::tool {
namespace {

std::string controllers_of(const ScenarioBody& body) {
  std::string names;
  for (const ScenarioController& controller : body.controllers) {
    names += (names.empty() ? "" : " and ") + controller.name;
    for (const ScenarioController& child : controller.children) names += " and " + child.name;
  }
  return names;
}

}  // namespace

void tell_warnings(const Scenario& scenario) {
  for (const Diagnostic& warning : scenario.warnings)
    if (warning.severity != Severity::note) fmt::print(stderr, "{}\n", to_string(warning));
}

void tell_remarks(const RunSummary& summary) {
  tell_remarks(summary.remarks, summary.failure);
  if (summary.failure) fmt::print(stderr, "{}\n", to_string(*summary.failure));
}

void tell_violations(const std::vector<ExpectationResult>& results, const Diagnostics& mistakes) {
  for (const ExpectationResult& result : results) {
    const Place& place = result.expectation.place;
    const bool is_mistake = std::ranges::any_of(mistakes, [&](const Diagnostic& mistake) {
      return mistake.line == place.line && mistake.column == place.column;
    });
    const Severity severity = is_mistake ? Severity::error : Severity::warning;
    if (!result.holds)
      fmt::print(stderr, "{}\n",
                 to_string(Diagnostic{severity, place.file, place.line, place.column, result.sentence, ""}));
  }
}

std::string cast_of(const Scenario& scenario) {
  constexpr std::size_t most = 8;
  std::vector<std::string> cast;
  for (const ScenarioBody& body : scenario.bodies) {
    const std::string controllers = controllers_of(body);
    const bool scenery = body.fixed && body.model->joints.empty() && controllers.empty();
    if (scenery) continue;
    cast.push_back(body.name + (controllers.empty() ? "" : " under " + controllers));
  }
  return cast.empty() ? "nothing that moves" : listed(cast, most);
}

}  // namespace rehearse::tool
