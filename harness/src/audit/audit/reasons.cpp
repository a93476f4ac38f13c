// The reason why a controller isn't a function of its inputs, as a sentence.
#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "aspects.h"
#include "core/compare/divergence_text.h"
#include "judgement.h"

namespace rehearse {
namespace {

using Source = ObservedCall::Source;

std::string number_text(double number, const std::string& unit) {
  return fmt::format("{}", number) + (unit.empty() ? "" : " " + unit);
}

/// "/SR1/Stand/output/joints LLEG_KNEE/u at tick 3 (0.003 s): 1.25 N·m, then 1.31 N·m (17 ULPs)".
std::string text_of_place(const Divergence& first) {
  std::string text = first.channel + (first.element.empty() ? "" : " " + first.element) +
                     fmt::format(" at tick {} ({} s): ", first.tick, first.time);
  if (!first.note.empty()) return text + first.note;
  const std::string ulps = few_ulps_text(first.ulps);
  return text + fmt::format("{}, then {}{}", number_text(first.expected, first.unit),
                            number_text(first.actual, first.unit), ulps.empty() ? "" : " (" + ulps + ")");
}

class Conclusion {
 public:
  Conclusion(const Evidence& evidence, const std::vector<ObservedCall>& seen, ControllerAudit& audit)
      : evidence_(evidence), seen_(seen), audit_(audit) {}

  void draw() {
    if (found_by_file() || found_by_factors()) return;
    for (const AuditedCode& code : audit_.code)
      if (code.kind == to_string(CodeKind::fast_math_startup)) {
        audit_.deterministic = false;
        audit_.reason = code.sentence;
        return;
      }
  }

 private:
  /// A file with different content in each run, which the controller didn't write itself just before.
  bool found_by_file() {
    std::size_t changed = 0;
    while (changed < seen_.size() && (seen_[changed].source != Source::file || audit_.calls[changed].note.empty() ||
                                      is_of_own_file(seen_, seen_[changed])))
      ++changed;
    if (changed == seen_.size() || differs_under(audit_.factors, Factor::clock) ||
        differs_under(audit_.factors, Factor::random))
      return false;
    const AuditedCall& call = audit_.calls[changed];
    for (const Factor factor : {Factor::nothing, Factor::again}) {
      if (!differs_under(audit_.factors, factor)) continue;
      audit_.deterministic = false;
      audit_.depends_on = factor;
      audit_.first = find_factor(audit_.factors, factor)->first;
      audit_.reason = fmt::format("it reads a file that changes: {} called in {}: {}; {}", call.function, call.place,
                                  call.note, text_of_place(*audit_.first));
      return true;
    }
    return false;
  }

  /// Chooses the most specific factor: first the lack of repeatability, then factors that cause others.
  bool found_by_factors() {
    for (const Factor factor :
         {Factor::threads, Factor::memory, Factor::addresses, Factor::clock, Factor::random, Factor::machine,
          Factor::environment, Factor::folder, Factor::locale, Factor::nothing, Factor::again, Factor::recording}) {
      if (!differs_under(audit_.factors, factor)) continue;
      audit_.deterministic = false;
      audit_.depends_on = factor;
      audit_.first = find_factor(audit_.factors, factor)->first;
      audit_.reason = reason_of(factor, *audit_.first);
      return true;
    }
    return false;
  }

  std::string reason_of(Factor factor, const Divergence& first) const {
    const std::string where = text_of_place(first);
    switch (factor) {
      case Factor::threads: return by_call(goes_by(factor), "led to ", where, "the order of its threads");
      case Factor::memory:
        return "it depends on uninitialised or freed memory: with other contents of such memory, " + where;
      case Factor::addresses:
        return "it depends on addresses (as the order or the hash of pointers): with data at other places in memory, " +
               where;
      case Factor::clock: return by_call(goes_by(factor), "reached ", where, "the clock");
      case Factor::random: return by_call(goes_by(factor), "reached ", where, "random numbers");
      case Factor::machine: return by_call(goes_by(factor), "reached ", where, "the machine, the terminal or the user");
      case Factor::environment: return by_call(goes_by(factor), "reached ", where, "the environment");
      case Factor::folder: return by_call(goes_by(factor), "reached ", where, "the working folder");
      case Factor::locale: return by_call(goes_by(factor), "reached ", where, "the locale");
      case Factor::again:
        return "it depends on data that an earlier run in the same process left behind (as a static variable): in a "
               "second "
               "run, " +
               where;
      case Factor::recording:
        return "its commands on the recorded inputs differ from those in the closed loop of the recording: " + where;
      case Factor::nothing: return chance(where);
    }
    return where;
  }

  using Choice = std::function<bool(const ObservedCall&)>;

  static Choice goes_by(Factor factor) {
    return [=](const ObservedCall& call) { return aspect_of(call).factor == factor; };
  }

  bool may_explain(std::size_t i, const Choice& choice) const {
    return choice(seen_[i]) && aspect_of(seen_[i]).has_answer && audit_.calls[i].reached != AuditedCall::Reached::no;
  }

  bool any(const Choice& choice) const {
    for (std::size_t i = 0; i < seen_.size(); ++i)
      if (may_explain(i, choice)) return true;
    return false;
  }

  /// The chosen call that reached an output, or may have reached one. Without one, `words`.
  std::string by_call(const Choice& choice, const char* verb, const std::string& where, std::string_view words) const {
    const auto rank = [](const AuditedCall& call) {
      return (call.reached == AuditedCall::Reached::yes ? 2 : 0) + (call.phase == "control" ? 1 : 0);
    };
    std::optional<std::size_t> likely;
    int others = -1;
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      if (!may_explain(i, choice)) continue;
      ++others;
      if (!likely || rank(audit_.calls[i]) > rank(audit_.calls[*likely])) likely = i;
    }
    if (!likely) return fmt::format("it depends on {}: {}", words, where);
    const AuditedCall& call = audit_.calls[*likely];
    const bool sure = call.reached == AuditedCall::Reached::yes || others == 0;
    return fmt::format("it depends on {}: {} called in {}{} {}{}", aspect_of(seen_[*likely]).words, call.function,
                       call.place, sure ? "" : fmt::format(" (or {} more)", others), verb, where);
  }

  std::optional<std::string> by_processor(const std::string& where) const {
    for (const auto& [kind, words] : {std::pair{CodeKind::time_stamp_counter, "the processor's clock"},
                                      {CodeKind::hardware_random, "the processor's random numbers"}})
      for (const AuditedCode& code : audit_.code)
        if (code.kind == to_string(kind)) return fmt::format("it depends on {}: {}; {}", words, code.sentence, where);
    return std::nullopt;
  }

  /// The reason for outputs that differ between unchanged runs.
  std::string chance(const std::string& where) const {
    const auto is_from = [](Source source) { return [=](const ObservedCall& call) { return call.source == source; }; };
    const auto is_program = [](const ObservedCall& call) {
      return call.source == Source::thread && !aspect_of(call).factor;
    };
    // Conditions that are constant in most replays can't cause differences between these replays.
    const std::vector<Choice> held = {goes_by(Factor::random), goes_by(Factor::clock), goes_by(Factor::machine)};
    if (is_repeatable(evidence_, audit_.controller))
      for (const Choice& choice : held)
        if (any(choice)) return by_call(choice, "reached ", where, "");
    if (any(goes_by(Factor::threads))) return by_call(goes_by(Factor::threads), "led to ", where, "");
    if (auto reason = by_processor(where)) return *reason;
    for (const Choice& choice :
         {Choice(goes_by(Factor::nothing)), Choice(is_from(Source::network)), Choice(is_program)})
      if (any(choice)) return by_call(choice, "reached ", where, "");
    if (evidence_.plain.log.hidden_calls)
      for (const AuditedCode& code : audit_.code)
        if (code.kind == to_string(CodeKind::direct_syscall))
          return fmt::format("it differs from one run to the next, and {}; {}", code.sentence, where);
    const Choice everything = [](const ObservedCall&) { return true; };
    if (any(everything)) return by_call(everything, "may have reached ", where, "");
    return fmt::format("it differs from one run to the next{}: {}",
                       evidence_.fixed_addresses ? ", and none of its observed calls explains it"
                                                 : " (addresses could not be kept constant)",
                       where);
  }

  const Evidence& evidence_;
  const std::vector<ObservedCall>& seen_;
  ControllerAudit& audit_;
};

}  // namespace

void conclude(const Evidence& evidence, const std::vector<ObservedCall>& seen, ControllerAudit& audit) {
  Conclusion(evidence, seen, audit).draw();
}

}  // namespace rehearse
