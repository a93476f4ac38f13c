// The controllers' variables that are compared. Variables are internals of a controller: they affect a verdict only if
// a tolerance rule names them by a pattern with "/variable/" in it.
#pragma once

#include <rehearse/scenario.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "mcap/glob.h"
#include "trace/channel_name.h"

namespace rehearse {

/// `series`: "SR1/Walker/variable/phase".
inline bool asks_for_variable(std::string_view series, const std::vector<ToleranceRule>& rules) {
  return std::any_of(rules.begin(), rules.end(), [&](const ToleranceRule& rule) {
    return rule.channel.find(run_topics::variable_part) != std::string::npos && matches(rule.channel, series);
  });
}

}  // namespace rehearse
