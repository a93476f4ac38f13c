#include "unmatched_rules.h"

#include <fmt/format.h>

#include <utility>

#include "core/compare/series_rules.h"

namespace rehearse {

Result<std::vector<std::string>> unmatched_rule_remarks(const std::vector<ToleranceRule>& rules, const Trace& golden,
                                                        const Certificates& answers) {
  std::vector<std::string> remarks;
  if (rules.empty()) return remarks;
  const auto unmatched_line = [](const ToleranceRule& rule) { return fmt::format("\nunmatched: {}\n", rule.channel); };
  std::string stated_rules;
  for (const ToleranceRule& rule : rules) stated_rules += fmt::format("rule: {}\n", rule.channel);
  stated_rules += "end of rules\n";
  std::string facts;
  for (std::string& stated : answers.all())
    if (stated.starts_with(stated_rules)) facts = std::move(stated);
  if (facts.empty()) {
    const Trace whole = REHEARSE_TRY(Trace::load_in_pieces(golden.file(), [](const Trace&) {}));
    const Trace* traces[] = {&whole};
    facts = stated_rules;
    for (const ToleranceRule& rule : rules)
      if (!unmatched_rules({rule}, traces).empty()) facts += unmatched_line(rule);
    REHEARSE_TRY(answers.add(facts));
  }
  for (const ToleranceRule& rule : rules)
    if (facts.find(unmatched_line(rule)) != std::string::npos) remarks.push_back(to_string(applies_to_nothing(rule)));
  return remarks;
}

}  // namespace rehearse
