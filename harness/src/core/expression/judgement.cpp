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

Judged unknown(bool holds) {
  Judged judged;
  judged.holds = holds;
  judged.worst = certain_judgement(false);
  judged.best = certain_judgement(true);
  return judged;
}

Judged both(const Judged& a, const Judged& b) {
  return {a.holds && b.holds, lesser(a.worst, b.worst), lesser(a.best, b.best), a.is_cut || b.is_cut, a.time};
}

Judged either(const Judged& a, const Judged& b) {
  return {a.holds || b.holds, greater(a.worst, b.worst), greater(a.best, b.best), a.is_cut || b.is_cut, a.time};
}

Judged negated(const Judged& judged) {
  return {!judged.holds, opposite(judged.best), opposite(judged.worst), judged.is_cut, judged.time};
}

Judged without_margin(const Judged& judged) {
  return {judged.holds, certain_judgement(judged.worst.truth), certain_judgement(judged.best.truth), judged.is_cut,
          judged.time};
}

}  // namespace rehearse
