// The judgement of one controller from the replays of an audit: the factors that changed its commands, and the reason.
#pragma once

#include <rehearse/audit.h>

#include <string>
#include <utility>
#include <vector>

#include "experiments.h"
#include "library_scan.h"
#include "replay_process.h"

namespace rehearse {

/// All replays of an audit with their outcomes.
struct Evidence {
  ReplayOutcome plain, still;
  std::vector<Experiment> experiments;
  std::vector<std::vector<ReplayOutcome>> outcomes;  // by experiment
  double time_step = 0.0;                            // [s]
  bool recorded_here = false;   // the recording was made for this audit, by the present controllers
  bool virtualised = false;     // controllers get simulated time and seeded random numbers
  bool fixed_addresses = true;  // addresses could be held constant
};

/// The calls of one controller, or of all if it is empty, in the plain and the still replay, each once.
std::vector<ObservedCall> calls_of(const Evidence& evidence, const std::string& controller);

/// The first difference between replays for one controller, or for all if it is empty. A failure in only one of two is
/// a difference too.
std::optional<Divergence> difference(const ReplayPass& expected, const ReplayPass& actual, double time_step,
                                     const std::string& controller);

/// Finds the factors that change the controller's outputs.
std::vector<FactorResult> judge_factors(const Evidence& evidence, const std::string& controller);

/// True if a repeated still replay gave the same outputs.
bool is_repeatable(const Evidence& evidence, const std::string& controller);

const FactorResult* find_factor(const std::vector<FactorResult>& factors, Factor factor);
/// True if the replays under this factor differ.
bool differs_under(const std::vector<FactorResult>& factors, Factor factor);

/// Describes the call with all findings, before its effect on commands is known.
AuditedCall describe(const ObservedCall& call, const Evidence& evidence);

/// Determines whether the answers of calls reached an output. `tried`: calls that got a different answer one by one,
/// with the result. The audit's calls are in the order of `seen`.
void judge_calls(const Evidence& evidence, const std::vector<ObservedCall>& seen, ControllerAudit& audit,
                 const std::vector<std::pair<CodePlace, bool>>& tried);

/// The calls with answers that were equal in all replays, and the code that depends on the processor.
std::vector<std::string> what_it_rests_on(const Evidence& evidence, const std::vector<ObservedCall>& seen,
                                          const ControllerAudit& audit);

/// Sets deterministic, reason, depends_on and first, from all other members.
void conclude(const Evidence& evidence, const std::vector<ObservedCall>& seen, ControllerAudit& audit);

/// A sentence for each change that a controller made to its process.
std::vector<std::string> liberties_of(const std::vector<ObservedCall>& calls);

}  // namespace rehearse
