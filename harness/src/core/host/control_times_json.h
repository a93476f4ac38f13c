// The times of control() as JSON, for commands and reports. Internal.
#pragma once

#include <rehearse/run_options.h>

#include <nlohmann/json.hpp>
#include <utility>

namespace rehearse {

/// An object with the members of ControlTimes, without its costs; each bin of the histogram is a pair.
inline nlohmann::ordered_json json_of(const ControlTimes& times) {
  nlohmann::ordered_json bins = nlohmann::ordered_json::array();
  for (const auto& [end, calls] : times.histogram) bins.push_back({end, calls});
  return {{"controller", times.controller},
          {"period", times.period},
          {"calls", times.calls},
          {"median", times.median},
          {"p999", times.p999},
          {"longest", times.longest},
          {"longest_tick", times.longest_tick},
          {"histogram", std::move(bins)}};
}

}  // namespace rehearse
