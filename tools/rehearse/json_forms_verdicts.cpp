// The objects of record, check, replay, diff, audit and history.
#include <string>
#include <vector>

#include "json_forms.h"

namespace rehearse::tool {
namespace {

ValueType level() { return types::word({"equal", "proved", "within", "differs", "not compared", "no golden"}); }

const Form& levels_form() {
  static const Form form{
      "levels", "the levels", {member("controller", level()), member("plant", level()), member("closed", level())}};
  return form;
}

std::vector<FormKey> differences_of_commands() {
  return {member("first", difference_type()),        member("beyond", difference_type()),
          member("worst", difference_type()),        member("ticks", types::count()),
          member("ticks_different", types::count()), member("values", types::count()),
          member("values_different", types::count())};
}

const Form& controller_comparison_form() {
  static const Form form{"controller_comparison", "the commands on the golden's inputs", differences_of_commands()};
  return form;
}

const Form& comparisons_form() {
  static const Form form{"comparisons",
                         "the comparisons",
                         {member("controller", types::nullable(types::of(controller_comparison_form))),
                          member("plant", types::nullable(types::of(comparison_form))),
                          member("closed", types::nullable(types::of(comparison_form)))}};
  return form;
}

const Form& explanation_form() {
  static const Form form{"explanation",
                         "of --explain: where to look, the likeliest cause first, and the next commands",
                         {member("places", findings_type()), member("next", types::array(types::string()))}};
  return form;
}

const Form& checked_form() {
  static const Form form{"checked",
                         "a checked scenario",
                         {member("verdict", types::string()),
                          member("code", types::nullable(word_of_codes())),
                          member("codes", types::array(word_of_codes())),
                          member("equal", types::flag()),
                          member("within", types::flag()),
                          member("not_reproduced", types::flag()),
                          member("proved", types::flag()),
                          member("simulated_from", types::nullable(types::count())),
                          member("not_proved", types::nullable(types::string())),
                          member("levels", types::of(levels_form)),
                          member("first", difference_type()),
                          member("comparisons", types::of(comparisons_form)),
                          member("horizon", types::nullable(types::real())),
                          member("expectations", expectations_type()),
                          member("remarks", types::array(types::string())),
                          member("scenario", types::string()),
                          member("file", types::string()),
                          member("message", types::string()),
                          member("report", types::nullable(types::string())),
                          member("control_times", control_times_type()),
                          member("explanation", types::nullable(types::of(explanation_form)))}};
  return form;
}

const Form& unjudged_form() {
  static const Form form{
      "unjudged",
      "a scenario that isn't judged",
      {member("scenario", types::string()), member("file", types::string()), member("verdict", types::string()),
       member("code", word_of_codes()), member("equal", types::flag()), member("within", types::flag()),
       member("codes", types::array(word_of_codes())),
       member_if("first", "of the first scenario that fails", difference_type())}};
  return form;
}

const Form& check_form() {
  static const Form form = [] {
    Form check = with_version(checked_form());
    check.name = "check";
    return check;
  }();
  return form;
}

const Form& check_alone_form() {
  static const Form form = [] {
    Form alone = with_version(unjudged_form());
    alone.name = "check_alone";
    return alone;
  }();
  return form;
}

const Form& checks_form() {
  static const Form form = with_version(
      {"checks",
       "the check of several scenarios",
       {member("verdict", types::string()), member("code", types::nullable(word_of_codes())),
        member("equal", types::flag()), member("within", types::flag()), member("proved", types::flag()),
        member("levels", types::map(types::string(), {"controller", "plant", "closed"})),
        member("first", difference_type()),
        member("scenarios", types::array(types::either({types::of(checked_form), types::of(unjudged_form)})))}});
  return form;
}

const Form& record_object_form() {
  static const Form form = with_version(
      {"record",
       "record --json",
       {member("scenario", types::string()), member("trace", types::string()), member("ticks", types::count()),
        member("duration", types::real()), member("channels", types::count()), member("pictures", types::count()),
        member("bytes", types::count()), member("expectations", expectations_type()),
        member("repeats_itself", types::nullable(types::flag())), member("failure", types::any()),
        member("controller_refused", types::flag()), member("control_times", control_times_type()),
        member("remarks", findings_type())}});
  return form;
}

const Form& branch_form() {
  static const Form form = with_version(
      {"record_branch",
       "record --from-checkpoint --json",
       {member("from", types::string()), member("tick", types::count()), member("time", types::real()),
        member("world", types::string()), member("first_before", difference_type()), member("trace", types::string()),
        member("ticks", types::count()), member("channels", types::count()), member("pictures", types::count()),
        member("bytes", types::count()), member("failure", types::any()), member("controller_refused", types::flag()),
        member("control_times", control_times_type()), member("remarks", findings_type())}});
  return form;
}

const Form& words_form() {
  static const Form form{"words",
                         "the controllers' output other than commands",
                         {member("lines", types::count()), member("variables", types::count()),
                          member("different", types::count()), member("first", difference_type())}};
  return form;
}

const Form& replayed_form() {
  static const Form form{
      "replay",
      "replay --json",
      {member("verdict", types::string()), member("equal", types::flag()), member("within", types::flag()),
       member("explanation", types::string()), member("first", difference_type()), member("beyond", difference_type()),
       member("worst", difference_type()), member("ticks", types::count()), member("ticks_different", types::count()),
       member("values", types::count()), member("values_different", types::count()),
       member("words", types::of(words_form)), member("failure", types::nullable(types::string())),
       member("changed_files", types::array(types::string())), member("controller_refused", types::flag()),
       member("control_times", control_times_type()), member("remarks", findings_type())}};
  return form;
}

const Form& replay_form() {
  static const Form form = with_version(replayed_form());
  return form;
}

const Form& flown_joint_form() {
  static const Form form{"flown_joint",
                         "the largest mean acceleration of a joint that the world lacks",
                         {member("name", types::string()), member("unit", types::string()),
                          member("missing", types::real()), member("noise", types::real()),
                          member("tick", types::count()), member("from", types::nullable(types::count()))}};
  return form;
}

const Form& flown_world_form() {
  static const Form form{"flown_world",
                         "a scenario's world beside a flight",
                         {member("verdict", types::word({"agrees", "differs", "undecided"})),
                          member("undecided", types::nullable(types::string())), member("steps", types::count()),
                          member("span", types::real()), member("joints", types::array(types::of(flown_joint_form)))}};
  return form;
}

const Form& check_flight_form() {
  static const Form form = with_version(
      {"check_flight",
       "check --flight --json",
       {member("scenario", types::string()), member("flight", types::string()), member("mathematics", types::string()),
        member("controller", types::of(replayed_form)), member("plant", types::of(flown_world_form))}});
  return form;
}

const Form& alignment_form() {
  static const Form form{
      "alignment",
      "the alignment of two logs",
      {member("by", types::string()), member("offset", types::real()), member("drift", types::nullable(types::real())),
       member("correlation", types::nullable(types::real())), member("matched", types::count()),
       member("lone", types::list(types::count(), 2, 2)), member("left_out", types::count()),
       member("median_distance", types::real()), member("largest_distance", types::real())}};
  return form;
}

const Form& diff_form() {
  static const Form form = [] {
    Form diff{"diff", "diff --json", comparison_members()};
    diff.keys.push_back(member_if("alignment", "with --align", types::of(alignment_form)));
    return with_version(std::move(diff));
  }();
  return form;
}

const Form& factor_form() {
  static const Form form{
      "factor",
      "a factor that replays vary",
      {member("factor", types::string()), member("state", types::word({"same", "differs", "not varied"})),
       member("replays", types::count()), member("why_not", types::nullable(types::string())),
       member("first", difference_type())}};
  return form;
}

const Form& call_form() {
  static const Form form{
      "call",
      "a call of a controller",
      {member("source", types::string()), member("function", types::string()), member("phase", types::string()),
       member("place", types::string()), member("first_tick", types::whole(-1, 1e15)),
       member("last_tick", types::whole(-1, 1e15)), member("count", types::count()),
       member("reached", types::word({"yes", "no", "unknown"})), member("note", types::string())}};
  return form;
}

const Form& code_form() {
  static const Form form{
      "code",
      "a finding in a library",
      {member("kind", types::string()), member("count", types::count()), member("function", types::string()),
       member("place", types::string()), member("sentence", types::string())}};
  return form;
}

const Form& library_form() {
  static const Form form{"library",
                         "a library",
                         {member("file", types::string()), member("findings", types::array(types::of(code_form)))}};
  return form;
}

const Form& cost_form() {
  static const Form form{
      "cost",
      "a cost of control()",
      {member("cost", types::string()), member("function", types::string()), member("phase", types::string()),
       member("place", types::string()), member("callers", types::array(types::string())),
       member("first_tick", types::whole(-1, 1e15)), member("last_tick", types::whole(-1, 1e15)),
       member("count", types::count()), member("breaks_realtime", types::flag())}};
  return form;
}

const Form& counted_call_form() {
  static const Form form{"counted_call",
                         "a call of control()",
                         {member("tick", types::whole(0, 1e15)), member("instructions", types::count())}};
  return form;
}

const Form& counted_line_form() {
  static const Form form{
      "counted_line",
      "a line of a library",
      {member("function", types::string()), member("line", types::string()), member("instructions", types::count())}};
  return form;
}

const Form& instructions_form() {
  static const Form form{"instructions",
                         "the instructions of control()",
                         {member("median", types::count()), member("most", types::of(counted_call_form)),
                          member("lines", types::array(types::of(counted_line_form))),
                          member("calls", types::array(types::of(counted_call_form)))}};
  return form;
}

const Form& audited_controller_form() {
  static const Form form{
      "audited_controller",
      "an audited controller",
      {member("controller", types::string()), member("deterministic", types::flag()),
       member("reason", types::nullable(types::string())), member("depends_on", types::nullable(types::string())),
       member("first", difference_type()), member("factors", types::array(types::of(factor_form))),
       member("calls", types::array(types::of(call_form))), member("rests_on", types::array(types::string())),
       member("costs", types::array(types::of(cost_form))), member("page_faults", types::of(cost_count_form)),
       member("instructions", types::nullable(types::of(instructions_form))),
       member("library", types::of(library_form))}};
  return form;
}

const Form& order_exchange_form() {
  static const Form form{
      "order_exchange", "an exchange of threads", {member("runs", types::string()), member("before", types::string())}};
  return form;
}

const Form& tried_orders_form() {
  static const Form form{
      "tried_orders",
      "other orders of threads",
      {member("tried", types::count()), member("places", types::count()), member("threads", types::count()),
       member("first", difference_type()), member("exchanges", types::array(types::of(order_exchange_form))),
       member("file", types::nullable(types::string()))}};
  return form;
}

const Form& audit_remark_form() {
  static const Form form{
      "audit_remark", "a remark", {member("severity", types::string()), member("message", types::string())}};
  return form;
}

const Form& audit_form() {
  static const Form form =
      with_version({"audit",
                    "audit --json",
                    {member("verdict", types::string()), member("deterministic", types::flag()),
                     member("realtime_safe", types::nullable(types::flag())), member("first", difference_type()),
                     member("depends_on", types::nullable(types::string())),
                     member("rests_on", types::nullable(types::array(types::string()))),
                     member("factors", types::nullable(types::array(types::of(factor_form)))),
                     member("calls", types::nullable(types::array(types::of(call_form)))),
                     member("library", types::nullable(types::of(library_form))),
                     member("controllers", types::array(types::of(audited_controller_form))),
                     member("failure", types::nullable(types::string())), member("controller_refused", types::flag()),
                     member("memory_errors", types::array(types::string())), member("ticks", types::count()),
                     member("commands", types::count()), member("replays", types::count()),
                     member("orders", types::nullable(types::of(tried_orders_form))),
                     member("remarks", types::array(types::of(audit_remark_form)))}});
  return form;
}

const Form& execution_form() {
  static const Form form{"execution",
                         "a first execution",
                         {member("recording", types::string()), member("tick", types::whole(-1, 1e15)),
                          member("time", types::nullable(types::real()))}};
  return form;
}

const Form& way_form() {
  static const Form form{"way",
                         "a way of a branch",
                         {member("first", types::nullable(types::of(execution_form))), member("known", types::flag())}};
  return form;
}

const Form& covered_line_form() {
  static const Form form{
      "covered_line",
      "a line of a controller's source",
      {member("line", types::count()), member("function", types::string()), member("recordings", types::count()),
       member("first", types::nullable(types::of(execution_form))), member("ways", types::array(types::of(way_form)))}};
  return form;
}

const Form& covered_file_form() {
  static const Form form{"covered_file",
                         "a source file",
                         {member("file", types::string()), member("lines", types::array(types::of(covered_line_form))),
                          member("unknown", types::array(types::count()))}};
  return form;
}

const Form& coverage_form() {
  static const Form form = with_version(
      {"coverage",
       "audit --coverage --json",
       {member("verdict", types::string()), member("lines", types::count()), member("lines_executed", types::count()),
        member("lines_unknown", types::count()), member("ways", types::count()),
        member("ways_executed", types::count()), member("recordings", types::array(types::string())),
        member("files", types::array(types::of(covered_file_form))),
        member("failure", types::nullable(types::string())),
        member("remarks", types::array(types::of(audit_remark_form)))}});
  return form;
}

const Form& compared_call_form() {
  static const Form form{
      "compared_call",
      "a call of control() beside the kept one of its tick",
      {member("tick", types::count()), member("instructions", types::count()), member("expected", types::count())}};
  return form;
}

const Form& compared_instructions_form() {
  static const Form form = [] {
    const auto call = types::nullable(types::of(compared_call_form));
    return Form{"compared_instructions",
                "the instructions of a controller beside the kept ones",
                {member("controller", types::string()), member("not_compared", types::nullable(types::string())),
                 member("ticks", types::count()), member("grown", types::count()), member("share", types::real()),
                 member("first", call), member("worst", call)}};
  }();
  return form;
}

const Form& checked_instructions_form() {
  static const Form form{
      "checked_instructions",
      "the instructions in the replay of a golden",
      {member("recording", types::string()), member("verdict", types::string()), member("within", types::flag()),
       member("kept", types::nullable(types::string())),
       member("controllers", types::array(types::of(compared_instructions_form))), member("remarks", findings_type())}};
  return form;
}

const Form& instruction_check_form() {
  static const Form form = with_version({"instructions",
                                         "check --instructions --json",
                                         {member("verdict", types::string()), member("within", types::flag()),
                                          member("recordings", types::array(types::of(checked_instructions_form)))}});
  return form;
}

const Form& two_values_form() {
  static const Form form{
      "two_values",
      "a number that differs between two libraries of a controller",
      {member("name", types::string()), member("old", types::string()), member("new", types::string())}};
  return form;
}

const Form& source_place_form() {
  static const Form form{
      "source_place",
      "a line of a controller's source, with the lines around",
      {member("function", types::string()), member("file", types::string()), member("line", types::count()),
       member("begin", types::count()), member("source", types::array(types::string()))}};
  return form;
}

const Form& beside_form() {
  static const Form form = [] {
    const auto place = [](const char* name) { return member(name, types::nullable(types::of(source_place_form))); };
    const auto values = types::array(types::of(two_values_form));
    return with_version(
        {"beside",
         "replay --beside --json",
         {member("verdict", types::string()), member("equal", types::flag()), member("controller", types::string()),
          member("before", values), member("tick", types::nullable(types::count())),
          member("values", types::nullable(values)), place("new"), place("old"), place("new_next"), place("old_next"),
          member("numbers", types::count()), member("ticks", types::count()),
          member("lines", types::nullable(types::count())), member("only_new", types::array(types::string())),
          member("only_old", types::array(types::string())), member("remarks", findings_type())}});
  }();
  return form;
}

std::vector<FormKey> stamp_members() {
  return {member("commit", types::string()), member("changed", types::flag()), member("date", types::string())};
}

const Form& point_form() {
  static const Form form = [] {
    Form point{"point", "a margin at a commit", stamp_members()};
    for (FormKey key : {member("margin", types::real()), member("share", types::nullable(types::real())),
                        member("tick", types::whole(-1, 1e15))})
      point.keys.push_back(std::move(key));
    return point;
  }();
  return form;
}

const Form& trend_form() {
  static const Form form{
      "trend",
      "the trend of a margin",
      {member("scenario", types::string()), member("expectation", types::string()), member("unit", types::string()),
       member("steps", types::count()), member("shrank", types::count()),
       member("change", types::nullable(types::real())), member("p", types::real()), member("drifts", types::flag()),
       member("jump", types::nullable(types::of(point_form))), member("points", types::array(types::of(point_form)))}};
  return form;
}

const Form& history_scenario_form() {
  static const Form form{
      "history_scenario",
      "a scenario",
      {member("scenario", types::string()), member("checks", types::count()), member("code", types::string())}};
  return form;
}

const Form& flaky_form() {
  static const Form form{"flaky",
                         "a scenario with two verdicts of a commit",
                         {member("scenario", types::string()), member("commit", types::string()),
                          member("codes", types::array(types::string()))}};
  return form;
}

const Form& history_form() {
  static const Form form = with_version(
      {"history",
       "history --json",
       {member("verdict", types::string()), member("drifts", types::flag()), member("significance", types::real()),
        member("scenarios", types::array(types::of(history_scenario_form))),
        member("margins", types::array(types::of(trend_form))), member("flaky", types::array(types::of(flaky_form))),
        member("errors", findings_type())}});
  return form;
}

const Form& history_margin_form() {
  static const Form form{
      "history_margin",
      "a margin",
      {member("text", types::string()), member("margin", types::nullable(types::real())),
       member("value", types::real()), member("bound", types::real()), member("unit", types::string()),
       member("share", types::nullable(types::real())), member("tick", types::whole(-1, 1e15))}};
  return form;
}

const Form& history_line_form() {
  static const Form form = [] {
    Form line{"history_line",
              "a line of a history",
              {{"history", types::whole(1, 1), "the version of the line's form", required}}};
    for (FormKey& key : stamp_members()) line.keys.push_back(std::move(key));
    for (FormKey key :
         {member("scenario", types::string()), member("code", types::string()), member("proved", types::flag()),
          member("first", difference_type()), member("margins", types::array(types::of(history_margin_form))),
          member_if("costs", "if they were counted", types::map(types::map(types::count())))})
      line.keys.push_back(std::move(key));
    return line;
  }();
  return form;
}

}  // namespace

std::vector<NamedForm> verdict_objects() {
  return {object_of("record", "record --json", {record_object_form}),
          object_of("record-branch", "record --from-checkpoint --json", {branch_form}),
          object_of("check", "check --json", {check_form, check_alone_form, checks_form}),
          object_of("check-flight", "check --flight --json", {check_flight_form}),
          object_of("replay", "replay --json", {replay_form}),
          object_of("diff", "diff --json", {diff_form}),
          object_of("audit", "audit --json", {audit_form}),
          object_of("coverage", "audit --coverage --json", {coverage_form}),
          object_of("instructions", "check --instructions --json", {instruction_check_form}),
          object_of("beside", "replay --beside --json", {beside_form}),
          object_of("history", "history --json", {history_form}),
          {"history-line", "a line of a history", types::of(history_line_form)}};
}

}  // namespace rehearse::tool
