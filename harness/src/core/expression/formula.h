// Formula: a condition with operators of time, judged on a whole run in one pass.
//
//   always, eventually or never E          at the ticks of a span
//   E within 0.5 s after C                 each time that C becomes true
//   E except X for 0.3 s                   not in the ticks after X
//
// The page concepts/expectations.md states what each form means, in signal temporal logic. A window that the run's end
// cuts is undecided, unless the ticks before the end decide it. Ticks before the first samples of the series aren't
// judged, unless the other series decide them.
#pragma once

#include <cstdint>
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
  TimeSpan span;
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
  bool any_tick = false;   // the span has a tick
  bool is_judged = false;  // one of them was judged; if not, the formula is undecided
  bool triggered = false;  // the condition of `after` became true in the span
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
  /// After the last tick. `blank_is_nan`: a series whose messages began with NaN got a number later, so that it is no
  /// quantity that the run lacks, and the NaN was a sample.
  FormulaResult finish(bool blank_is_nan = false);

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
  /// False if the tick isn't judged.
  bool note_trigger(const Judged& rise);
  bool note(const Judged& judged);
  void note_blank(const Judged& judged);
  void note_rise(const Judged& rise, std::uint64_t time);
  FormulaResult unknown_result(FormulaResult result, bool is_over) const;
  /// True if one of its ticks makes it true.
  bool is_of_one_tick() const { return of_some_ || rises_; }
  /// The time of the tick that would be the next one, by the smallest distance of two ticks [ns].
  std::uint64_t next_time() const;

  const Formula& formula_;
  bool of_some_ = false;  // one tick is enough
  bool triggered_ = false, any_ = false, is_judged_ = false, may_rise_ = false, rises_surely_ = false;
  SignalPtr whole_;  // judged at each tick
  SignalPtr rises_;  // with `eventually ... after` without `within`; null otherwise
  Bounds bounds_;
  std::optional<TickJudgement> first_violation_, first_nan_, first_cut_, first_blank_;
  std::uint64_t last_rise_ = 0;
  std::optional<std::uint64_t> last_, step_;  // the latest tick, and the smallest distance of two [ns]
};

}  // namespace rehearse
