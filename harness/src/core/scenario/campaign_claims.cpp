#include "campaign_claims.h"

#include <rehearse/diagnostic.h>

#include <string_view>
#include <utility>

#include "bound_form.h"
#include "declared_source.h"
#include "scenario_forms.h"
#include "scenario_values.h"

namespace rehearse {
namespace {

const BoundForm<PassRateClaim>& bound_pass_rate_form() {
  static const BoundForm<PassRateClaim> form{"pass_rate",
                                             "a pass rate",
                                             {{"at_least",
                                               &PassRateClaim::at_least,
                                               {0.0, 1.0, "", true, true},
                                               "the share of the cases that must pass",
                                               {"a share between 0 and 1 of the cases, as 0.95"}},
                                              {"confidence",
                                               &PassRateClaim::confidence,
                                               {0.5, 1.0, "", false, true},
                                               "of the two-sided interval of the share that passes"}}};
  return form;
}

PlanKind read_plan(Findings& findings, const YamlNode& node) {
  constexpr std::pair<std::string_view, PlanKind> kinds[] = {
      {"random", PlanKind::random}, {"sobol", PlanKind::sobol}, {"latin_hypercube", PlanKind::latin_hypercube}};
  for (const auto& [word, kind] : kinds)
    if (node.kind == YamlNode::Kind::scalar && node.text == word) return kind;
  expected(findings, node, "plan", "random, sobol or latin_hypercube");
  return PlanKind::random;
}

std::optional<PassRateClaim> read_pass_rate(Findings& findings, const YamlNode& node) {
  const Keys keys(findings, node, pass_rate_form());
  if (!keys.is_map()) return std::nullopt;
  PassRateClaim claim;
  bound_pass_rate_form().read(keys, claim);
  return claim;
}

/// Reports mistakes in the condition that the scenario alone shows.
void declare(Findings& findings, const YamlNode& node, const Scenario& scenario, Expectation& condition) {
  for (const ExpressionMistake& mistake : declare_expressions(scenario, condition)) {
    const Diagnostic told =
        in_expression(mistake.diagnostic, condition.expression, {scenario.file, node.line, node.column}, node.quoted);
    YamlNode place;
    place.line = told.line;
    place.column = told.column;
    findings.error(place, told.message, told.hint);
  }
}

std::vector<SometimesClaim> read_sometimes(Findings& findings, const YamlNode& node, const Scenario& scenario) {
  std::vector<SometimesClaim> claims;
  if (node.kind != YamlNode::Kind::map || node.keys.empty()) {
    expected(findings, node, "sometimes", "a map from names to conditions, as it stumbled: \"abs(Arm/ROD/pitch) > 1\"");
    return claims;
  }
  for (const NamedEntry& entry : read_entries(findings, node)) {
    const YamlNode& value = *entry.value;
    const auto text = read_text(findings, value, "a condition of sometimes", "a condition as \"SR1/KNEE/u < 100\"");
    if (!text) continue;
    SometimesClaim claim{entry.name, {}};
    claim.condition.place = {scenario.file, value.line, value.column};
    claim.condition.subject = Expectation::Subject::expression;
    claim.condition.quantifier = Expectation::Quantifier::eventually;
    claim.condition.expression = *text;
    declare(findings, value, scenario, claim.condition);
    claims.push_back(std::move(claim));
  }
  return claims;
}

}  // namespace

const Form& pass_rate_form() { return bound_pass_rate_form(); }

CampaignClaims read_claims(Findings& findings, const YamlNode& root, const Scenario& scenario) {
  CampaignClaims claims;
  if (const YamlNode* node = find_key(root, "plan")) claims.plan = read_plan(findings, *node);
  if (const YamlNode* node = find_key(root, "pass_rate")) claims.pass_rate = read_pass_rate(findings, *node);
  if (const YamlNode* node = find_key(root, "sometimes")) claims.sometimes = read_sometimes(findings, *node, scenario);
  return claims;
}

CampaignClaims claims_of(const Scenario& scenario) {
  const Result<YamlNodePtr> root = parse_yaml(scenario.text, scenario.file);
  if (!root) return {};  // it was made by a program, not from a file
  Findings findings(scenario.file);
  CampaignClaims claims = read_claims(findings, **root, scenario);
  REHEARSE_ASSERT(!findings.any_error(), "a scenario that was loaded has no mistake");
  return claims;
}

}  // namespace rehearse
