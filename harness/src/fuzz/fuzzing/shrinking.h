// Shrinking: fewer ticks, fewer inputs, fewer changes and rounder numbers that break a controller in the same way.
// Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include "input_run.h"
#include "input_workers.h"

namespace rehearse {

struct ShrunkInputs {
  Inputs inputs;
  InputOutcome outcome;  // of their run
  int runs = 0;
};

/// Shrinks by delta debugging (A. Zeller, R. Hildebrandt, Simplifying and Isolating Failure-Inducing Input, IEEE
/// Transactions on Software Engineering 28 (2002)). Fails as InputWorkers::run.
Result<ShrunkInputs> shrink_inputs(InputWorkers& workers, const FuzzSetup& setup, const Inputs& inputs,
                                   const InputOutcome& outcome);

}  // namespace rehearse
