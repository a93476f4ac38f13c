#include "other_processor.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/replay.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "core/compare/divergence_text.h"
#include "core/recording/provenance.h"
#include "core/trace/run_facts.h"

namespace rehearse {
namespace {

/// True for the codes of changes that differ from other rounding by nothing that a check can see.
bool looks_like_rounding(VerdictCode code) {
  using enum VerdictCode;
  constexpr std::array codes{controller_changed,
                             controller_surroundings_changed,
                             controller_inputs_changed,
                             physics_changed,
                             sensors_changed,
                             renderer_changed,
                             loop_amplified,
                             run_changed};
  return std::ranges::find(codes, code) != codes.end();
}

/// The first differences of the levels, as measured, without a reason.
std::string differences_text(const CheckReport& evidence) {
  std::vector<std::string> parts;
  if (evidence.controller == LevelState::differs && evidence.replay)
    parts.push_back("fed with the golden's inputs, " + headline(*evidence.replay, "", "the controller "));
  if (evidence.plant == LevelState::differs && evidence.plant_comparison)
    parts.push_back("under the golden's commands, the world " + verdict(*evidence.plant_comparison));
  if (parts.empty() && evidence.comparison) parts.push_back("the run " + verdict(*evidence.comparison));
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace

Architectures Architectures::of(const Scenario& scenario, const Trace& golden) {
  const auto recorded = RunFacts::of(golden).provenance;
  const std::string here = architecture_of(provenance(scenario, nullptr, "", ""));
  return {recorded ? architecture_of(*recorded) : here, here};
}

Blame on_this_processor(Blame found, const CheckReport& evidence, const Architectures& architectures) {
  const auto& [golden, here] = architectures;
  if (golden == here) return found;
  if (found.verdict.code() == to_string(VerdictCode::within_tolerance))
    found.verdict = {VerdictCode::within_tolerance,
                     fmt::format("{}; the golden is of {} and this run of {}, so only tolerances were demanded",
                                 found.verdict.text(), golden, here)};
  // rounding makes no controller fail; one that couldn't be fed has no place
  const bool can_be_rounding = found.place && !evidence.failed();
  if (!can_be_rounding || std::ranges::none_of(found.verdict.codes(), looks_like_rounding)) return found;
  found.verdict = {
      VerdictCode::processor_other,
      fmt::format("the golden is of {} and this run of {}, which rounds differently: that explains the difference as "
                  "well as a change does; {}",
                  golden, here, differences_text(evidence))};
  return found;
}

}  // namespace rehearse
