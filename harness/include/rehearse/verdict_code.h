// The codes of verdicts: words for scripts, beside the sentences for people. A code keeps its meaning from version to
// version, and the sentence may be worded anew.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace rehearse {

enum class VerdictCode : std::uint8_t {
  same,
  within_tolerance,
  expectations_hold,
  expectations_violated,
  expectations_undecided,
  controller_changed,
  controller_unsteady,
  controller_surroundings_changed,
  controller_inputs_changed,
  controller_not_fed,
  controller_failed,
  simulation_exploded,
  costs_changed,
  physics_changed,
  sensors_changed,
  renderer_changed,
  noise_changed,
  world_not_moved,
  scenario_changed,
  model_changed,
  time_step_changed,
  duration_changed,
  loop_amplified,
  run_changed,
  processor_other,
  golden_missing,
  golden_written,
  golden_altered,
  golden_not_certified,
  proof_wrong,
  undecided_nothing_compared,
  undecided_bad_input,
  controller_not_finite,
};

/// A row of the table of codes.
struct VerdictRow {
  VerdictCode code;
  std::string_view name;     // "controller.changed": the part and its state
  std::string_view meaning;  // a sentence without a full stop
};

/// All codes, in the order of VerdictCode.
std::span<const VerdictRow> verdict_rows();

/// "controller.changed".
std::string_view to_string(VerdictCode code);

/// None: no code has this name.
std::optional<VerdictCode> verdict_code_of(std::string_view name);

}  // namespace rehearse
