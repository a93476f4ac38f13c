// Comparison of the provenance of two recordings. It finds the parts of the loop that may differ because of a change,
// and recordings that can't be compared.
#include <fmt/format.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "base/glob.h"
#include "base/names.h"
#include "compare_provenance.h"
#include "core/kinds/channel_name.h"
#include "core/ros2msg/ros2msg.h"
#include "core/trace/event_stream.h"
#include "core/trace/run_facts.h"
#include "divergence_text.h"
#include "series_rules.h"

namespace rehearse {
namespace {

/// A fact of a recording's provenance, and the parts of the loop whose values it influences. Only this list states
/// them.
struct Fact {
  std::string_view key;  // in the metadata record `rehearse`; with a dot at its end: all keys with this beginning
  std::string_view name;
  std::vector<Stage> decides;
  bool arithmetic = false;  // it influences the rounding of numbers
};

const std::vector<Stage> every_stage{Stage::physics, Stage::sensors, Stage::renderer, Stage::inputs, Stage::controller};

const std::vector<Fact>& known_facts() {
  static const std::vector<Fact> known{
      {facts::rehearse, "rehearse", every_stage, true},
      {facts::physics, "the physics engine", {Stage::physics, Stage::sensors, Stage::inputs}, true},
      {facts::renderer, "the renderer", {Stage::renderer}, true},
      {facts::libc, "the C library", {Stage::physics, Stage::sensors, Stage::inputs, Stage::controller}, true},
      {facts::compiler, "the compiler", every_stage, true},
      {facts::processor, "the processor", every_stage},
      {facts::build, "the build", every_stage, true},
      {facts::pinned, "pinned", every_stage, true},
      {facts::pinned_mathematics,
       "the pinned mathematics",
       {Stage::physics, Stage::sensors, Stage::inputs, Stage::controller},
       true},
      {facts::pinned_renderer, "the pinned renderer", {Stage::renderer}, true},
      {facts::solver, "the solver", {Stage::physics, Stage::sensors, Stage::inputs}},
      {facts::seed, "the seed", {Stage::physics, Stage::sensors, Stage::inputs}},
      {facts::time_step, "the time step", every_stage},
      {facts::controller_prefix, "controller ", {Stage::controller, Stage::inputs}},
  };
  return known;
}

/// True for facts without a remark: they are compared themselves, or describe the file.
bool is_of_no_interest(const std::string& key) {
  return key == facts::trace_version || key == facts::trace_revision || key == facts::scenario ||
         key == facts::programs || key == facts::architecture;
}

const Fact* find_fact(const std::string& key) {
  for (const Fact& fact : known_facts())
    if (key == fact.key || (fact.key.ends_with('.') && key.starts_with(fact.key))) return &fact;
  return nullptr;
}

struct Change {
  std::string name;
  std::string before, now;  // empty: not stated
  std::vector<Stage> decides;
  bool arithmetic = false;
};

/// True if both pin the same code: then no bit depends on the processor.
bool is_pinned_alike(const mcap::StringMap& before, const mcap::StringMap& now) {
  for (const char* key : {facts::pinned_mathematics, facts::pinned_renderer})
    if (stated(before, key).empty() || stated(before, key) != stated(now, key)) return false;
  return true;
}

bool says_yes(const std::string& fact) { return fact.starts_with("yes"); }

/// True for facts of pinning without a remark. If only one of the processes was pinned, this is the only remark,
/// without each variable. The reason why a process wasn't pinned gets no remark.
bool is_said_otherwise(const std::string& key, const mcap::StringMap& before, const mcap::StringMap& now) {
  const std::string then = stated(before, facts::pinned), here = stated(now, facts::pinned);
  if (then.empty() || here.empty()) return false;
  const bool other = says_yes(then) != says_yes(here);
  return key == facts::pinned ? !other : key.starts_with(facts::pinned_prefix) && other;
}

std::vector<Change> changed_facts(const Trace& golden, const Trace& actual, const CompareOptions& options) {
  std::vector<Change> changes;
  const auto before = RunFacts::of(golden).provenance, now = RunFacts::of(actual).provenance;
  if (!before || !now) return changes;
  for (const auto& [key, value] : *before) {
    const std::string other = stated(*now, key);
    if (value == other || is_of_no_interest(key) || is_said_otherwise(key, *before, *now)) continue;
    if (key.starts_with(facts::controller_prefix) && !options.takes(Stage::controller)) continue;
    const Fact* fact = find_fact(key);
    Change& change =
        changes.emplace_back(Change{key == facts::duration ? "the duration" : key, value, other, {}, false});
    if (!fact || (key == facts::processor && is_pinned_alike(*before, *now))) continue;
    change.name = fact->name;
    if (fact->key.ends_with('.')) change.name += "'" + key.substr(fact->key.size()) + "'";
    change.decides = fact->decides;
    change.arithmetic = fact->arithmetic;
  }
  if (const std::string build = stated(*now, facts::build); !build.empty() && before->count(facts::build) == 0)
    changes.push_back({"the build", "usual flags", build, every_stage, true});
  if (const std::string then = architecture_of(*before), here = architecture_of(*now); then != here)
    changes.push_back({"the processor architecture", then, here, every_stage, true});
  return changes;
}

/// True if all facts are equal, including the programs, bit by bit. The processor counts, unless both pin the same
/// code.
bool same_facts(const Trace& golden, const Trace& actual) {
  const auto before = RunFacts::of(golden).provenance, now = RunFacts::of(actual).provenance;
  if (!before || !now || before->count(facts::programs) == 0) return false;
  mcap::StringMap left = *before, right = *now;
  if (is_pinned_alike(left, right)) {
    left.erase(facts::processor);
    right.erase(facts::processor);
  }
  return left == right;
}

/// "physics, sensors and inputs"
std::string text_of(const std::vector<Stage>& stages) {
  if (stages.size() == every_stage.size()) return "everything";
  std::string text;
  for (std::size_t i = 0; i < stages.size(); ++i)
    text += (i == 0 ? "" : i + 1 == stages.size() ? " and " : ", ") + std::string(to_string(stages[i]));
  return text;
}

std::vector<std::string> changed_sources(const Trace& golden, const Trace& actual) {
  std::vector<std::string> changed;
  for (const mcap::Attachment& attachment : golden.attachments()) {
    const mcap::Attachment* other = actual.find_attachment(attachment.name);
    if (attachment.name.ends_with(".report")) continue;
    if (!other || !std::ranges::equal(attachment.data, other->data)) changed.push_back(attachment.name);
  }
  return changed;
}

}  // namespace

Result<void> check_version(const Trace& trace) { return check_trace_version(trace.metadata(), trace.file()); }

namespace {

std::vector<std::string> remarks_of(const Trace& actual, const std::vector<std::string>& files,
                                    const std::vector<Change>& changes) {
  std::vector<std::string> remarks;
  for (const std::string& name : files)
    remarks.push_back(actual.find_attachment(name) ? fmt::format("{} has changed since the golden was recorded", name)
                                                   : fmt::format("only the golden's run contained {}", name));
  for (const Change& change : changes) {
    std::string remark = fmt::format("{} was \"{}\" and is ", change.name, change.before);
    remark += change.now.empty() ? "not stated" : fmt::format("\"{}\"", change.now);
    if (!change.decides.empty()) remark += fmt::format(": {} may differ for that alone", text_of(change.decides));
    remarks.push_back(std::move(remark));
  }
  return remarks;
}

/// The changes that can explain a difference on this stage of the loop.
std::string explanation_of(Stage stage, std::vector<std::string> reasons, const std::vector<Change>& changes) {
  constexpr std::size_t most = 3;
  for (const Change& change : changes)
    if (std::ranges::find(change.decides, stage) != change.decides.end()) reasons.push_back(change.name);
  return listed(reasons, most);
}

}  // namespace

void compare_provenance(const ComparedTraces& traces, Comparison& comparison) {
  comparison.changed_files = changed_sources(traces.golden, traces.actual);
  const std::vector<Change> changes = changed_facts(traces.golden, traces.actual, traces.options);
  comparison.same_arithmetic = std::ranges::none_of(changes, [](const Change& change) { return change.arithmetic; });
  comparison.same_origin = comparison.changed_files.empty() && same_facts(traces.golden, traces.actual);
  const std::vector<std::string> remarks = remarks_of(traces.actual, comparison.changed_files, changes);
  comparison.remarks.insert(comparison.remarks.end(), remarks.begin(), remarks.end());
  if (comparison.first)
    comparison.explanation = explanation_of(comparison.first->stage, comparison.changed_files, changes);
}

Diagnostic applies_to_nothing(const ToleranceRule& rule) {
  return at(
      rule.place,
      warning(fmt::format("the tolerance of '{}' applies to nothing: neither trace has such a channel", rule.channel),
              "a golden's digest lists the names, for example SR1/RLEG_KNEE/q"));
}

namespace {

bool has_a_header(const mcap::Schema& schema) {
  const auto parsed = ros2msg::Schema::parse(schema.name, schema.data);
  return parsed && std::ranges::any_of(parsed->definitions[0].fields, [](const ros2msg::FieldDefinition& field) {
           return field.name == "header" && field.type.is_message;
         });
}

/// The names in rules of the times of a file without ticks, whose seconds and nanoseconds are one value.
void add_times(const Trace& trace, std::set<std::string, std::less<>>& names) {
  const auto is_tick = [](const TraceChannel& channel) { return channel.type == msg::Tick::type_name; };
  if (std::ranges::any_of(trace.channels(), is_tick)) return;
  for (const TraceChannel& channel : trace.channels()) {
    for (std::size_t i = 1; i < channel.columns.size(); ++i)
      if (const auto name = name_of_time(channel.columns[i - 1].element, channel.columns[i].element))
        names.insert(series_name(channel.topic, *name));
    const mcap::Schema* schema = trace.schema_of(channel);
    const bool has_header = schema && schema->encoding == "ros2msg" && has_a_header(*schema);
    if (has_header) names.insert(series_name(channel.topic, "header/stamp"));
  }
}

/// The names in rules of all messages of controllers and harness. They are read from the file.
std::set<std::string> names_of_events(std::span<const Trace* const> traces) {
  std::set<std::string> names;
  for (const Trace* trace : traces) {
    EventStream events(*trace);
    while (const msg::Event* event = events.next()) names.insert("events/" + event->source);
  }
  return names;
}

}  // namespace

Diagnostics unmatched_rules(const std::vector<ToleranceRule>& rules, std::span<const Trace* const> traces) {
  std::set<std::string, std::less<>> names;
  for (const Trace* trace : traces) {
    for (const TraceChannel& channel : trace->channels()) {
      if (channel.columns.empty()) names.emplace(series_of(channel));
      for (const TraceColumn& column : channel.columns) names.insert(series_of(channel, column));
      for (const auto& [key, value] : channel.metadata)
        if (key.starts_with("limits:"))
          names.insert("limits/" + ChannelName::parse(channel.topic).body + "/" + key.substr(key.find(':') + 1));
    }
    add_times(*trace, names);
    for (const msg::ContactChange& change : trace->contact_changes())
      names.insert("contacts/" + change.link + "/" + change.other);
  }
  std::optional<std::set<std::string>> events;
  Diagnostics warnings;
  for (const ToleranceRule& rule : rules) {
    const auto is_meant = [&rule](const std::string& name) { return matches(rule.channel, name); };
    if (std::ranges::any_of(names, is_meant)) continue;
    if (!events) events = names_of_events(traces);
    if (std::ranges::any_of(*events, is_meant)) continue;
    warnings.push_back(applies_to_nothing(rule));
  }
  return warnings;
}

}  // namespace rehearse
