// The parts of several objects.
#include "json_forms.h"

#include <rehearse/run_options.h>
#include <rehearse/verdict_code.h>

#include <string>
#include <utility>
#include <vector>

namespace rehearse::tool {
const Form& cost_count_form() {
  static const Form form{"cost_count",
                         "a count of costs",
                         {member("total", types::count()), member("ticks", types::count()),
                          member("first_tick", types::nullable(types::count()))}};
  return form;
}

namespace {

const Form& first_difference_form() {
  static const Form form{
      "difference",
      "a difference",
      {member("tick", types::nullable(types::whole(-1, 1e15))), member("time", types::real()),
       member("channel", types::string()), member("element", types::string()),
       member("expected", types::nullable(types::real())), member("actual", types::nullable(types::real())),
       member("difference", types::nullable(types::real())), member("relative", types::nullable(types::real())),
       member("ulps", types::nullable(types::count())), member("tolerance", types::nullable(types::real())),
       member("times_tolerance", types::nullable(types::real())), member("unit", types::string()),
       member("note", types::string()),
       member("stage", types::word({"inputs", "controller", "physics", "sensors", "renderer", "costs"})),
       member_if("beside", "the distance from the values within lead and lag", types::real())}};
  return form;
}

const Form& finding_form() {
  static const Form form{
      "finding",
      "a finding",
      {member("file", types::string()), member("line", types::whole(-1, 1e9)), member("column", types::whole(-1, 1e9)),
       member("severity", types::word({"error", "warning", "note"})), member("message", types::string()),
       member("hint", types::string())}};
  return form;
}

const Form& closest_form() {
  static const Form form{
      "closest",
      "the place of the margin",
      {member("margin", types::real()), member("value", types::real()), member("bound", types::real()),
       member("unit", types::string()), member("share", types::nullable(types::real())),
       member("tick", types::whole(-1, 1e15)), member("time", types::real()), member("text", types::string())}};
  return form;
}

const Form& violation_form() {
  static const Form form{"violation",
                         "the first sample that violates an expectation",
                         {member("series", types::string()), member("tick", types::whole(-1, 1e15)),
                          member("time", types::real()), member("value", types::nullable(types::real()))}};
  return form;
}

const Form& judged_expectation_form() {
  static const Form form{
      "judged_expectation",
      "a judged expectation",
      {member("text", types::string()), member("line", types::whole(-1, 1e9)), member("holds", types::flag()),
       member("first", types::nullable(types::of(violation_form))), member("undecided", types::flag()),
       member("not_judged", types::array(types::string())), member("formula", types::string()),
       member("margin", types::nullable(types::real())), member("closest", types::nullable(types::of(closest_form)))}};
  return form;
}

const Form& costs_form() {
  static const Form form = [] {
    Form costs{"costs",
               "the costs of a controller",
               {member("realtime_safe", types::flag()), member("page_faults", types::of(cost_count_form))}};
    static const ControlCosts named = [] {
      ControlCosts counted;
      counted.add(0, {}, 0);  // names the counts
      return counted;
    }();
    for (const ControlCosts::Count& count : named.counts)
      costs.keys.push_back(member(count.name, types::of(cost_count_form)));
    return costs;
  }();
  return form;
}

const Form& times_form() {
  static const Form form{
      "control_times",
      "the times of control()",
      {member("controller", types::string()), member("period", types::real()), member("calls", types::count()),
       member("median", types::real()), member("p999", types::real()), member("longest", types::real()),
       member("longest_tick", types::whole(-1, 1e15)),
       member("histogram", types::array(types::list(types::real(), 2, 2))),
       member("costs", types::nullable(types::of(costs_form)))}};
  return form;
}

const Form& channel_form() {
  static const Form form{
      "compared_channel",
      "a channel that differs",
      {member("channel", types::string()), member("stage", types::string()), member("channels", types::count()),
       member("group", types::string()), member("of_events", types::flag()), member("values", types::count()),
       member("differing", types::count()), member("in_noise", types::count()), member("beyond", types::count()),
       member("blanked", types::count()), member("missing", types::count()), member("extra", types::count()),
       member("first", difference_type()), member("worst", difference_type())}};
  return form;
}

const Form& event_form() {
  static const Form form{"compared_event",
                         "an event that differs",
                         {member("event", types::string()), member("what", types::string()),
                          member("expected", types::nullable(types::count())),
                          member("actual", types::nullable(types::count())), member("beyond", types::flag())}};
  return form;
}

}  // namespace

Form with_version(Form form) {
  form.keys.insert(form.keys.begin(), {"schema", types::whole(1, 1), "the version of this form", required});
  return form;
}

NamedForm object_of(std::string_view name, std::string_view title, std::vector<const Form& (*)()> forms) {
  std::vector<ValueType> all;
  for (const auto form : forms) all.push_back(types::of(form));
  all.push_back(types::of(errors_form));
  return {name, title, types::either(std::move(all))};
}

ValueType difference_type() { return types::nullable(types::of(first_difference_form)); }
ValueType findings_type() { return types::array(types::of(finding_form)); }
ValueType expectations_type() { return types::array(types::of(judged_expectation_form)); }
ValueType control_times_type() { return types::array(types::of(times_form)); }
ValueType interval_type() { return types::list(types::real(), 2, 2); }

ValueType word_of_codes() {
  std::vector<std::string> names;
  for (const VerdictRow& row : verdict_rows()) names.emplace_back(row.name);
  return types::word(std::move(names));
}

std::vector<FormKey> comparison_members() {
  return {member("verdict", types::string()),
          member("equal", types::flag()),
          member("within", types::flag()),
          member("agreement", types::word({"equal", "in noise", "within", "beyond"})),
          member("first", difference_type()),
          member("first_bit", difference_type()),
          member("worst", difference_type()),
          member("explanation", types::string()),
          member("ticks", types::count()),
          member("values", types::count()),
          member("pictures", types::count()),
          member("differing", types::count()),
          member("in_noise", types::count()),
          member("beyond", types::count()),
          member("blanked", types::count()),
          member("channels", types::array(types::of(channel_form))),
          member("equal_channels", types::array(types::string())),
          member("events", types::array(types::of(event_form))),
          member("remarks", types::array(types::string())),
          member("warnings", types::array(types::string()))};
}

const Form& comparison_form() {
  static const Form form{"comparison", "a comparison", comparison_members()};
  return form;
}

const Form& errors_form() {
  static const Form form = with_version({"failure", "a verb that fails", {member("errors", findings_type())}});
  return form;
}

}  // namespace rehearse::tool
