#include <rehearse/scenario.h>

#include <algorithm>

#include "base/glob.h"
#include "core/kinds/channel_name.h"

namespace rehearse {

Tolerance default_tolerance(std::string_view unit) {
  struct UnitDefault {
    std::string_view unit;
    double atol;
  };
  constexpr double edges = 0.0005;  // share of the pixels
  if (unit == "pixels") return {.pixel_share = edges, .pixel_delta = 2.0};
  if (unit == "depth") return {.rtol = 1e-3, .pixel_share = edges};
  if (unit == "range") return {.atol = 1e-9, .rtol = 0x1p-23};
  constexpr UnitDefault defaults[] = {{"rad", 1e-9},   {"m", 1e-9},   {"quaternion", 1e-9}, {"unit vector", 1e-9},
                                      {"rad/s", 1e-7}, {"m/s", 1e-7}, {"rad/s²", 1e-4},     {"m/s²", 1e-4},
                                      {"N·m", 1e-3},   {"N", 1e-4},   {"camera", 1e-9}};
  for (const UnitDefault& known : defaults)
    if (known.unit == unit) return {.atol = known.atol};
  return {};
}

const ToleranceRule* rule_for(std::string_view series, const std::vector<ToleranceRule>& rules) {
  const auto rule = std::find_if(rules.rbegin(), rules.rend(),
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
