// The `expect` of a scenario: properties that a run must have.
#include "bound_form.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>

#include <array>

namespace rehearse {
namespace {

const BoundForm<Expectation>& bound_expectation_form() {
  constexpr Range any_value{-1e12, 1e12};
  const ValueType measure = types::quantity(angle_units, any_value);
  const ValueType moment = types::quantity(time_units, any_time);
  const ValueType condition = types::some_text();
  static const BoundForm<Expectation> form{
      "expectation",
      "an expectation",
      {FormKey{"channel", types::text_like("^[^/]"),
               "a pattern of series names, as SR1/*/q: every matching series must be within the bounds, and there must "
               "be at least one"},
       FormKey{"event", types::some_text(), "a pattern of SEVERITY SOURCE: TEXT: a matching event must happen"},
       FormKey{"no_event", types::some_text(), "such a pattern: no matching event may happen; error * are all errors"},
       FormKey{"above", measure, "a bound; an equal value violates it"},
       FormKey{"below", measure, "likewise"},
       FormKey{"near", measure, "the value from which the distance within is measured; an equal distance is right"},
       FormKey{"within", types::either({measure, types::quantity(time_units, any_time)}),
               "the distance from near; of a condition: the time in which it must become true, with after or always"},
       {"abs", &Expectation::absolute, "the bounds apply to the magnitude"},
       FormKey{"since", moment,
               "the bounds apply to the change since the latest sample up to that time; not after at or from [s]"},
       FormKey{"from", moment,
               "beginning of the span in which every sample counts, included; default: that of the run, or since [s]"},
       FormKey{"until", moment, "its end, included; default: that of the run [s]"},
       FormKey{"at",
               types::either({types::number(any_time), types::quantity(time_units, any_time), types::word({"end"})}),
               "instead of a span: the latest sample up to that time [s]; end: the last one"},
       {"sometime", &Expectation::sometime, "one sample of the span is enough"},
       FormKey{"always", condition, "a condition, true at each tick"},
       FormKey{"eventually", condition, "a condition, true at some tick"},
       FormKey{"never", condition, "a condition, true at no tick"},
       FormKey{"after", condition, "a condition: each time that it becomes true, the expectation is judged"},
       FormKey{"except", condition, "a condition: its ticks don't count"},
       FormKey{"for", moment,
               "how long the condition must last; with except, how long a tick is excepted; with always only beside "
               "after or except [s]"},
       FormKey{"margin", types::either({measure, types::matching("[+-]?[0-9.eE+-]+ *%")}),
               "the least distance from a violation: a share of the bound, as 10 %, or a number in its unit"}},
      {},
      {{"channel", "event", "no_event", "always", "eventually", "never"}}};
  return form;
}

constexpr std::array subjects{"channel", "event", "no_event", "always", "eventually", "never"};
constexpr std::size_t first_quantifier = 3;

class ExpectationReader {
 public:
  ExpectationReader(Findings& findings, Scenario& scenario) : findings_(findings), scenario_(scenario) {}

  void read_entry(const YamlNode& node);

 private:
  bool read_subject(const Keys& keys, const YamlNode& node, Expectation& expectation) const;
  void refuse_of_events(const Keys& keys) const;
  void refuse_of_series(const Keys& keys) const;
  void read_bounds(const Keys& keys, const YamlNode& node, Expectation& expectation) const;
  void check_bounds(const Keys& keys, const Expectation& expectation) const;
  void read_bound(const Keys& keys, std::string_view key, std::optional<double>& bound, Expectation& expectation) const;
  void read_span(const Keys& keys, Expectation& expectation) const;
  void read_moment(const Keys& keys, Expectation& expectation) const;
  void read_since(const Keys& keys, Expectation& expectation) const;
  std::optional<double> read_time(const YamlNode& node, std::string_view key) const;

  Findings& findings_;
  Scenario& scenario_;
};

void ExpectationReader::read_entry(const YamlNode& node) {
  const Keys keys(findings_, node, expectation_form());
  if (!keys.is_map()) return;
  Expectation expectation;
  expectation.place = {scenario_.file, node.line, node.column};
  if (!read_subject(keys, node, expectation)) return;
  if (expectation.subject == Expectation::Subject::series) {
    bound_expectation_form().read(keys, expectation);
    read_bounds(keys, node, expectation);
    read_moment(keys, expectation);
    refuse_of_series(keys);
    read_margin(findings_, keys, expectation);
  } else if (expectation.subject == Expectation::Subject::expression) {
    read_expressions(findings_, keys, scenario_, expectation);
  } else {
    refuse_of_events(keys);
  }
  read_span(keys, expectation);
  read_since(keys, expectation);
  scenario_.expectations.push_back(std::move(expectation));
}

/// True if there is a subject, so that the rest can be checked.
bool ExpectationReader::read_subject(const Keys& keys, const YamlNode& node, Expectation& expectation) const {
  const YamlNode* found = nullptr;
  for (std::size_t i = 0; i < subjects.size(); ++i) {
    const YamlNode* subject = keys.find(subjects[i]);
    if (subject == nullptr) continue;
    if (found != nullptr) {
      findings_.error(node, "an expectation has two subjects",
                      "expected one of channel, event, no_event, always, eventually and never");
      return false;
    }
    found = subject;
    expectation.place = {scenario_.file, subject->line, subject->column};
    if (i >= first_quantifier) {
      expectation.subject = Expectation::Subject::expression;
      expectation.quantifier = static_cast<Expectation::Quantifier>(i - first_quantifier);
      const auto text = read_text(findings_, *subject, subjects[i], "a condition as \"SR1/KNEE/u < 100\"");
      if (!text) return false;
      expectation.expression = *text;
      continue;
    }
    expectation.subject = static_cast<Expectation::Subject>(i);
    const auto pattern = read_text(findings_, *subject, subjects[i], "a pattern, in which * stands for any text");
    if (!pattern) return false;
    expectation.pattern = *pattern;
    const bool is_series = expectation.subject == Expectation::Subject::series;
    if (pattern->empty() || (is_series && pattern->front() == '/'))
      expected(
          findings_, *subject, subjects[i],
          is_series ? "a pattern such as SR1/*/q, without a slash at its beginning" : "a pattern such as \"error *\"");
  }
  if (found == nullptr &&
      keys.require("channel",
                   "the name of a series; or event or no_event: a pattern; or always, eventually or never: a "
                   "condition") == nullptr)
    return false;
  return true;
}

void ExpectationReader::refuse_of_events(const Keys& keys) const {
  for (const NamedEntry& entry : keys.entries()) {
    for (const std::string_view key :
         {"above", "below", "near", "within", "abs", "since", "at", "sometime", "after", "except", "for", "margin"})
      if (entry.name == key)
        findings_.error(*entry.key, fmt::format("'{}' is given for an event", key),
                        "an event has no values; from and until limit its time");
  }
}

void ExpectationReader::refuse_of_series(const Keys& keys) const {
  for (const std::string_view key : {"after", "except", "for"})
    if (const YamlNode* node = keys.find(key))
      findings_.error(*node, fmt::format("'{}' is given for a channel", key),
                      "it belongs to always, eventually or never");
}

void ExpectationReader::read_bound(const Keys& keys, std::string_view key, std::optional<double>& bound,
                                   Expectation& expectation) const {
  const YamlNode* node = keys.find(key);
  if (node == nullptr) return;
  const auto quantity = read_measure(findings_, *node, key);
  if (!quantity) return;
  bound = quantity->value;
  expectation.angle |= quantity->angle;
  expectation.degrees |= quantity->degrees;
}

void ExpectationReader::read_bounds(const Keys& keys, const YamlNode& node, Expectation& expectation) const {
  read_bound(keys, "above", expectation.above, expectation);
  read_bound(keys, "below", expectation.below, expectation);
  read_bound(keys, "near", expectation.near, expectation);
  read_bound(keys, "within", expectation.within, expectation);
  const YamlNode *above = keys.find("above"), *below = keys.find("below");
  const YamlNode *near = keys.find("near"), *within = keys.find("within");
  if (!above && !below && !near && !within) {
    if (!keys.has_unknown())  // an unknown key may be a misspelt subject
      findings_.error(node, "an expectation has no bound", "expected above, below, or near and within");
  } else if (near && !within) {
    findings_.error(*near, "'near' without 'within'", "expected within: D, the allowed distance from it");
  } else if (within && !near) {
    findings_.error(*within, "'within' without 'near'", "expected near: X, from which the distance is measured");
  } else if (near && (above || below)) {
    findings_.error(above ? *above : *below, fmt::format("'{}' beside 'near'", above ? "above" : "below"),
                    "either near and within, or above and below");
  } else {
    check_bounds(keys, expectation);
  }
}

/// Reports bounds that no value can satisfy.
void ExpectationReader::check_bounds(const Keys& keys, const Expectation& expectation) const {
  if (expectation.above && expectation.below && *expectation.above >= *expectation.below)
    findings_.error(*keys.find("above"), fmt::format("above is {}, which is not less than below", *expectation.above),
                    fmt::format("expected a number less than {}", *expectation.below));
  if (expectation.within && *expectation.within < 0.0)
    expected(findings_, *keys.find("within"), "within", "a distance, at least 0");
  if (!expectation.absolute) return;
  if (expectation.below && *expectation.below <= 0.0)
    expected(findings_, *keys.find("below"), "below", "a number above 0, because no magnitude is less");
}

std::optional<double> ExpectationReader::read_time(const YamlNode& node, std::string_view key) const {
  const auto time = read_seconds(findings_, node, key, {0.0, Scenario::max_duration, "[s]"});
  if (!time || scenario_.duration <= 0.0 || *time <= scenario_.duration) return time;
  findings_.error(node, fmt::format("{} is {}, after the end of the run", key, *time),
                  fmt::format("expected a time up to the duration, {} s", scenario_.duration));
  return std::nullopt;
}

void ExpectationReader::read_span(const Keys& keys, Expectation& expectation) const {
  const YamlNode *from = keys.find("from"), *until = keys.find("until");
  if (from != nullptr) expectation.from = read_time(*from, "from");
  if (until != nullptr) expectation.until = read_time(*until, "until");
  if (expectation.from && expectation.until && *expectation.until < *expectation.from)
    findings_.error(*until, fmt::format("until is {}, which is before from", *expectation.until),
                    fmt::format("expected a time from {} [s] on", *expectation.from));
}

/// Reads `at`, which replaces a span.
void ExpectationReader::read_moment(const Keys& keys, Expectation& expectation) const {
  const YamlNode* at = keys.find("at");
  if (at == nullptr) return;
  for (const std::string_view other : {"from", "until", "sometime"})
    if (const YamlNode* node = keys.find(other))
      findings_.error(*node, fmt::format("'{}' beside 'at'", other), "either a moment or a span of time");
  if (at->kind == YamlNode::Kind::scalar && at->text == "end") {
    expectation.at_end = true;
  } else if (at->kind == YamlNode::Kind::scalar && !at->text.empty() &&
             at->text.find_first_not_of("0123456789+-.eE") == std::string::npos) {
    expectation.at = read_time(*at, "at");
  } else {
    expected(findings_, *at, "at", "a time [s], or end");
  }
}

void ExpectationReader::read_since(const Keys& keys, Expectation& expectation) const {
  const YamlNode* since = keys.find("since");
  if (since == nullptr || expectation.subject != Expectation::Subject::series) return;
  expectation.since = read_time(*since, "since");
  if (!expectation.since || expectation.at_end) return;
  const auto not_after = [&](const std::optional<double>& time, std::string_view key) {
    if (time && *expectation.since > *time)
      findings_.error(*since, fmt::format("since is {}, which is after {}", *expectation.since, key),
                      fmt::format("expected a time up to {} [s]", *time));
  };
  not_after(expectation.at, "at");
  not_after(expectation.from, "from");
  if (expectation.at || expectation.from) return;
  not_after(expectation.until, "until");
  expectation.from = expectation.since;
}

}  // namespace

const Form& expectation_form() { return bound_expectation_form(); }

void read_expectations(Findings& findings, const YamlNode& node, Scenario& scenario) {
  ExpectationReader reader(findings, scenario);
  for (const YamlNodePtr& entry : read_list(findings, node, "expect", "a list of properties that a run must have"))
    reader.read_entry(*entry);
}

}  // namespace rehearse
