#include <rehearse/check.h>

#include <fmt/format.h>

#include <utility>

#include "check_levels.h"
#include "check_verdict.h"
#include "code_of.h"
#include "core/compare/compare_structure.h"
#include "core/kinds/channel_name.h"
#include "core/scenario/branch_origin.h"
#include "core/trace/run_facts.h"
#include "core/trace/trace_windows.h"
#include "own_run.h"
#include "proof.h"
#include "unknown_series.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// Reads the events and commands of a golden: a run that begins at one of its checkpoints needs no more of it. The CRC
/// of its data section covers the rest.
Result<Trace> load_commands(const fs::path& golden) {
  const auto wanted = [](const mcap::Channel& channel) {
    const ChannelName name = ChannelName::parse(channel.topic);
    return name.kind == ChannelKind::events || name.side == ChannelSide::output || name.side == ChannelSide::acted;
  };
  return load_pieces(
      golden, wanted, [](const Trace&) {}, Trace::usual_piece_size, PieceOrder::of_file);
}

/// The reason why the golden's world can't be simulated again: then only its controllers can be checked. Empty: it can
/// be simulated again.
std::string why_no_world(const Trace& golden) {
  const RunFacts run = RunFacts::of(golden);
  if (run.is_of_log) return "the golden was recorded from a log: there is no physics to repeat";
  const std::optional<BranchOrigin>& origin = run.branch;
  if (origin && !origin->simulated) return "the golden is a replay: its world didn't follow its commands";
  if (origin && !origin->set.empty())
    return "the golden is a branch with altered inputs: a simulation doesn't make them again";
  return {};
}

/// Adds the pushes of a branch to those of its scenario.
Result<Scenario> with_pushes_of(const std::optional<BranchOrigin>& origin, Scenario scenario) {
  if (!origin) return scenario;
  for (const std::string& text : origin->push) {
    Push push = REHEARSE_TRY(parse_push(text, scenario));
    scenario.pushes.push_back(std::move(push));
  }
  return scenario;
}

/// Leaves out the levels that the golden can't have.
void leave_out_levels(const Trace& golden, CheckOptions& options, CheckReport& report) {
  const auto origin = RunFacts::of(golden).branch;
  if (const std::string why = why_no_world(golden); !why.empty()) {
    options.plant = options.closed = false;
    report.remarks.push_back(why + ", so the levels plant and closed are not compared");
  } else if (origin && origin->acted_until) {
    options.closed = false;
    report.remarks.push_back(
        fmt::format("the golden is a branch: until tick {} other controllers moved its world, so the "
                    "level closed is not compared",
                    *origin->acted_until));
  }
}

void remove_run_of(const fs::path& actual) {
  std::error_code ignored;
  fs::remove(actual, ignored);
  remove_picture_differences(actual);
}

/// Simulates a share of the proved checks as well.
Result<CheckReport> sampled(Check check) {
  const auto chosen = REHEARSE_TRY(is_sampled(check.scenario.name, check.options.sampled));
  if (!chosen) return std::move(check.report);
  CheckOptions simulating = check.options;
  simulating.certificates.reset();
  auto again = check_scenario(check.scenario, check.golden.file(), check.actual, simulating, check.simulation);
  if (!again) return again;
  if (again->equal()) return std::move(check.report);
  again->verdict.lead(
      VerdictCode::proof_wrong,
      "the proof was wrong: it found no change since the golden, but the simulation has another result");
  again->proof_was_wrong = true;
  return again;
}

}  // namespace

Result<CheckReport> check_scenario(const Scenario& plain, const fs::path& golden, const fs::path& actual,
                                   const CheckOptions& asked, const Simulation& given) {
  Simulation simulation = given;
  simulation.run_plant = own_plant(std::move(simulation.run_plant));
  const auto outline = Trace::outline(golden);
  if (!outline) {  // a pass over the whole file finds the damage
    const auto whole = load_without_messages(golden);
    return whole ? outline.errors() : whole.errors();
  }
  REHEARSE_TRY(check_version(*outline));
  const Scenario scenario = REHEARSE_TRY(with_pushes_of(RunFacts::of(*outline).branch, plain));
  CheckOptions options = asked;
  Check proving{scenario, *outline, actual, options, simulation, {}};
  leave_out_levels(*outline, options, proving.report);
  const Proof proof(scenario, *outline, options, simulation);
  if (proof.holds()) REHEARSE_TRY(proving.check_proved(proof));
  if (proving.report.proved) {
    REHEARSE_TRY(refuse_unknown_series(scenario, proving.report, {golden}));
    return sampled(std::move(proving));
  }

  const auto expected = REHEARSE_TRY(proof.holds() ? load_commands(golden) : load_without_messages(golden));
  Check check{scenario, expected, actual, options, simulation, std::move(proving.report)};
  check.report.not_proved = proof.objection();
  check.world_is_known = proof.holds();
  REHEARSE_TRY(check.simulate());
  const bool is_told = check.report.verdict.code() == to_string(code_of_failure(check.report));
  if (check.report.failed() && !is_told) check.report.verdict.lead(code_of_failure(check.report));
  tell_odd_command(check.report);
  if (auto known = refuse_unknown_series(scenario, check.report, {golden, actual}); !known) {
    remove_run_of(actual);
    return known.errors();
  }
  REHEARSE_TRY(check.certify(proof));
  if (check.report.within()) remove_run_of(actual);
  return std::move(check.report);
}

}  // namespace rehearse
