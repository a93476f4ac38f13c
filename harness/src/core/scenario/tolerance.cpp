#include <rehearse/scenario.h>
#include <rehearse/units.h>

#include <algorithm>

#include "base/glob.h"
#include "core/kinds/channel_name.h"

namespace rehearse {

Tolerance default_tolerance(std::string_view unit) {
  const Unit* row = find_unit(unit);
  if (row == nullptr) return {};  // a controller's variable may have any unit
  const auto& [atol, rtol, pixel_share, pixel_delta] = row->tolerance;
  return {.atol = atol, .rtol = rtol, .pixel_share = pixel_share, .pixel_delta = pixel_delta};
}

const ToleranceRule* rule_for(std::string_view series, const std::vector<ToleranceRule>& rules) {
  const auto rule = std::ranges::find_if(rules.rbegin(), rules.rend(),
                                         [&](const ToleranceRule& one) { return matches(one.channel, series); });
  return rule == rules.rend() ? nullptr : &*rule;
}

bool is_for_commands(const ToleranceRule& rule) {
  return rule.channel.find(run_topics::output_part) != std::string::npos ||
         rule.channel.find(run_topics::variable_part) != std::string::npos || rule.channel.ends_with("/u");
}

Tolerance tolerance_of(std::string_view series, std::string_view unit, const std::vector<ToleranceRule>& rules) {
  Tolerance tolerance = default_tolerance(unit);
  if (const ToleranceRule* rule = rule_for(series, rules)) {
    tolerance.atol = rule->atol.value_or(tolerance.atol);
    tolerance.rtol = rule->rtol.value_or(tolerance.rtol);
    tolerance.lead = rule->lead.value_or(0.0);
    tolerance.lag = rule->lag.value_or(0.0);
    tolerance.ticks = rule->ticks;
    tolerance.pixel_share = rule->pixel_share.value_or(tolerance.pixel_share);
    tolerance.pixel_delta = rule->pixel_delta.value_or(tolerance.pixel_delta);
    tolerance.pixel_window = rule->pixel_window.value_or(tolerance.pixel_window);
  }
  return tolerance;
}

}  // namespace rehearse
