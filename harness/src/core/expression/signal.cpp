#include "signal.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace rehearse {
namespace {

Judged passed_on(std::deque<Judged>& ready) {
  Judged first = std::move(ready.front());
  ready.pop_front();
  return first;
}

/// What later ticks know of a condition: nothing was true before its span.
Judged remembered(const Judged& judged) {
  Judged known = judged.is_before_span() ? certain(false) : without_margin(judged);
  known.time = judged.time;
  return known;
}

class StateSignal final : public Signal {
 public:
  StateSignal(const Expression& expression, std::size_t part) : expression_(expression), part_(part) {}
  void take(ExpressionSource& source, std::int64_t tick, std::uint64_t time) override {
    Judged& judged = ready.emplace_back(expression_.judged(source, tick, part_));
    judged.time = judged.worst.time = judged.best.time = time;
  }
  void end(std::uint64_t) override {}

 private:
  const Expression& expression_;
  const std::size_t part_;
};

/// A signal of one other signal.
class SignalOfOne : public Signal {
 public:
  explicit SignalOfOne(SignalPtr of) : of_(std::move(of)) {}
  void take(ExpressionSource& source, std::int64_t tick, std::uint64_t time) override {
    of_->take(source, tick, time);
    add_ready();
  }
  void end(std::uint64_t next) override {
    of_->end(next);
    add_ready();
    finish(next);
  }

 private:
  virtual void add(Judged judged) = 0;
  virtual void finish(std::uint64_t) {}
  void add_ready() {
    while (!of_->ready.empty()) add(passed_on(of_->ready));
  }
  SignalPtr of_;
};

class Negation final : public SignalOfOne {
  using SignalOfOne::SignalOfOne;
  void add(Judged judged) override { ready.push_back(negated(judged)); }
};

class Guard final : public SignalOfOne {
  using SignalOfOne::SignalOfOne;
  void add(Judged judged) override { ready.push_back(without_margin(judged)); }
};

class Rise final : public SignalOfOne {
 public:
  Rise(SignalPtr of, const TimeSpan& span, bool& happened)
      : SignalOfOne(std::move(of)), span_(span), happened_(happened) {}

 private:
  void add(Judged now) override {
    ready.push_back(span_.has(now.time) ? both(without_margin(now), negated(before_)) : certain(false));
    ready.back().time = now.time;
    happened_ = happened_ || (ready.back().best.truth && !ready.back().is_before_span());
    before_ = remembered(now);
  }
  const TimeSpan span_;
  bool& happened_;
  Judged before_ = certain(false);
};

class Once final : public SignalOfOne {
  using SignalOfOne::SignalOfOne;
  void add(Judged now) override {
    const std::uint64_t time = now.time;
    ready.push_back(either(before_, now));
    ready.back().time = time;
    before_ = either(before_, remembered(now));
  }
  Judged before_ = certain(false);
};

/// The least or the greatest judgement of a window that moves on: each is dropped when a later one replaces it, so that
/// a judgement is added and removed once.
class Extreme {
 public:
  explicit Extreme(bool is_least) : is_least_(is_least) {}
  void add(const Judgement& judgement, std::uint64_t time) {
    while (!kept_.empty() && replaces(judgement, kept_.back().judgement)) kept_.pop_back();
    kept_.push_back({judgement, time});
  }
  void drop_before(std::uint64_t time) {
    while (!kept_.empty() && kept_.front().time < time) kept_.pop_front();
  }
  const Judgement& value() const { return kept_.front().judgement; }

 private:
  struct Kept {
    Judgement judgement;
    std::uint64_t time = 0;
  };
  /// True if it is beyond the other one; of equal ones the earlier is kept.
  bool replaces(const Judgement& later, const Judgement& earlier) const {
    return &(is_least_ ? lesser(earlier, later) : greater(earlier, later)) == &later;
  }

  const bool is_least_;
  std::deque<Kept> kept_;
};

/// The latest tick with each of the causes.
class LatestCauses {
 public:
  void add(const Judged& judged) {
    const Causes& causes = judged.causes;
    for (const auto& [has, latest] :
         {std::pair{causes.cut, &cut_}, {causes.nan, &nan_}, {causes.missing, &missing_}, {causes.blank, &blank_}})
      if (has) *latest = judged.time;
  }
  Causes from(std::uint64_t time) const { return {cut_ >= time, nan_ >= time, missing_ >= time, blank_ >= time}; }

 private:
  std::optional<std::uint64_t> cut_, nan_, missing_, blank_;  // [ns]; none is less than each time
};

/// The extreme of the worst and of the best judgements of a window.
class WindowExtreme {
 public:
  explicit WindowExtreme(bool is_least) : worst_(is_least), best_(is_least) {}
  void add(const Judged& judged) {
    worst_.add(judged.worst, judged.time);
    best_.add(judged.best, judged.time);
    causes_.add(judged);
  }
  /// The extreme of the judgements from a time on.
  Judged from(std::uint64_t time) {
    worst_.drop_before(time);
    best_.drop_before(time);
    const Judgement& worst = worst_.value();
    Judged judged{worst.truth, worst, best_.value(), causes_.from(time), time};
    if (judged.is_known()) judged.causes = {};
    return judged;
  }

 private:
  Extreme worst_, best_;
  LatestCauses causes_;
};

class FutureWindow final : public SignalOfOne {
 public:
  FutureWindow(SignalPtr of, std::uint64_t duration, bool is_all)
      : SignalOfOne(std::move(of)), length_(duration + window_slack), is_all_(is_all), extreme_(is_all) {}

 private:
  void add(Judged judged) override {
    for (; !waiting_.empty() && waiting_.front() + length_ < judged.time; waiting_.pop_front())
      ready.push_back(extreme_.from(waiting_.front()));
    waiting_.push_back(judged.time);
    extreme_.add(judged);
  }
  void finish(std::uint64_t next) override {
    for (; !waiting_.empty(); waiting_.pop_front()) {
      Judged judged = extreme_.from(waiting_.front());
      if (waiting_.front() + length_ >= next) {
        const std::uint64_t time = judged.time;
        const Judged later = unknown(false, {.cut = true});
        judged = is_all_ ? both(judged, later) : either(judged, later);
        judged.time = time;
      }
      ready.push_back(judged);
    }
  }

  const std::uint64_t length_;
  const bool is_all_;
  WindowExtreme extreme_;
  std::deque<std::uint64_t> waiting_;  // times of the ticks whose window isn't over
};

class PastWindow final : public SignalOfOne {
 public:
  PastWindow(SignalPtr of, std::uint64_t duration)
      : SignalOfOne(std::move(of)), length_(duration + window_slack), extreme_(false) {}

 private:
  void add(Judged judged) override {
    extreme_.add(remembered(judged));
    Judged now = extreme_.from(judged.time > length_ ? judged.time - length_ : 0);
    if (judged.is_before_span()) now = either(now, judged);
    now.time = judged.time;
    ready.push_back(now);
  }

  const std::uint64_t length_;
  WindowExtreme extreme_;
};

class Pair final : public Signal {
 public:
  Pair(SignalPtr a, SignalPtr b, bool is_and) : a_(std::move(a)), b_(std::move(b)), is_and_(is_and) {}
  void take(ExpressionSource& source, std::int64_t tick, std::uint64_t time) override {
    a_->take(source, tick, time);
    b_->take(source, tick, time);
    add_ready();
  }
  void end(std::uint64_t next) override {
    a_->end(next);
    b_->end(next);
    add_ready();
  }

 private:
  void add_ready() {
    while (!a_->ready.empty() && !b_->ready.empty()) {
      const Judged a = passed_on(a_->ready), b = passed_on(b_->ready);
      ready.push_back(is_and_ ? both(a, b) : either(a, b));
    }
  }
  SignalPtr a_, b_;
  const bool is_and_;
};

SignalPtr signal_of_part(const Expression& expression, std::size_t index) {
  using Kind = Expression::Part::Kind;
  const Expression::Part part = expression.part(index);
  const auto left = [&] { return signal_of_part(expression, part.left); };
  const auto right = [&] { return signal_of_part(expression, part.right); };
  switch (part.kind) {
    case Kind::negation: return negation_of(left());
    case Kind::conjunction: return conjunction_of(left(), right());
    case Kind::disjunction: return disjunction_of(left(), right());
    case Kind::lasting: return lasting_of(left(), static_cast<std::uint64_t>(std::llround(part.duration * 1e9)));
    case Kind::instant: break;
  }
  return std::make_unique<StateSignal>(expression, index);
}

}  // namespace

SignalPtr signal_of(const Expression& expression) { return signal_of_part(expression, expression.root()); }
SignalPtr negation_of(SignalPtr of) { return std::make_unique<Negation>(std::move(of)); }
SignalPtr guard_of(SignalPtr of) { return std::make_unique<Guard>(std::move(of)); }
SignalPtr rise_of(SignalPtr of, const TimeSpan& span, bool& happened) {
  return std::make_unique<Rise>(std::move(of), span, happened);
}
SignalPtr once_of(SignalPtr of) { return std::make_unique<Once>(std::move(of)); }

SignalPtr conjunction_of(SignalPtr a, SignalPtr b) { return std::make_unique<Pair>(std::move(a), std::move(b), true); }

SignalPtr disjunction_of(SignalPtr a, SignalPtr b) { return std::make_unique<Pair>(std::move(a), std::move(b), false); }

SignalPtr lasting_of(SignalPtr of, std::uint64_t duration) {
  return std::make_unique<FutureWindow>(std::move(of), duration, true);
}

SignalPtr coming_of(SignalPtr of, std::uint64_t duration) {
  return std::make_unique<FutureWindow>(std::move(of), duration, false);
}

SignalPtr recent_of(SignalPtr of, std::uint64_t duration) {
  return std::make_unique<PastWindow>(std::move(of), duration);
}

}  // namespace rehearse
