// The table of verdicts' codes. The site's page of codes is made from the rows below: a row is a line of its table.
#include <rehearse/verdict_code.h>

#include <algorithm>
#include <array>
#include <cstddef>

namespace rehearse {
namespace {

// clang-format off
constexpr auto rows = [] {
  using enum VerdictCode;
  return std::to_array<VerdictRow>({
    {same, "same", "all that was compared is equal, bit for bit, or proved to be"},
    {within_tolerance, "same.within_tolerance", "bits differ, and every value is within its tolerance"},
    {expectations_hold, "expectations.hold", "all expectations of the scenario hold"},
    {expectations_violated, "expectations.violated", "an expectation of the scenario is violated"},
    {expectations_undecided, "expectations.undecided", "no expectation is violated, and the run lacks ticks or samples that would decide one"},
    {controller_changed, "controller.changed", "fed with the golden's inputs, a controller gives other outputs"},
    {controller_unsteady, "controller.unsteady", "a controller gives other outputs from run to run: it depends on more than its inputs"},
    {controller_surroundings_changed, "controller.surroundings_changed", "the recorded controller repeats itself, and gives other outputs than in the golden: a file or other data changed"},
    {controller_inputs_changed, "controller.inputs_changed", "a controller reads or gets other inputs than in the golden"},
    {controller_not_fed, "controller.not_fed", "the golden's inputs can't be fed to the controllers"},
    {controller_failed, "controller.failed", "a controller refused, threw, crashed or hung"},
    {simulation_exploded, "simulation.exploded", "a position or velocity of the simulation is no longer finite"},
    {costs_changed, "costs.changed", "only what control() costs differs"},
    {physics_changed, "physics.changed", "under the golden's commands, bodies move differently"},
    {sensors_changed, "sensors.changed", "under the golden's commands, bodies move alike and sensors measure differently"},
    {renderer_changed, "renderer.changed", "under the golden's commands, only pictures differ"},
    {noise_changed, "noise.changed", "the world agrees under the golden's noise or its seed"},
    {world_not_moved, "world.not_moved", "the golden's commands can't move the present world"},
    {scenario_changed, "scenario.changed", "the file of the scenario changed, and explains the difference"},
    {model_changed, "model.changed", "the file of a model changed, and explains the difference"},
    {time_step_changed, "scenario.time_step_changed", "the scenario has another time step than its golden, so that nothing was compared"},
    {duration_changed, "scenario.duration_changed", "the scenario has another duration than its golden"},
    {loop_amplified, "loop.amplified", "no part is beyond its tolerance, and the closed loop amplifies small changes beyond it"},
    {run_changed, "run.changed", "the closed loop differs, and no part of it was found that does"},
    {processor_other, "processor.other", "the golden was recorded on another processor architecture, which explains the difference as well as a change does"},
    {golden_missing, "golden.missing", "there is no golden yet"},
    {golden_written, "golden.written", "the run was written as the new golden"},
    {golden_altered, "golden.altered", "the golden isn't the run that was recorded"},
    {golden_not_certified, "golden.not_certified", "the run doesn't repeat itself, or equal programs and files gave other bits"},
    {proof_wrong, "proof.wrong", "a check was proved, and its simulation has another result"},
    {undecided_nothing_compared, "undecided.nothing_compared", "neither a value nor an expectation was there to compare"},
    {undecided_bad_input, "undecided.bad_input", "the scenario can't be read, or its golden can't be used"},
    {controller_not_finite, "controller.not_finite", "the run differs or is wrong, and a controller commands a number that isn't finite"},
  });
}();
// clang-format on

constexpr bool rows_are_in_order() {
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (static_cast<std::size_t>(rows[i].code) != i) return false;
  return true;
}
static_assert(rows_are_in_order() && static_cast<std::size_t>(VerdictCode::controller_not_finite) + 1 == rows.size(),
              "VerdictCode and this table list the same codes in the same order");

}  // namespace

std::span<const VerdictRow> verdict_rows() { return rows; }

std::string_view to_string(VerdictCode code) { return rows[static_cast<std::size_t>(code)].name; }

std::optional<VerdictCode> verdict_code_of(std::string_view name) {
  const auto found = std::ranges::find(rows, name, &VerdictRow::name);
  if (found == rows.end()) return std::nullopt;
  return found->code;
}

}  // namespace rehearse
