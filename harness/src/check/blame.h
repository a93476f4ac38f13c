// Blame: which part of the loop a check points to. What the levels leave open is found by doing parts of the run again,
// up to the tick in which it differs first.
#pragma once

#include <rehearse/check.h>

#include <filesystem>
#include <optional>
#include <string>

namespace rehearse {

/// What a check was made with.
struct Suspects {
  const Scenario& scenario;
  const Trace& golden;
  const Simulation& simulation;
  HostOptions host;               // of replays
  std::filesystem::path actual;   // the trace of level closed
  std::filesystem::path scratch;  // a trace of parts done again; removed
};

struct Blame {
  std::string sentence;  // without a full stop
  std::optional<Divergence> place;
};

/// Of a check whose levels are known. A level that nobody asked for is done up to the first difference, if closed
/// differs.
Blame find_guilty(const Suspects& suspects, const CheckReport& report);

}  // namespace rehearse
