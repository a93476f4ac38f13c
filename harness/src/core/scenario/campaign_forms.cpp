// The keys of a scenario for campaigns.
#include "scenario_forms.h"
#include "scenario_parts.h"

namespace rehearse {
namespace {

constexpr Range any_parameter{-1e12, 1e12};
constexpr Range any_positive_parameter{0.0, 1e12, "", true};

}  // namespace

const Form& parameter_form() {
  static const Form form{"parameter",
                         "a parameter",
                         {{"path", types::text(), "the place of its value, as bodies.Box.mass", required},
                          {"uniform", types::list(types::number(any_parameter), 2, 2), "[LOW, HIGH]"},
                          {"log_uniform", types::list(types::number(any_positive_parameter), 2, 2), "[LOW, HIGH]"},
                          {"normal", types::of(normal_form), "a truncated normal distribution"},
                          {"choice", types::list(types::text(), 1), "values, drawn with equal chances"},
                          {"grid", types::either({types::list(types::text(), 1), types::of(grid_form)}),
                           "values, each with all of the other grids"},
                          {"file", types::text(), "a CSV file with a value for each case"},
                          {"column", types::text(), "its column; default: the parameter's name"},
                          {"linked", types::text(), "an expression of other parameters"},
                          {"integer", types::flag(), "values are rounded", "false"}},
                         {},
                         {{"uniform", "log_uniform", "normal", "choice", "grid", "file", "linked"}}};
  return form;
}

const Form& normal_form() {
  static const Form form{"normal",
                         "normal",
                         {{"mean", types::number(any_parameter), "before truncation", required},
                          {"stddev", types::number(any_positive_parameter), "before truncation", required},
                          {"from", types::number(any_parameter), "the least value", required},
                          {"to", types::number(any_parameter), "the largest value", required}}};
  return form;
}

const Form& grid_form() {
  static const Form form{"grid",
                         "a grid",
                         {{"from", types::number(any_parameter), "the first value", required},
                          {"to", types::number(any_parameter), "the last value", required},
                          {"steps", types::whole(2, 1e6), "number of values", required}}};
  return form;
}

const Form& pass_rate_form() {
  static const Form form{
      "pass_rate",
      "a pass rate",
      {{"at_least", types::number({0.0, 1.0, "", true, true}), "the share of the cases that must pass", required},
       {"confidence", types::number({0.5, 1.0, "", false, true}), "with which it is claimed", "0.95"}}};
  return form;
}

}  // namespace rehearse
