// The expectations with expressions: always, eventually and never.
#include "declared_source.h"
#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>

#include <cmath>

namespace rehearse {
namespace {

constexpr Range any_delay{0.0, Scenario::max_duration, "[s]"};

class ExpressionReader {
 public:
  ExpressionReader(Findings& findings, const Keys& keys, Expectation& expectation)
      : findings_(findings), keys_(keys), expectation_(expectation) {}

  void read();
  void declare(const Scenario& scenario);

 private:
  void read_condition(std::string_view key, std::string& to);
  void refuse_keys_of_series();
  void refuse_senseless_times();
  const YamlNode* node_of(std::string Expectation::*which) const;

  Findings& findings_;
  const Keys& keys_;
  Expectation& expectation_;
};

void ExpressionReader::read() {
  refuse_keys_of_series();
  read_condition("after", expectation_.after);
  read_condition("except", expectation_.except);
  if (const YamlNode* within = keys_.find("within"))
    expectation_.delay = read_seconds(findings_, *within, "within", any_delay);
  if (const YamlNode* lasting = keys_.find("for"))
    expectation_.lasting = read_seconds(findings_, *lasting, "for", any_delay);
  refuse_senseless_times();
}

void ExpressionReader::read_condition(std::string_view key, std::string& to) {
  const YamlNode* node = keys_.find(key);
  if (!node) return;
  const auto text = read_text(findings_, *node, key, "a condition as \"contact(LFOOT)\"");
  if (text && text->empty())
    expected(findings_, *node, key, "a condition as \"contact(LFOOT)\"");
  else if (text)
    to = *text;
}

void ExpressionReader::refuse_keys_of_series() {
  for (const std::string_view key : {"above", "below", "near", "abs", "since", "at", "sometime"})
    if (const YamlNode* node = keys_.find(key))
      findings_.error(*node, fmt::format("'{}' is given for an expression", key),
                      "an expression states its bounds itself: \"abs(SR1/WAIST/pitch) < 8 deg\"");
}

/// Reports times that have no meaning, or one that is hard to guess.
void ExpressionReader::refuse_senseless_times() {
  const bool is_always = expectation_.quantifier == Expectation::Quantifier::always;
  const YamlNode *within = keys_.find("within"), *lasting = keys_.find("for");
  if (within && !keys_.find("after") && !is_always)
    findings_.error(*within, "'within' without 'after'",
                    "expected after: a condition, from which the time is measured; until: limits the run");
  if (lasting && is_always && !keys_.find("after") && !keys_.find("except"))
    findings_.error(*lasting, "'for' without 'after' or 'except'", "what holds always also holds for a time");
}

const YamlNode* ExpressionReader::node_of(std::string Expectation::*which) const {
  if (which == &Expectation::after) return keys_.find("after");
  if (which == &Expectation::except) return keys_.find("except");
  for (const std::string_view key : {"always", "eventually", "never"})
    if (const YamlNode* node = keys_.find(key)) return node;
  return nullptr;
}

void ExpressionReader::declare(const Scenario& scenario) {
  for (const ExpressionMistake& mistake : declare_expressions(scenario, expectation_)) {
    const YamlNode& node = *node_of(mistake.which);
    const Diagnostic told = in_expression(mistake.diagnostic, expectation_.*mistake.which,
                                          {scenario.file, node.line, node.column}, node.quoted);
    YamlNode place;
    place.line = told.line;
    place.column = told.column;
    findings_.error(place, told.message, told.hint);
  }
}

/// "10 %" as a share of the bound.
std::optional<double> share_in(const YamlNode& node) {
  std::string_view rest;
  const auto number = node.kind == YamlNode::Kind::scalar ? leading_number(node.text, rest) : std::nullopt;
  while (!rest.empty() && rest.front() == ' ') rest.remove_prefix(1);
  return number && rest == "%" ? std::optional(*number / 100.0) : std::nullopt;
}

}  // namespace

void read_margin(Findings& findings, const Keys& keys, Expectation& expectation) {
  const YamlNode* node = keys.find("margin");
  if (!node) return;
  constexpr std::string_view wanted = "a share of the bound as 10 %, or a distance in the unit of what is compared";
  Expectation::Margin margin;
  if (const auto share = share_in(*node)) {
    margin = {*share, true, false, node->text};
  } else {
    std::string_view rest;
    if (node->kind != YamlNode::Kind::scalar || !leading_number(node->text, rest))
      return expected(findings, *node, "margin", wanted);
    const auto measure = read_measure(findings, *node, "margin");
    if (!measure) return;
    margin = {measure->value, false, measure->angle, node->text};
  }
  if (margin.least < 0.0) return expected(findings, *node, "margin", "a distance, at least 0");
  expectation.margin = margin;
}

void read_expressions(Findings& findings, const Keys& keys, const Scenario& scenario, Expectation& expectation) {
  ExpressionReader reader(findings, keys, expectation);
  read_margin(findings, keys, expectation);
  reader.read();
  reader.declare(scenario);
}

}  // namespace rehearse
