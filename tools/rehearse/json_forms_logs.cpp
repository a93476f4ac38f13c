// The objects of replay at a tick and of replay of a log.
#include <string>
#include <vector>

#include "json_forms.h"

namespace rehearse::tool {
namespace {

ValueType tick_number() { return types::whole(-1, 1e15); }

const Form& tick_value_form() {
  static const Form form{
      "tick_value",
      "a value at a tick",
      {member("series", types::string()), member("element", types::string()), member("unit", types::string()),
       member("value", types::real()), member("changed", types::flag()),
       member("delta", types::nullable(types::real())), member("replayed", types::nullable(types::real())),
       member_if("ulps", "if replayed isn't null", types::count())}};
  return form;
}

const Form& tick_channel_form() {
  static const Form form{"tick_channel",
                         "a channel at a tick",
                         {member("topic", types::string()), member("owner", types::string()),
                          member("kind", types::word({"input", "output", "state", "sensor", "other"})),
                          member("values", types::array(types::of(tick_value_form)))}};
  return form;
}

const Form& tick_message_form() {
  static const Form form{
      "tick_message",
      "a message at a tick",
      {member("source", types::string()), member("severity", types::string()), member("text", types::string()),
       member("in", types::word({"both", "recorded", "replayed"}))}};
  return form;
}

const Form& tick_contact_form() {
  static const Form form{"tick_contact",
                         "a contact at a tick",
                         {member("link", types::string()), member("other", types::string()),
                          member("touches", types::flag()), member("changed", types::flag())}};
  return form;
}

const Form& tick_picture_form() {
  static const Form form{
      "tick_picture", "a picture at a tick", {member("topic", types::string()), member("bytes", types::count())}};
  return form;
}

const Form& replay_tick_form() {
  static const Form form =
      with_version({"replay_tick",
                    "replay --tick --json",
                    {member("tick", tick_number()), member("time", types::real()), member("replayed", types::flag()),
                     member("channels", types::array(types::of(tick_channel_form))),
                     member("messages", types::array(types::of(tick_message_form))),
                     member("contacts", types::array(types::of(tick_contact_form))),
                     member("pictures", types::array(types::of(tick_picture_form))),
                     member("threads", types::array(types::string())),
                     member("differences", types::array(difference_type())), member("remarks", findings_type())}});
  return form;
}

const Form& message_form() {
  static const Form form{
      "message",
      "a line of cat --json",
      {member("topic", types::string()), member("log_time", types::count()), member("publish_time", types::count()),
       member("sequence", types::count()), member_if("message", "if it can be decoded", types::any()),
       member_if("data", "if it can't: its bytes in base64", types::string())},
      {},
      {{"message", "data"}}};
  return form;
}

const Form& watched_form() {
  static const Form form{
      "watched",
      "a line of replay --watch --json",
      {member("tick", tick_number()), member("time", types::real()), member("values", types::map(types::real())),
       member_if("replayed", "of commands, if the controllers differ anywhere", types::map(types::real()))}};
  return form;
}

const Form& span_form() {
  static const Form form{
      "span",
      "a line of replay --when --json",
      {member("tick", tick_number()), member("time", types::real()), member("ticks", types::count()),
       member("last_tick", tick_number()),
       member("operands", types::map(types::either({types::string(), types::real(), types::flag()})))}};
  return form;
}

const Form& age_form() {
  static const Form form{
      "age", "a time and its place", {member("seconds", types::real()), member("at", types::real())}};
  return form;
}

const Form& unreadable_form() {
  static const Form form{
      "unreadable",
      "messages that can't be read",
      {member("reason", types::string()), member("messages", types::count()), member("first_at", types::real())}};
  return form;
}

const Form& silent_joint_form() {
  static const Form form{"silent_joint",
                         "a joint with gaps",
                         {member("joint", types::string()), member("gaps", types::count()),
                          member("ticks_in_gaps", types::count()), member("worst_age", types::of(age_form))}};
  return form;
}

const Form& clock_form() {
  static const Form form{
      "clock",
      "the clock of a topic",
      {member("offset_ns", types::real()), member("drift", types::real()), member("reference_ns", types::real()),
       member("least_delay", types::real()), member("stated", types::flag()), member("steps", types::any())}};
  return form;
}

const Form& topic_form() {
  static const Form form = [] {
    Form topic{"topic",
               "a topic of a log",
               {member("topic", types::string()), member("type", types::string()), member("use", types::string())}};
    for (const std::string_view count :
         {"messages", "used", "skipped", "out_of_order", "same_stamp", "backwards", "twins", "unreadable"})
      topic.keys.push_back(member(count, types::count()));
    topic.keys.push_back(member("unreadable_for", types::array(types::of(unreadable_form))));
    topic.keys.push_back(member("silent_joints", types::array(types::of(silent_joint_form))));
    topic.keys.push_back(member("clock", types::nullable(types::of(clock_form))));
    topic.keys.push_back(member("rate", types::real()));
    topic.keys.push_back(member("longest_gap", types::of(age_form)));
    topic.keys.push_back(member("worst_age", types::of(age_form)));
    for (const std::string_view count : {"gaps", "ticks_in_gaps", "ticks_without"})
      topic.keys.push_back(member(count, types::count()));
    return topic;
  }();
  return form;
}

const Form& ticks_of_log_form() {
  static const Form form{
      "ticks_of_log",
      "the ticks of a log",
      {member("topic", types::string()), member("grid", types::flag()), member("interval", types::real()),
       member("rate", types::real()), member("drift", types::real()), member("jitter", types::real()),
       member("phase", types::real()), member("measured_by", types::string()), member("missing", types::count()),
       member("latency", types::nullable(types::real()))}};
  return form;
}

const Form& timing_form() {
  static const Form form{"timing",
                         "the timing of commands",
                         {member("shift", types::nullable(types::whole(-1e6, 1e6))), member("ticks", types::count()),
                          member("different", types::count())}};
  return form;
}

const Form& cause_form() {
  static const Form form{"cause",
                         "the lines of a map that explain differences",
                         {member("lines", types::any()), member("meaning", types::string()),
                          member("ticks", types::count()), member("different", types::count())}};
  return form;
}

const Form& rest_form() {
  static const Form form{
      "rest",
      "the ticks that aren't certain",
      {member("series", types::string()), member("from", types::real()), member("ticks", types::count()),
       member("low", types::real()), member("high", types::real()), member("range", types::real())}};
  return form;
}

const Form& certain_form() {
  static const Form form{"certain",
                         "the certain ticks",
                         {member("memory", types::nullable(types::count())), member("ticks", types::count()),
                          member("different", types::count()), member("beyond", difference_type()),
                          member("is_no_state", types::flag()), member("rest", types::nullable(types::of(rest_form)))}};
  return form;
}

const Form& unknown_ticks_form() {
  static const Form form{"unknown_ticks",
                         "ticks that aren't compared",
                         {member("without_message", types::count()), member("without_command", types::count()),
                          member("in_doubt", types::count())}};
  return form;
}

const Form& replayed_log_form();

std::vector<FormKey> replayed_log_members() {
  return {member("verdict", types::string()),
          member("equal", types::flag()),
          member("within", types::flag()),
          member("first", difference_type()),
          member("worst", difference_type()),
          member("beyond", difference_type()),
          member("trace", types::string()),
          member("log_hash", types::string()),
          member("start", types::real()),
          member("begins", types::real()),
          member("ticks", types::count()),
          member("duration", types::real()),
          member("ticks_compared", types::count()),
          member("ticks_different", types::count()),
          member("ticks_unknown", types::of(unknown_ticks_form)),
          member("ticks_without_inputs", types::count()),
          member("tick", types::nullable(types::of(ticks_of_log_form))),
          member("timing", types::nullable(types::of(timing_form))),
          member("cause", types::nullable(types::of(cause_form))),
          member("undecided", types::flag()),
          member("certain", types::nullable(types::of(certain_form))),
          member("values", types::count()),
          member("values_different", types::count()),
          member("topics", types::array(types::of(topic_form))),
          member("failure", types::nullable(types::string())),
          member("controller_refused", types::flag()),
          member("after_restarts", types::array(types::of(replayed_log_form))),
          member("control_times", control_times_type()),
          member("remarks", findings_type())};
}

const Form& replayed_log_form() {
  static const Form form{"replayed_log", "a replayed part of a log", replayed_log_members()};
  return form;
}

const Form& replay_log_form() {
  static const Form form = with_version({"replay_log", "replay --map --json", replayed_log_members()});
  return form;
}

}  // namespace

std::vector<NamedForm> log_objects() {
  return {{"cat", "a line of cat --json", types::of(message_form)},
          object_of("replay-tick", "replay --tick --json", {replay_tick_form}),
          {"replay-watch", "a line of replay --watch --json", types::of(watched_form)},
          {"replay-when", "a line of replay --when --json", types::of(span_form)},
          object_of("replay-log", "replay --map --json", {replay_log_form})};
}

}  // namespace rehearse::tool
