// The objects of sweep and its parts, of fuzz and of fit.
#include <string>
#include <utility>
#include <vector>

#include "json_forms.h"

namespace rehearse::tool {
namespace {

ValueType maybe_real() { return types::nullable(types::real()); }
ValueType maybe_count() { return types::nullable(types::count()); }

std::vector<std::string> case_verdicts() {
  return {"passed", "violated", "differs", "failed", "crashed", "hung", "exploded", "invalid"};
}

const Form& claim_form() {
  static const Form form{
      "claim",
      "a claim",
      {member("at_least", types::real()), member("confidence", types::real()),
       member("answer", types::word({"passes", "fails", "undecided"})), member("more_cases", maybe_count())}};
  return form;
}

const Form& non_inferiority_form() {
  static const Form form{
      "non_inferiority",
      "a claim against another campaign",
      {member("margin", types::real()), member("confidence", types::real()), member("difference", maybe_real()),
       member("interval", types::any()), member("answer", types::word({"passes", "fails", "undecided"})),
       member("more_cases", maybe_count())}};
  return form;
}

const Form& survival_form() {
  static const Form form{
      "survival",
      "an expectation under a fault",
      {member("expectation", types::string()), member("survives", types::flag()), member("holds", types::count()),
       member("violated", types::count()), member("unjudged", types::count()), member("least_margin", maybe_real()),
       member("violated_with", types::array(types::string())), member("text", types::string())}};
  return form;
}

const Form& varied_fault_form() {
  static const Form form{"varied_fault",
                         "a fault that the scenario varies",
                         {member("fault", types::string()), member("cases", types::count()),
                          member("expectations", types::array(types::of(survival_form)))}};
  return form;
}

const Form& kept_failure_form() {
  static const Form form{
      "kept_failure",
      "a failure that the project keeps",
      {member("file", types::string()), member("verdict", types::string()), member("sentence", types::string())}};
  return form;
}

const Form& queue_form() {
  static const Form form{
      "queue", "tasks in Slurm", {member("running", types::count()), member("waiting", types::count())}};
  return form;
}

const Form& sweep_form() {
  static const Form form = with_version(
      {"sweep",
       "sweep --json",
       {member("verdict", types::string()), member("claim", types::nullable(types::of(claim_form))),
        member("non_inferiority", types::nullable(types::of(non_inferiority_form))),
        member("reached", types::map(types::count())), member("cases", types::count()),
        member("verdicts", types::map(types::count(), case_verdicts())), member("missing", types::count()),
        member("share", maybe_real()), member("interval", types::any()), member("until_failures", maybe_count()),
        member("with_errors", types::count()), member("passed_with_errors", types::count()),
        member("faults", types::array(types::of(varied_fault_form))), member("repeated", types::count()),
        member("unrepeated", types::array(types::count())),
        member_if("report", "the page; not of status", types::string()),
        member_if("kept_failures", "of sweep and sweep resume", types::array(types::of(kept_failure_form))),
        member_if("slurm", "of status of a campaign in Slurm", types::of(queue_form))}});
  return form;
}

std::vector<std::string> finding_kinds() {
  return {
      "not finite",           "beyond a limit", "violated",          "threw", "crashed", "hung", "ended the process",
      "took too much memory", "not repeated",   "not real-time safe"};
}

const Form& fuzz_finding_form() {
  static const Form form{
      "fuzz_finding",
      "inputs that break a controller",
      {member("kind", types::word(finding_kinds())), member("sentence", types::string()), member("run", types::count()),
       member("tick", types::count()), member("ticks", types::count()), member("ticks_before", types::count()),
       member("inputs", types::count()), member("inputs_before", types::count()), member("changes", types::count()),
       member("changes_before", types::count()), member("repeats", types::flag()), member("file", types::string()),
       member("recording", types::string())}};
  return form;
}

const Form& kept_finding_form() {
  static const Form form{"kept_finding",
                         "a finding that the project keeps",
                         {member("file", types::string()), member("sentence", types::string())}};
  return form;
}

const Form& fuzz_form() {
  static const Form form =
      with_version({"fuzz",
                    "fuzz --json",
                    {member("runs", types::count()), member("resumed_from", types::count()),
                     member("seed", types::count()), member("kept", types::count()), member("points", types::count()),
                     member("seconds", types::real()), member("findings", types::array(types::of(fuzz_finding_form))),
                     member("kept_findings", types::array(types::of(kept_finding_form)))}});
  return form;
}

const Form& fitted_number_form() {
  static const Form form{
      "fitted_number",
      "a number that was fitted",
      {member("path", types::string()), member("unit", types::string()), member("identified", types::flag()),
       member("value", maybe_real()), member("interval", types::nullable(interval_type())),
       member("was", types::real()), member("bounds", interval_type()), member("reason", types::string()),
       member("advice", types::string())}};
  return form;
}

const Form& fit_correlation_form() {
  static const Form form{
      "fit_correlation",
      "two numbers whose errors go together",
      {member("a", types::string()), member("b", types::string()), member("correlation", types::real())}};
  return form;
}

const Form& fit_series_form() {
  static const Form form{
      "fit_series",
      "the differences of a series from the recording",
      {member("recording", types::string()), member("series", types::string()), member("noise", types::real()),
       member("before", types::real()), member("after", types::real())}};
  return form;
}

const Form& fit_judgement_form() {
  static const Form form{
      "fit_judgement",
      "the differences from another recording",
      {member("recording", types::string()), member("before", types::real()), member("after", types::real())}};
  return form;
}

std::vector<FormKey> fit_members() {
  return {member("numbers", types::array(types::of(fitted_number_form))),
          member("correlations", types::array(types::of(fit_correlation_form))),
          member("before", types::real()),
          member("after", types::real()),
          member("series", types::array(types::of(fit_series_form))),
          member("stretches", types::count()),
          member("evaluations", types::count()),
          member("states", types::word({"complete", "estimated"}))};
}

const Form& fit_part_form() {
  static const Form form{"fit_part", "the fit to one of two recordings", fit_members()};
  return form;
}

const Form& fit_form() {
  static const Form form = [] {
    Form one{"fit", "fit --json", fit_members()};
    one.keys.push_back(member("judgement", types::nullable(types::of(fit_judgement_form))));
    one.keys.push_back(member("file", types::nullable(types::string())));
    return with_version(std::move(one));
  }();
  return form;
}

const Form& worn_number_form() {
  static const Form form{
      "worn_number",
      "a number that was fitted to two recordings",
      {member("earlier", types::of(fitted_number_form)), member("later", types::of(fitted_number_form)),
       member("probability", maybe_real()), member("moved", types::flag())}};
  return form;
}

const Form& fit_wear_form() {
  static const Form form =
      with_version({"fit_wear",
                    "fit --wear --json",
                    {member("wear", types::array(types::of(worn_number_form))),
                     member("earlier", types::of(fit_part_form)), member("later", types::of(fit_part_form))}});
  return form;
}

const Form& case_margin_form() {
  static const Form form{"case_margin",
                         "the margin of an expectation",
                         {member("expectation", types::string()), member("margin", maybe_real())}};
  return form;
}

std::vector<FormKey> case_members() {
  return {member("verdict", types::word(case_verdicts())),
          member("sentence", types::string()),
          member("tick", types::nullable(types::whole(-1, 1e15))),
          member("ticks", types::count()),
          member("hash", types::string()),
          member("margins", types::array(types::of(case_margin_form))),
          member("case", types::count())};
}

const Form& sweep_case_form() {
  static const Form form = [] {
    Form one{"sweep_case", "sweep case --json", case_members()};
    for (FormKey key : {member("values", types::map(types::either({types::string(), types::real()}))),
                        member("trace", types::string()), member("same", types::nullable(types::flag())),
                        member("changed_controllers", types::any())})
      one.keys.push_back(std::move(key));
    return with_version(std::move(one));
  }();
  return form;
}

const Form& sweep_shrink_form() {
  static const Form form = [] {
    Form one{"sweep_shrink", "sweep shrink --json", case_members()};
    for (FormKey key :
         {member("differs", types::map(types::either({types::string(), types::real()}))),
          member("duration", types::real()), member("runs", types::count()), member("finished", types::flag()),
          member("scenario", types::string()), member("changed_controllers", types::any())})
      one.keys.push_back(std::move(key));
    return with_version(std::move(one));
  }();
  return form;
}

const Form& round_form() {
  static const Form form{"round",
                         "a round of a search",
                         {member("folder", types::string()), member("cases", types::count()),
                          member("failed", types::count()), member("violations", types::count()),
                          member("least_margin", maybe_real()), member("first_failure", maybe_count())}};
  return form;
}

const Form& probability_form() {
  static const Form form{
      "probability",
      "the probability of a failure",
      {member("estimate", types::real()), member("interval", interval_type()), member("cases", types::count()),
       member("violations", types::count()), member("enough", types::flag()), member("folder", types::string())}};
  return form;
}

const Form& sweep_towards_form() {
  static const Form form = with_version({"sweep_towards",
                                         "sweep --towards --json",
                                         {member("rounds", types::array(types::of(round_form))),
                                          member("probability", types::nullable(types::of(probability_form)))}});
  return form;
}

}  // namespace

std::vector<NamedForm> campaign_objects() {
  return {object_of("sweep", "sweep --json, also of resume, status and report", {sweep_form}),
          object_of("sweep-towards", "sweep --towards --json", {sweep_towards_form}),
          object_of("sweep-case", "sweep case --json", {sweep_case_form}),
          object_of("sweep-shrink", "sweep shrink --json", {sweep_shrink_form}),
          object_of("fuzz", "fuzz --json", {fuzz_form}),
          object_of("fit", "fit --json", {fit_form}),
          object_of("fit-wear", "fit --wear --json", {fit_wear_form})};
}

}  // namespace rehearse::tool
