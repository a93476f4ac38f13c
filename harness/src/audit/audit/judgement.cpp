#include "judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "aspects.h"

namespace rehearse {
namespace {

using Source = ObservedCall::Source;

auto identity(const ObservedCall& call) {
  return std::tie(call.source, call.function, call.argument, call.controller, call.phase, call.place);
}

/// Keeps the earlier of both, or the only one.
void keep_earlier(std::optional<Divergence>& first, std::optional<Divergence> found) {
  if (found && (!first || found->tick < first->tick)) first = std::move(found);
}

/// The difference between the still replay and its repetition in a different process.
std::optional<Divergence> still_difference(const Evidence& evidence, const std::string& controller) {
  std::optional<Divergence> first;
  for (std::size_t i = 0; i < evidence.experiments.size(); ++i)
    if (evidence.experiments[i].factor == Factor::again)
      for (const ReplayOutcome& outcome : evidence.outcomes[i])
        keep_earlier(first, difference(evidence.still.passes[0], outcome.passes[0], evidence.time_step, controller));
  return first;
}

}  // namespace

std::vector<ObservedCall> calls_of(const Evidence& evidence, const std::string& controller) {
  std::vector<ObservedCall> all;
  for (const CallLog* log : {&evidence.plain.log, &evidence.still.log})
    for (const ObservedCall& call : log->calls) {
      if (!controller.empty() && call.controller != controller) continue;
      const auto same = [&](const ObservedCall& known) { return identity(known) == identity(call); };
      if (std::ranges::none_of(all, same)) all.push_back(call);
    }
  return all;
}

std::optional<Divergence> difference(const ReplayPass& expected, const ReplayPass& actual, double time_step,
                                     const std::string& controller) {
  const bool one_failed = expected.failure.has_value() != actual.failure.has_value();
  const std::string& failure = expected.failure ? *expected.failure : actual.failure.value_or("");
  // The failure of a different controller ends this one's run as well.
  const bool own = controller.empty() || failure.find("'" + controller + "'") != std::string::npos;
  auto found = first_difference(expected.outputs, actual.outputs, time_step, controller);
  if (!one_failed) return found;
  if (found && found->note.find("only one of two runs") == std::string::npos) return found;
  if (!own) return std::nullopt;
  if (!found) {
    found.emplace();
    found->channel = controller.empty() ? "" : "/" + controller + "/output";
  }
  found->note = "in one run it failed: " + failure;
  return found;
}

bool is_repeatable(const Evidence& evidence, const std::string& controller) {
  return !still_difference(evidence, controller);
}

const FactorResult* find_factor(const std::vector<FactorResult>& factors, Factor factor) {
  const auto found = std::ranges::find_if(factors, [=](const FactorResult& result) { return result.factor == factor; });
  return found == factors.end() ? nullptr : &*found;
}

bool differs_under(const std::vector<FactorResult>& factors, Factor factor) {
  const FactorResult* result = find_factor(factors, factor);
  return result && result->first;
}

std::vector<FactorResult> judge_factors(const Evidence& evidence, const std::string& controller) {
  const ReplayPass &plain = evidence.plain.passes[0], &still = evidence.still.passes[0];
  const auto compare = [&](const ReplayPass& expected, const ReplayPass& actual) {
    return difference(expected, actual, evidence.time_step, controller);
  };
  std::vector<FactorResult> results;
  for (std::size_t i = 0; i < evidence.experiments.size(); ++i) {
    const Factor factor = evidence.experiments[i].factor;
    FactorResult& result = results.emplace_back(FactorResult{factor, 0, evidence.experiments[i].not_varied, {}});
    for (const ReplayOutcome& outcome : evidence.outcomes[i]) {
      result.replays += static_cast<int>(outcome.passes.size());
      if (factor == Factor::nothing)
        keep_earlier(result.first, compare(plain, outcome.passes[0]));
      else if (factor != Factor::again)
        keep_earlier(result.first, compare(still, outcome.passes[0]));
      else if (outcome.passes.size() > 1)
        keep_earlier(result.first, compare(outcome.passes[0], outcome.passes[1]));
    }
  }
  const auto of = [&](Factor factor) -> FactorResult& {
    for (FactorResult& result : results)
      if (result.factor == factor) return result;
    return results.emplace_back(FactorResult{factor, 0, "", {}});
  };
  const std::vector<ObservedCall> calls = calls_of(evidence, controller);
  const bool has_threads =
      std::ranges::any_of(calls, [](const ObservedCall& call) { return aspect_of(call).factor == Factor::threads; });
  if (const auto chance = still_difference(evidence, controller)) {
    // It never repeats itself: then a difference under a factor has no meaning.
    keep_earlier(of(Factor::nothing).first, chance);
    for (FactorResult& result : results) {
      if (result.factor == Factor::nothing || (result.factor == Factor::threads && has_threads) || !result.first)
        continue;
      result.first.reset();
      result.not_varied = "it differs from one run to the next anyway";
    }
  } else {
    // Filled memory is compared with unchanged memory, if no other change of the still replay causes the difference.
    const bool explained =
        std::ranges::any_of(results, [](const FactorResult& result) { return result.first.has_value(); });
    if (!explained) of(Factor::memory).first = compare(plain, still);
  }
  FactorResult& recording = of(Factor::recording);
  if (!evidence.recorded_here) {
    recording.not_varied = "the recording was given";
  } else {
    recording.replays = 1;
    recording.first = plain.differs_from_recording;
    if (recording.first && !recording.first->channel.starts_with("/" + controller + "/")) recording.first.reset();
  }
  std::ranges::sort(results, [](const FactorResult& a, const FactorResult& b) { return a.factor < b.factor; });
  return results;
}

AuditedCall describe(const ObservedCall& call, const Evidence& evidence) {
  AuditedCall described;
  described.source = to_string(call.source);
  described.function = text_of(call);
  described.phase = call.phase;
  described.place = place_of(call);
  described.first_tick = call.first_tick;
  described.last_tick = call.last_tick;
  described.count = call.count;
  if (call.digest.empty()) return described;
  std::set<std::string> contents;
  const auto look_into = [&](const ReplayOutcome& outcome) {
    for (const ObservedCall& other : outcome.log.calls)
      if (identity(other) == identity(call)) contents.insert(other.digest);
  };
  look_into(evidence.plain);
  look_into(evidence.still);
  for (std::size_t i = 0; i < evidence.outcomes.size(); ++i)
    if (evidence.experiments[i].factor != Factor::folder)  // with this factor it is a different file
      std::ranges::for_each(evidence.outcomes[i], look_into);
  if (contents.size() > 1) described.note = "its content changed between two runs";
  return described;
}

void judge_calls(const Evidence& evidence, const std::vector<ObservedCall>& seen, ControllerAudit& audit,
                 const std::vector<std::pair<CodePlace, bool>>& tried) {
  using Reached = AuditedCall::Reached;
  // A condition that is constant in all replays but the plain ones makes those differ. It was not found by changing an
  // answer, so no call can be reported as without influence.
  const bool is_restless = differs_under(audit.factors, Factor::nothing) && is_repeatable(evidence, audit.controller);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    AuditedCall& call = audit.calls[i];
    const Aspect aspect = aspect_of(seen[i]);
    const auto factor = aspect.factor;
    const Reached unless_reached = aspect.in_part ? Reached::unknown : Reached::no;
    if (!call.note.empty()) {
      call.reached = differs_under(audit.factors, Factor::nothing) || differs_under(audit.factors, Factor::again)
                         ? Reached::yes
                         : Reached::no;
      continue;
    }
    const auto asked = std::ranges::find_if(tried, [&](const auto& t) { return t.first == seen[i].place; });
    const bool one_is_known = std::ranges::any_of(tried, [](const auto& t) { return t.second; });
    if (asked != tried.end()) {
      if (one_is_known) call.reached = asked->second ? Reached::yes : unless_reached;
      continue;
    }
    const FactorResult* result = factor ? find_factor(audit.factors, *factor) : nullptr;
    if (!result || !result->not_varied.empty()) continue;
    const auto alike = [&](const ObservedCall& other) {
      return aspect_of(other).factor == factor && other.place != seen[i].place;
    };
    if (!result->first) {
      if (!is_restless || (factor != Factor::clock && factor != Factor::random && factor != Factor::machine))
        call.reached = unless_reached;
    } else if (std::ranges::none_of(seen, alike)) {
      call.reached = Reached::yes;
    }
  }
}

std::vector<std::string> what_it_rests_on(const Evidence& evidence, const std::vector<ObservedCall>& seen,
                                          const ControllerAudit& audit) {
  std::vector<std::string> things;
  const auto add = [&](std::string thing) {
    if (std::ranges::find(things, thing) == things.end()) things.push_back(std::move(thing));
  };
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Aspect aspect = aspect_of(seen[i]);
    const bool is_given = evidence.virtualised && (aspect.factor == Factor::clock || aspect.factor == Factor::random);
    if (audit.calls[i].reached != AuditedCall::Reached::unknown || !aspect.has_answer || is_given) continue;
    if (!is_of_own_file(seen, seen[i]))
      add(fmt::format("{} called in {}{}", audit.calls[i].function, audit.calls[i].place,
                      aspect.in_part ? " (its order was varied)" : ""));
  }
  const bool hidden = evidence.plain.log.hidden_calls || evidence.still.log.hidden_calls;
  for (const AuditedCode& code : audit.code) {
    const std::string where = code.sentence.substr(code.sentence.find(": ") + 2);
    if (code.kind == to_string(CodeKind::processor_query) || code.kind == to_string(CodeKind::approximation))
      add("the processor (" + where + ")");
    // Replays read other values of them, but seldom those on which a branch depends.
    if (code.kind == to_string(CodeKind::time_stamp_counter)) add("the processor's clock (" + where + ")");
    if (code.kind == to_string(CodeKind::hardware_random)) add("the processor's random numbers (" + where + ")");
    if (code.kind == to_string(CodeKind::direct_syscall) && hidden)
      add("system calls that can't be watched (" + where + ")");
  }
  return things;
}

std::vector<std::string> liberties_of(const std::vector<ObservedCall>& calls) {
  constexpr std::pair<std::string_view, std::string_view> deeds[] = {
      {" exit _exit _Exit quick_exit abort ", "ends the process"},
      {" close ", "closes a file descriptor that isn't its own"},
      {" close_range closefrom ", "closes file descriptors that aren't its own"},
      {" chdir fchdir ", "changes the working folder of the whole process"},
      {" signal sigaction ", "changes how the whole process takes a signal"},
      {" setlocale ", "changes the locale of the whole process"},
      {" setenv putenv unsetenv ", "changes the environment of the whole process"}};
  std::vector<std::string> sentences;
  std::set<std::pair<std::string, std::string>> told;
  for (const ObservedCall& call : calls) {
    const auto deed =
        std::ranges::find_if(deeds, [&](const auto& known) { return is_one_of(call.function, known.first); });
    if (deed == std::end(deeds)) continue;
    if (call.function == "setlocale" && call.argument.find("NULL") != std::string::npos) continue;  // a query only
    if (!told.emplace(call.controller, call.function).second) continue;
    sentences.push_back(fmt::format("{}: {} by {} in {}, called in {}", call.controller, deed->second, text_of(call),
                                    call.phase + "()", place_of(call)));
  }
  return sentences;
}

}  // namespace rehearse
