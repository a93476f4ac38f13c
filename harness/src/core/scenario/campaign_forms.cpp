// The keys of a scenario for campaigns.
#include "campaign_forms.h"

#include "scenario_forms.h"

namespace rehearse {
namespace {

constexpr Range any_parameter{-1e12, 1e12};
constexpr Range any_positive_parameter{0.0, 1e12, "", true};

}  // namespace

const BoundForm<Variation>& bound_parameter_form() {
  static const BoundForm<Variation> form{
      "parameter",
      "a parameter",
      {FormKey{"path", types::text(),
               "the place of the nominal value: one number or word, in one line, without anchor; or a default",
               required},
       FormKey{"uniform", types::list(types::number(any_parameter), 2, 2), "[LOW, HIGH], all numbers between them"},
       FormKey{"log_uniform", types::list(types::number(any_positive_parameter), 2, 2),
               "[LOW, HIGH], uniform in the logarithm"},
       FormKey{
           "normal", types::of(normal_form),
           "a normal distribution without its parts outside of from and to, which are within 8 deviations of the mean"},
       FormKey{"choice", types::list(types::text(), 1), "values, each as likely"},
       FormKey{"grid", types::either({types::list(types::text(), 1), types::of(grid_form)}),
               "values: all combinations of all grids, in order of the cases; the first grid changes fastest; together "
               "at most 1e8"},
       FormKey{"file", types::text(),
               "a CSV file beside the scenario: row after row, from the first again after the last"},
       FormKey{"column", types::text(), "a name in its first line; default: the parameter's"},
       FormKey{"linked", types::text(), "an expression of the parameters before it"},
       {"integer", &Variation::integer, "whole numbers only, for distributions of numbers and linked"}},
      {},
      {{"uniform", "log_uniform", "normal", "choice", "grid", "file", "linked"}}};
  return form;
}

const BoundForm<Variation>& bound_normal_form() {
  static const BoundForm<Variation> form{
      "normal",
      "normal",
      {{"mean", &Variation::mean, any_parameter, "before truncation", {"the mean before truncation"}},
       {"stddev",
        &Variation::stddev,
        any_positive_parameter,
        "before truncation",
        {"the standard deviation before truncation"}},
       {"from",
        &Variation::low,
        any_parameter,
        "the least value",
        {"the least value: physics has no infinite numbers"}},
       {"to",
        &Variation::high,
        any_parameter,
        "the largest value",
        {"the largest value: physics has no infinite numbers"}}}};
  return form;
}

const BoundForm<GridSteps>& bound_grid_form() {
  constexpr Demand a_number{"a number"};
  static const BoundForm<GridSteps> form{"grid",
                                         "a grid",
                                         {{"from", &GridSteps::from, any_parameter, "the first value", a_number},
                                          {"to", &GridSteps::to, any_parameter, "the last value", a_number},
                                          {"steps", &GridSteps::steps, {2, 1e6}, "number of values", a_number}}};
  return form;
}

const Form& parameter_form() { return bound_parameter_form(); }
const Form& normal_form() { return bound_normal_form(); }
const Form& grid_form() { return bound_grid_form(); }

}  // namespace rehearse
