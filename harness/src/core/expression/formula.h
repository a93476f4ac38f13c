// Formula: a condition with operators of time, judged on a whole run in one pass.
//
//   always, eventually or never E          at the ticks of a span
//   E within 0.5 s after C                 each time that C becomes true
//   E except X for 0.3 s                   not in the ticks after X
//
// The page concepts/expectations.md states what each form means, in signal temporal logic. A window that the run's end
// cuts is undecided, unless the ticks before the end decide it.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "expression.h"
#include "signal.h"

namespace rehearse {

enum class Quantifier { always, eventually, never };

/// Times in [ns].
struct Formula {
  Quantifier quantifier = Quantifier::always;
  Expression condition;
  std::optional<Expression> after, except;
  std::optional<std::uint64_t> within, lasting;  // lasting: `for`
  std::uint64_t from = 0;
  std::uint64_t until = std::numeric_limits<std::uint64_t>::max();
};

/// The judgement of one tick.
struct TickJudgement {
  std::uint64_t time = 0;  // of the tick [ns]
  Judgement judgement;     // its own time is that of the comparison that decides, which may be later
};

struct FormulaResult {
  enum class State { holds, violated, undecided };

  State state = State::holds;
  bool is_nan = false;     // it would be decided if a number weren't NaN
  bool any_tick = false;   // a tick was judged
  bool triggered = false;  // the condition of `after` became true
  /// Of a violation: the first tick that violates it; of `eventually`: the nearest one. Of an undecided formula: the
  /// first tick whose window is cut.
  std::optional<TickJudgement> first;
  std::optional<TickJudgement> worst;     // of a violation: the tick with the least margin
  std::optional<TickJudgement> decisive;  // the margin of the whole formula; none: no numbers were compared
};

class FormulaJudge {
 public:
  /// The formula must outlive this.
  explicit FormulaJudge(const Formula& formula);

  /// The next tick of the run [ns].
  void take(ExpressionSource& source, std::int64_t tick, std::uint64_t time);
  /// After the last tick, which was at `last` [ns].
  FormulaResult finish(std::uint64_t last);

 private:
  /// The least or greatest judgements so far, each with its tick.
  struct Bounds {
    std::optional<TickJudgement> worst, best;
  };
  void take_ready();
  /// Of a condition for all ticks.
  void fold_all(const Judged& judged);
  /// Of a condition for one of the ticks.
  void fold_some(const Judged& judged);
  /// Of `eventually` after each rise of a condition: only the last rise counts, because its span is in all others'.
  void fold_after_rise(const Judged& rise, const Judged& judged);
  void note_unknown(const Judged& judged);
  FormulaResult unknown_result(FormulaResult result) const;

  const Formula& formula_;
  bool of_some_ = false;  // one tick is enough
  bool triggered_ = false, any_ = false, may_rise_ = false, rises_surely_ = false;
  SignalPtr whole_;  // judged at each tick
  SignalPtr rises_;  // with `eventually ... after` without `within`; null otherwise
  Bounds bounds_;
  std::optional<TickJudgement> first_violation_, first_nan_, first_cut_;
  std::uint64_t last_rise_ = 0;
};

}  // namespace rehearse
