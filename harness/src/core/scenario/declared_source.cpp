#include "declared_source.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/expression/joint_series.h"
#include "core/expression/name_search.h"
#include "joint_limit.h"

namespace rehearse {

DeclaredSource::DeclaredSource(const Scenario& scenario)
    : scenario_(scenario), joints_(rehearse::joint_names(scenario)), links_(link_names(scenario)) {}

Result<std::size_t> DeclaredSource::find_series(std::string_view name) {
  if (name.empty()) return error("this name is empty");
  for (const std::string& spelling : spellings_of(name)) {
    patterns_.push_back(spelling);
    patterns_.push_back("*/" + spelling);
  }
  return std::size_t{0};
}

Result<std::vector<std::size_t>> DeclaredSource::find_links(std::string_view name) {
  const auto is_of_body = [&](const std::string& link) { return link.starts_with(std::string(name) + "/"); };
  if (scenario_.bodies.empty() || std::ranges::any_of(links_, is_of_body)) return std::vector<std::size_t>{0};
  const auto found = REHEARSE_TRY(find_name(name, links_, "link"));
  return std::vector<std::size_t>{found};
}

Result<std::size_t> DeclaredSource::find_joint_series(std::string_view joint, std::string_view quantity,
                                                      bool of_command) {
  std::string_view name = joint;
  if (!scenario_.bodies.empty()) {
    const auto found = REHEARSE_TRY(find_name(joint, joints_, "joint"));
    name = joints_[found];
  }
  const std::size_t slash = name.rfind('/');
  const std::string body = slash == std::string_view::npos ? "*" : std::string(name.substr(0, slash));
  const std::string_view last = slash == std::string_view::npos ? name : name.substr(slash + 1);
  patterns_.push_back(fmt::format("{}/{}{}/{}", body, of_command ? "*/output/" : "", last, quantity));
  return std::size_t{0};
}

Result<JointLimit> DeclaredSource::find_limit(std::string_view joint, std::string_view limit) {
  auto found = joint_limit(scenario_, joint, limit);
  if (found) limits_[fmt::format("{} {}", joint, limit)] = {found->value, found->unit};
  return found;
}

std::vector<ExpressionMistake> declare_expressions(const Scenario& scenario, Expectation& expectation) {
  DeclaredSource source(scenario);
  std::vector<ExpressionMistake> mistakes;
  for (std::string Expectation::*which : {&Expectation::expression, &Expectation::after, &Expectation::except}) {
    const std::string& text = expectation.*which;
    if (text.empty() && which != &Expectation::expression) continue;
    const auto parsed = Expression::parse(text, source);
    if (!parsed) {
      mistakes.push_back({which, parsed.errors().front()});
    } else if (parsed->type() != Expression::Type::boolean) {
      mistakes.push_back({which, error("this is a number, and a condition is expected", "compare it: x < 1")});
      mistakes.back().diagnostic.column = 1;
    } else if (which == &Expectation::expression && expectation.margin && !parsed->has_margin()) {
      mistakes.push_back({which, error("this compares no numbers, so it has no margin", "leave out 'margin'")});
      mistakes.back().diagnostic.column = 1;
    }
  }
  expectation.names = source.names();
  expectation.limits = source.limits();
  return mistakes;
}

Diagnostic in_expression(const Diagnostic& mistake, const std::string& expression, const Place& place, bool in_quotes) {
  Diagnostic found = mistake;
  found.file = place.file;
  found.line = place.line;
  found.column = place.column + std::max(mistake.column, 1) - 1 + (in_quotes ? 1 : 0);
  if (found.hint.empty()) found.hint = "rehearse doc expressions describes the language";
  found.message += "\n" + caret_lines(expression, mistake.column);  // the hint follows the caret
  return found;
}

}  // namespace rehearse
