// The `solver` of a scenario: settings of the physics engine.
#include "bound_form.h"
#include "scenario_forms.h"
#include "scenario_parts.h"

namespace rehearse {
namespace {

const BoundForm<SolverSettings>& bound_solver_form() {
  using enum SolverSettings::Method;
  static const BoundForm<SolverSettings> form{
      "solver",
      "the solver",
      {{"method",
        &SolverSettings::method,
        {"direct (by the tree of joints), quick (iterative, by ODE) or exact (by ODE)",
         {{"direct", direct}, {"quick", quick}, {"exact", exact}}},
        "direct: joints along their tree, contacts to convergence; quick: ODE's, iterative; exact: ODE's, slow with "
        "many contacts"},
       {"iterations",
        &SolverSettings::iterations,
        {1, SolverSettings::most_iterations},
        "number of iterations of the quick method"},
       {"over_relaxation", &SolverSettings::over_relaxation, {0.0, 2.0, "", true, true}, "factor of the quick method"},
       {"erp", &SolverSettings::erp, {0.0, 1.0}, "share of a joint's error that is corrected in a step"},
       {"cfm", &SolverSettings::cfm, {0.0, 1.0}, "softness of constraints (constraint force mixing)"},
       {"max_correcting_velocity",
        &SolverSettings::max_correcting_velocity,
        {0.0, 1e6, "[m/s]"},
        "velocity at which contacts separate overlapping shapes [m/s]"},
       {"surface_layer", &SolverSettings::surface_layer, {0.0, 1.0, "[m]"}, "depth at which contacts rest [m]"},
       {"friction", &SolverSettings::friction, any_friction, "coefficient of every contact"},
       {"max_contacts", &SolverSettings::max_contacts, {1, 1000}, "per pair of shapes"},
       {"belt_depth",
        &SolverSettings::belt_depth,
        {0.0, 1e6, "[m]", true},
        "belts of tracks don't drive deeper contacts; default: no limit; 0.005 in Choreonoid [m]"},
       {"sleep_after",
        &SolverSettings::sleep_after,
        {0.0, 1e6, "[s]"},
        "bodies without joints and devices that rest so long aren't simulated until something moves them; 0: never "
        "[s]"},
       {"sleep_speed",
        &SolverSettings::sleep_speed,
        {0.0, 1e6, "[m/s]"},
        "a body rests while no point of it is faster [m/s]"}}};
  return form;
}

}  // namespace

const Form& solver_form() { return bound_solver_form(); }

void read_solver(Findings& findings, const YamlNode& node, SolverSettings& solver) {
  bound_solver_form().read(Keys(findings, node, solver_form()), solver);
}

}  // namespace rehearse
