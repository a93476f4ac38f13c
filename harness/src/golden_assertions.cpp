// EXPECT_MATCHES_GOLDEN and EXPECT_HOLDS, without GoogleTest.
#include <fmt/format.h>
#include <rehearse/expectation.h>
#include <rehearse/golden.h>
#include <rehearse/mcap.h>
#include <rehearse/test_support.h>
#include <rehearse/tolerance.h>

#include <algorithm>
#include <cmath>

#include "test_recordings.h"
#include "trace_scenario.h"

namespace rehearse::internal {
namespace {

/// What decides how a recording is judged. A recording of something else carries no scenario: then the defaults do.
Result<Scenario> scenario_in(const Trace& trace) {
  if (!trace.find_attachment("scenario.yaml")) return Scenario();
  const auto reader = mcap::Reader::open(trace.file());
  if (!reader) return reader.errors();
  auto scenario = scenario_of(**reader);
  if (!scenario) return scenario;
  if (const std::string file = scenario_file_of(trace); !file.empty())
    for (Expectation& expectation : scenario->expectations) expectation.place.file = file;
  return scenario;
}

bool is_at_least_0(double value) { return std::isfinite(value) && value >= 0.0; }

bool has_series(const Trace& trace, const std::string& pattern) {
  const auto& series = trace.series();
  if (std::any_of(series.begin(), series.end(), [&](const auto& named) { return matches(pattern, named.first); }))
    return true;
  return std::any_of(trace.channels().begin(), trace.channels().end(),  // pictures have no series
                     [&](const TraceChannel& channel) { return matches(pattern, channel.topic.substr(1)); });
}

/// What can't be meant so; empty if there is nothing.
std::string mistake_in(const MatchOptions& options, const Trace& trace) {
  for (const Near& near : options.near) {
    if (!is_at_least_0(near.atol) || !is_at_least_0(near.rtol))
      return fmt::format("Near{{\"{}\", {}, {}}}: a tolerance is a number, at least 0", near.channel, near.atol,
                         near.rtol);
    if (!has_series(trace, near.channel))
      return fmt::format("Near{{\"{}\", ...}}: the run has no such series; the nearest are {}", near.channel,
                         trace.nearest_series(near.channel));
  }
  if (options.until && !(*options.until >= 0.0 && *options.until <= trace.duration()))
    return fmt::format("Until{{{}}}: expected a time in the run, 0 to {} s", *options.until, trace.duration());
  if (options.levels.empty()) return "Levels{}: expected controller, plant or closed";
  return {};
}

ToleranceRule rule_for(std::string channel, double atol, double rtol) {
  ToleranceRule rule;
  rule.channel = std::move(channel);
  rule.atol = atol;
  rule.rtol = rtol;
  return rule;
}

std::vector<ToleranceRule> rules_of(const Scenario& scenario, const MatchOptions& options) {
  std::vector<ToleranceRule> rules = scenario.tolerances;
  if (options.exact) {
    ToleranceRule& all = rules.emplace_back(rule_for("*", 0.0, 0.0));
    all.pixel_share = all.pixel_delta = all.pixel_window = 0.0;
  }
  for (const Near& near : options.near) rules.push_back(rule_for(near.channel, near.atol, near.rtol));
  return rules;
}

/// Each violation with its place in the scenario, a line each.
std::string violations(const std::vector<ExpectationResult>& results) {
  std::string text;
  for (const ExpectationResult& result : results)
    if (!result.holds)
      text += fmt::format("{}{}:{}: {}", text.empty() ? "" : "\n", result.expectation.place.file,
                          result.expectation.place.line, result.sentence);
  return text;
}

}  // namespace

TestVerdict match_golden(const Trace& trace, const std::string& test, const MatchOptions& options) {
  const auto mode = golden_mode();
  if (!mode) return {false, to_string(mode.errors())};
  if (std::string mistake = mistake_in(options, trace); !mistake.empty()) return {false, std::move(mistake)};
  const auto scenario = scenario_in(trace);
  if (!scenario) return {false, to_string(scenario.errors())};
  const auto expectations = judge_expectations(scenario->expectations, trace);
  SettleOptions settling;
  settling.compare.until = options.until ? options.until : horizon_of(*scenario);
  settling.exact = options.exact && options.near.empty();
  if (first_violation(expectations)) settling.violation = verdict(expectations);
  GoldenResult result = golden_store().settle(test, trace, rules_of(*scenario, options), *mode, settling);
  if (result.written) fmt::print("{}\n", result.message);
  return {result.passed, std::move(result.message)};
}

TestVerdict hold_expectations(const Trace& trace) {
  const auto scenario = scenario_in(trace);
  if (!scenario) return {false, to_string(scenario.errors())};
  if (scenario->expectations.empty()) return {false, "the scenario expects nothing of a run: it has no 'expect:'"};
  const auto results = judge_expectations(scenario->expectations, trace);
  return {first_violation(results) == nullptr, violations(results)};
}

}  // namespace rehearse::internal
