// FormulaRun: judges a run by the expectations of its scenario that are expressions, in one pass. Internal.
#pragma once

#include <rehearse/check.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/compare/tick_clock.h"
#include "core/expression/formula.h"
#include "run_source.h"

namespace rehearse {

/// The formula of an expectation that is an expression, with the names of a source. Fails with a diagnostic at its
/// place in the scenario, if the source lacks a name, or units differ.
Result<Formula> parse_formula(const Expectation& expectation, ExpressionSource& source);

/// The mistake that the names and units of a recording show in an expectation; none if there is none, or if it is no
/// expression.
std::optional<Diagnostic> mistake_in(const Expectation& expectation, const Trace& names);

/// Sets margin and closest place. `degrees`: angles are shown in degrees. A margin that isn't finite is none.
void set_closest(const Judgement& judgement, const std::string& unit, bool degrees, const TickClock& clock,
                 ExpectationResult& result);

class FormulaRun {
 public:
  /// The expectations must outlive this. `names`: a trace with all series of the run; null: those of the first piece.
  FormulaRun(const std::vector<Expectation>& expectations, const Trace* names);

  bool empty() const { return cases_.empty(); }
  /// A piece of the run; pieces are in the order of time.
  void take(const Trace& piece);
  /// After the last piece. `names`: a trace with all series of the run.
  void finish(const Trace& names);
  /// After finish(): true if the names that the first piece lacks make a difference, so that the run must be judged
  /// again.
  bool lacked_names() const { return lacked_names_; }
  /// After finish(): true if an expression can't be judged.
  bool any_mistake() const;
  /// The result of an expectation, by its index.
  ExpectationResult result(std::size_t index, const TickClock& clock, bool ended_early) const;

 private:
  struct Case {
    std::size_t index = 0;  // of its expectation
    std::optional<Diagnostic> mistake;
    std::vector<std::string> unsampled;  // series of it that exist and have no sample
    std::unique_ptr<Formula> formula;
    std::unique_ptr<FormulaJudge> judge;
    FormulaResult result;
  };
  void parse(const Trace& names);
  void pass(std::int64_t tick, std::uint64_t time);
  void finish(Case& of, const Trace& names);
  std::string not_judged_text(const Case& of) const;
  void tell_violation(const Case& of, const TickClock& clock, bool ended_early, ExpectationResult& result) const;
  std::string sample_text(const Case& of, const TickJudgement& at, const TickClock& clock) const;

  const std::vector<Expectation>& expectations_;
  const Trace* names_;
  std::vector<Case> cases_;
  std::optional<RunSource> source_;
  bool lacked_names_ = false;
  std::optional<std::uint64_t> last_time_;
};

}  // namespace rehearse
