#include <rehearse/compare.h>

#include <algorithm>
#include <utility>

#include "compare_provenance.h"
#include "conclusion.h"
#include "core/scenario/trace_scenario.h"
#include "core/trace/run_facts.h"
#include "core/trace/trace_windows.h"
#include "run_comparer.h"

namespace rehearse {

bool CompareOptions::takes(Stage stage) const {
  return stages.empty() || std::ranges::find(stages, stage) != stages.end();
}

namespace {

/// The trace with only those messages of its state that the other run has, too; none: the trace itself.
Result<std::optional<Trace>> samples_of(const Trace& trace, const Trace& other) {
  const auto rate = RunFacts::of(other).state_rate;
  if (!rate || RunFacts::of(trace).state_rate == rate) return std::optional<Trace>();
  auto samples = REHEARSE_TRY(load_samples(trace.file(), *rate));
  return std::optional(std::move(samples));
}

Comparison compare_whole(const Trace& golden, const Trace& actual, const std::vector<ToleranceRule>& rules,
                         const CompareOptions& options) {
  WatchedLimits limits(golden, actual);
  RunSurvey golden_run(rules, std::move(limits.golden)), actual_run(rules, std::move(limits.actual));
  golden_run.take(golden);
  golden_run.finish(golden);
  actual_run.take(actual);
  actual_run.finish(actual);
  RunComparer comparer(golden_run, actual_run, rules, options);
  comparer.take({golden, actual, 0, comparer.traces().end});
  return comparer.finish();
}

}  // namespace

Comparison compare(const Trace& golden, const Trace& actual, const std::vector<ToleranceRule>& rules,
                   const CompareOptions& options) {
  for (const Trace* trace : {&golden, &actual})
    if (const auto known = check_version(*trace); !known) return refusal(known.errors()[0]);
  const auto of_golden = samples_of(golden, actual), of_actual = samples_of(actual, golden);
  for (const auto* samples : {&of_golden, &of_actual})
    if (!*samples) return refusal(samples->errors()[0]);
  return compare_whole(*of_golden ? **of_golden : golden, *of_actual ? **of_actual : actual, rules, options);
}

Result<std::vector<ToleranceRule>> tolerances_of(const Trace& trace) {
  if (!trace.find_attachment("scenario.yaml")) return std::vector<ToleranceRule>();
  auto scenario = REHEARSE_TRY(recorded_scenario(trace));
  return scenario.tolerances;
}

}  // namespace rehearse
