// Why a controller isn't a function of its inputs, in a sentence.
#include <fmt/format.h>

#include <algorithm>

#include "audit/judgement.h"

namespace rehearse {
namespace {

using Source = ObservedCall::Source;
using Kind = LibraryFinding::Kind;

std::string number_text(double number, const std::string& unit) {
  return fmt::format("{}", number) + (unit.empty() ? "" : " " + unit);
}

/// "/SR1/Stand/output/joints LLEG_KNEE/u at tick 3 (0.003 s): 1.25 N·m, then 1.31 N·m (17 ULPs)".
std::string text_of_place(const Divergence& first) {
  std::string text = first.channel + (first.element.empty() ? "" : " " + first.element) +
                     fmt::format(" at tick {} ({} s): ", first.tick, first.time);
  if (!first.note.empty()) return text + first.note;
  return text + fmt::format("{}, then {} ({:.3g} ULPs)", number_text(first.expected, first.unit),
                            number_text(first.actual, first.unit), static_cast<double>(first.ulps));
}

class Conclusion {
 public:
  Conclusion(const Evidence& evidence, const std::vector<ObservedCall>& seen, ControllerAudit& audit)
      : evidence_(evidence), seen_(seen), audit_(audit) {}

  void draw() {
    if (found_by_file() || found_by_factors()) return;
    for (const AuditedCode& code : audit_.code)
      if (code.kind == to_string(Kind::fast_math_startup)) {
        audit_.deterministic = false;
        audit_.reason = code.sentence;
        return;
      }
  }

 private:
  bool differs_under(Factor factor) const {
    const FactorResult* result = find_factor(audit_.factors, factor);
    return result && result->first;
  }

  /// A file with another content in each run makes all of them differ, whatever else was changed.
  bool found_by_file() {
    const auto changed = std::find_if(audit_.calls.begin(), audit_.calls.end(), [](const AuditedCall& call) {
      return call.source == "file" && !call.note.empty();
    });
    if (changed == audit_.calls.end() || differs_under(Factor::clock) || differs_under(Factor::random)) return false;
    for (const FactorResult& result : audit_.factors) {
      if (!result.first) continue;
      audit_.deterministic = false;
      audit_.depends_on = Factor::nothing;
      audit_.first = result.first;
      audit_.reason = fmt::format("it reads a file that changes: {} called in {}: {}; {}", changed->function,
                                  changed->place, changed->note, text_of_place(*result.first));
      return true;
    }
    return false;
  }

  /// The change that says most: what never repeats first, then what others follow from.
  bool found_by_factors() {
    for (const Factor factor :
         {Factor::threads, Factor::memory, Factor::addresses, Factor::clock, Factor::random, Factor::environment,
          Factor::folder, Factor::locale, Factor::nothing, Factor::again, Factor::recording}) {
      const FactorResult* result = find_factor(audit_.factors, factor);
      if (!result || !result->first) continue;
      audit_.deterministic = false;
      audit_.depends_on = factor;
      audit_.first = result->first;
      audit_.reason = reason_of(factor, *result->first);
      return true;
    }
    return false;
  }

  std::string reason_of(Factor factor, const Divergence& first) const {
    const std::string where = text_of_place(first);
    switch (factor) {
      case Factor::threads:
        return "it depends on which of its threads comes first: " + by_call(Source::thread, "led to ", where);
      case Factor::memory:
        return "it depends on uninitialised or freed memory: with other contents of such memory, " + where;
      case Factor::addresses:
        return "it depends on addresses (as the order or the hash of pointers): with things elsewhere in memory, " +
               where;
      case Factor::clock: return "it depends on the clock: " + by_call(Source::clock, "reached ", where);
      case Factor::random: return "it depends on random numbers: " + by_call(Source::random, "reached ", where);
      case Factor::environment:
        return "it depends on the environment: " + by_call(Source::environment, "reached ", where);
      case Factor::folder: return "it depends on the working folder: " + by_call(Source::file, "reached ", where);
      case Factor::locale: return "it depends on the locale: " + by_call(Source::locale, "reached ", where);
      case Factor::again:
        return "it depends on what an earlier run in the same process left behind (as a static variable): in a second "
               "run, " +
               where;
      case Factor::recording:
        return "on recorded inputs it commands something else than in the closed loop they were recorded in: " + where;
      case Factor::nothing: return chance(where);
    }
    return where;
  }

  /// The call of that source that reached an output, or that may have.
  std::string by_call(Source source, const char* verb, const std::string& where) const {
    const auto rank = [](const AuditedCall& call) {
      return (call.reached == AuditedCall::Reached::yes ? 2 : 0) + (call.phase == "control" ? 1 : 0);
    };
    const AuditedCall* likely = nullptr;
    int others = -1;
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const AuditedCall& call = audit_.calls[i];
      if (seen_[i].source != source || call.reached == AuditedCall::Reached::no) continue;
      ++others;
      if (!likely || rank(call) > rank(*likely)) likely = &call;
    }
    if (!likely) return where;
    const bool sure = likely->reached == AuditedCall::Reached::yes || others == 0;
    return fmt::format("{} called in {}{} {}{}", likely->function, likely->place,
                       sure ? "" : fmt::format(" (or {} more)", others), verb, where);
  }

  /// It differs from one run to the next, with nothing changed.
  std::string chance(const std::string& where) const {
    const auto asks = [&](Source source) {
      return std::any_of(seen_.begin(), seen_.end(), [=](const ObservedCall& call) { return call.source == source; });
    };
    if (asks(Source::thread))
      return "it depends on which of its threads comes first: " + by_call(Source::thread, "led to ", where);
    for (const auto& [kind, words] : {std::pair{Kind::time_stamp_counter, "the processor's clock"},
                                      {Kind::hardware_random, "the processor's random numbers"}})
      for (const AuditedCode& code : audit_.code)
        if (code.kind == to_string(kind)) return fmt::format("it depends on {}: {}; {}", words, code.sentence, where);
    for (std::size_t i = 0; i < seen_.size(); ++i)
      for (const char* identity : {"getpid", "getppid", "gettid", "gethostname", "uname", "sched_getcpu"})
        if (seen_[i].function == identity)
          return fmt::format("it depends on the process it runs in: {} called in {} reached {}",
                             audit_.calls[i].function, audit_.calls[i].place, where);
    if (asks(Source::network)) return "it depends on the network: " + by_call(Source::network, "reached ", where);
    if (asks(Source::random)) return "it depends on random numbers: " + by_call(Source::random, "reached ", where);
    if (asks(Source::clock)) return "it depends on the clock: " + by_call(Source::clock, "reached ", where);
    return fmt::format("it differs from one run to the next{}: {}",
                       evidence_.fixed_addresses ? ", and nothing that it was seen to call explains it"
                                                 : " (addresses could not be held still)",
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
