// Blame: the part of the loop that caused a difference. If the levels leave this open, parts of the run are repeated,
// up to the tick of its first difference.
#pragma once

#include <rehearse/check.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// The inputs of a check.
struct Suspects {
  const Scenario& scenario;
  const Trace& golden;
  const Simulation& simulation;
  HostOptions host;               // options of replays
  std::filesystem::path actual;   // the trace of level closed
  std::filesystem::path scratch;  // a trace of repeated parts; removed
};

struct Blame {
  Verdict verdict;
  std::optional<Divergence> place;               // the first difference beyond tolerance, if there is one
  std::optional<Divergence> bit = std::nullopt;  // the first difference in any bit; none: the sentence states it
  bool is_of_structure = false;                  // the scenario or a model has other parts
};

/// Adds the results of levels that were not requested, if level closed differs: of the plant up to its first
/// difference.
void compare_other_levels(const Suspects& suspects, CheckReport& report);

/// The result for a check whose levels have results.
Blame find_guilty(const Suspects& suspects, const CheckReport& report);

}  // namespace rehearse
