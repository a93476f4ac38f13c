#include "judgement.h"

#include <utility>

namespace rehearse {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

Judgement certain_judgement(bool truth) {
  Judgement judgement;
  judgement.truth = truth;
  judgement.margin = truth ? infinite : -infinite;
  return judgement;
}

/// True if `b` must replace `a` as the lesser one.
bool is_less(const Judgement& b, const Judgement& a) {
  return b.margin < a.margin || (b.margin == a.margin && !b.truth && a.truth);
}

/// What is known has no cause of being unknown.
Judged settled(Judged judged) {
  if (judged.is_known()) judged.causes = {};
  return judged;
}

}  // namespace

const Judgement& lesser(const Judgement& a, const Judgement& b) { return is_less(b, a) ? b : a; }
const Judgement& greater(const Judgement& a, const Judgement& b) { return is_less(a, b) ? b : a; }

Judgement opposite(Judgement judgement) {
  judgement.truth = !judgement.truth;
  judgement.margin = -judgement.margin;
  return judgement;
}

Judged certain(bool truth) {
  Judged judged;
  judged.holds = truth;
  judged.worst = judged.best = certain_judgement(truth);
  return judged;
}

Causes operator|(const Causes& a, const Causes& b) {
  return {a.cut || b.cut, a.nan || b.nan, a.missing || b.missing, a.blank || b.blank};
}

Judged unknown(bool holds, const Causes& causes) {
  Judged judged;
  judged.causes = causes;
  judged.holds = holds;
  judged.worst = certain_judgement(false);
  judged.best = certain_judgement(true);
  return judged;
}

Judged both(const Judged& a, const Judged& b) {
  return settled({a.holds && b.holds, lesser(a.worst, b.worst), lesser(a.best, b.best), a.causes | b.causes, a.time});
}

Judged either(const Judged& a, const Judged& b) {
  return settled({a.holds || b.holds, greater(a.worst, b.worst), greater(a.best, b.best), a.causes | b.causes, a.time});
}

Judged negated(const Judged& judged) {
  return {!judged.holds, opposite(judged.best), opposite(judged.worst), judged.causes, judged.time};
}

Judged without_margin(const Judged& judged) {
  return {judged.holds, certain_judgement(judged.worst.truth), certain_judgement(judged.best.truth), judged.causes,
          judged.time};
}

}  // namespace rehearse
