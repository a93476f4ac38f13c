// The forms of varied parameters, whose keys are read into members.
#pragma once

#include <rehearse/scenario.h>

#include "bound_form.h"

namespace rehearse {

/// Evenly spaced values, both ends included.
struct GridSteps {
  double from = 0.0, to = 0.0;
  int steps = 0;
};

const BoundForm<Variation>& bound_parameter_form();
const BoundForm<Variation>& bound_normal_form();
const BoundForm<GridSteps>& bound_grid_form();

}  // namespace rehearse
