#include "case_run.h"

#include <fmt/format.h>
#include <rehearse/check.h>
#include <rehearse/compare.h>
#include <rehearse/mcap.h>
#include <sys/resource.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <utility>

#include "base/hashing.h"
#include "campaigns/plan/result_lines.h"
#include "core/check/unknown_series.h"
#include "core/scenario/campaign_claims.h"
#include "core/trace/run_facts.h"

namespace rehearse {
namespace {

CaseVerdict verdict_of(RunEnding ending) {
  switch (ending) {
    case RunEnding::complete:
    case RunEnding::interrupted: break;
    case RunEnding::refused:
    case RunEnding::threw:
    case RunEnding::exited: return CaseVerdict::failed;
    case RunEnding::crashed: return CaseVerdict::crashed;
    case RunEnding::hung: return CaseVerdict::hung;
    case RunEnding::exploded: return CaseVerdict::exploded;
  }
  return CaseVerdict::passed;
}

void take_violation(const JudgedRecording& judged, CaseResult& result) {
  for (const ExpectationResult& expectation : judged.expectations) result.margins.push_back(expectation.margin);
  const ExpectationResult* violation = first_violation(judged.expectations);
  if (!violation || !result.passed()) return;
  result.verdict = CaseVerdict::violated;
  result.sentence = violation->sentence;
  result.reason = violation->text;
  if (violation->first) result.tick = violation->first->tick;
}

Result<void> compare_with_golden(const Scenario& scenario, const CampaignOptions& options,
                                 const std::filesystem::path& trace, CaseResult& result) {
  if (options.golden.empty() || !result.passed()) return {};
  CompareOptions comparing;
  comparing.until = scenario.horizon;
  const auto compared = REHEARSE_TRY(compare(options.golden, trace, scenario.tolerances, comparing));
  if (compared.within) return {};
  result.verdict = CaseVerdict::differs;
  result.sentence = verdict(compared);
  result.reason = "beyond the golden's tolerances";
  if (compared.first) {
    result.reason =
        fmt::format("{} {} is beyond the golden's tolerances", compared.first->channel, compared.first->element);
    result.tick = compared.first->tick;
  }
  return {};
}

void add_error(std::string text, CaseResult& result) {
  if (result.errors++ == 0) result.first_error = std::move(text);
}

/// The scenario whose expectations are followed by the conditions of `sometimes`.
Scenario with_conditions(const Scenario& scenario) {
  Scenario judged = scenario;
  for (const SometimesClaim& claim : claims_of(scenario).sometimes) judged.expectations.push_back(claim.condition);
  return judged;
}

/// Takes the results of the conditions from those of the expectations.
void take_conditions(std::size_t expectations, JudgedRecording& judged, CaseResult& result) {
  for (std::size_t i = expectations; i < judged.expectations.size(); ++i)
    result.reached.push_back(judged.expectations[i].holds);
  judged.expectations.resize(expectations);
}

/// Remarks on controllers that are errors, as numbers that aren't finite; without the failure itself.
void take_errors(const RunSummary& run, CaseResult& result) {
  for (const Diagnostic& remark : run.remarks)
    if (remark.severity == Severity::error && !(run.failure && remark.message.ends_with(run.failure->message)))
      add_error(remark.message, result);
}

/// The system's errors that aren't of a case: the same case may run later, or on another machine.
constexpr int errors_of_environment[] = {ENOSPC, EDQUOT, EFBIG, EIO, EROFS, ENOMEM, ENFILE, ESTALE};

bool is_of_environment(const Diagnostics& problems, const std::filesystem::path& trace) {
  return std::ranges::any_of(problems, [&](const Diagnostic& problem) {
    return problem.file == trace.string() || std::ranges::any_of(errors_of_environment, [&](int number) {
             return problem.message.find(std::strerror(number)) != std::string::npos;
           });
  });
}

/// Largest file that this process may write [bytes]. A controller can change it.
rlim_t file_limit() {
  rlimit limit{};
  ::getrlimit(RLIMIT_FSIZE, &limit);
  return limit.rlim_cur;
}

}  // namespace

bool is_error_line(std::string_view line) {
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  const auto ends_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_'; };
  const auto begin = std::ranges::find_if(line, is_letter), end = std::ranges::find_if(begin, line.end(), ends_word);
  std::string word(begin, end);
  for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return word == "error";
}

CaseResult ended_case(std::int64_t number, CaseVerdict verdict, std::string sentence) {
  CaseResult result;
  result.number = number;
  result.verdict = verdict;
  result.reason = without_numbers(sentence);
  result.sentence = std::move(sentence);
  return result;
}

Result<CaseRun> run_case(const std::filesystem::path& file, const std::string& text, const CampaignOptions& options,
                         const std::filesystem::path& trace, const Simulation& simulation) {
  CaseRun made;
  CaseResult& result = made.result;
  const rlim_t limit = file_limit();
  const auto invalid = [&](const Diagnostics& problems) -> Result<CaseRun> {
    if (file_limit() == limit && is_of_environment(problems, trace)) return problems;
    result.verdict = CaseVerdict::invalid;
    result.sentence = problems.front().message;
    result.reason = without_numbers(result.sentence);
    return made;
  };
  std::error_code ignored;
  std::filesystem::remove(trace, ignored);  // the trace of the previous case
  const auto scenario = Scenario::load_text(text, file);
  if (!scenario) return invalid(scenario.errors());
  RecordOptions recording;
  static_cast<HostOptions&>(recording) = options.host;
  if (options.golden.empty()) recording.checkpoint_period = 0.0;  // goldens have checkpoints
  recording.on_message = [&](const std::string& controller, const std::string& line) {
    if (is_error_line(line)) add_error(controller + ": " + line, result);
  };
  const auto run = simulation.record(*scenario, trace, recording);
  if (!run) return invalid(run.errors());
  result.ticks = run->ticks;
  result.verdict = verdict_of(run->end);
  take_errors(*run, result);
  if (!result.passed()) {
    result.sentence = run->failure->message;
    result.reason = without_numbers(result.sentence);
    result.tick = run->ticks;
  }
  const Scenario conditional = with_conditions(*scenario);
  auto judged = judge_recording(conditional.expectations, trace);
  if (!judged && !run->trace_changed) return judged.errors();  // its own process has just written it
  if (!judged) return invalid(judged.errors());
  CheckReport report;
  report.run = *run;
  report.expectations = judged->expectations;
  if (const auto known = refuse_unknown_series(conditional, report, {trace}); !known) {
    const Diagnostic& problem = known.errors().front();
    return invalid({error(fmt::format("{} ({})", problem.message, problem.hint))});
  }
  take_conditions(scenario->expectations.size(), *judged, result);
  result.hash = hash_text(judged->content);
  for (const ExpectationResult& expectation : judged->expectations) made.expectations.push_back(expectation.text);
  take_violation(*judged, result);
  if (const auto compared = compare_with_golden(*scenario, options, trace, result); !compared)
    return mcap::Reader::open(options.golden) ? invalid(compared.errors()) : Result<CaseRun>(compared.errors());
  if (const auto reader = mcap::Reader::open(trace)) made.libraries = RunFacts::of(**reader).controllers;
  return made;
}

}  // namespace rehearse
