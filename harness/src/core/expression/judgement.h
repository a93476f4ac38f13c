// Judgement: the truth of a condition at a tick, and its margin: the robustness of signal temporal logic.
//
// The margin of a comparison is the distance from its bound, positive if it is true: b - a for a < b and a <= b,
// -|a - b| for a == b, |a - b| for a != b. It is the lesser one for &&, the greater one for ||, and changes its sign
// with !. A condition that compares no numbers has the margin infinity, or -infinity if it is false.
// Source: A. Donzé, O. Maler, Robust satisfaction of temporal logic over real-valued signals, 2010; the interval of the
// margin if data are missing: J. Deshmukh et al., Robust online monitoring of signal temporal logic, 2017.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

namespace rehearse {

struct Judgement {
  static constexpr std::size_t nothing = std::numeric_limits<std::size_t>::max();

  bool truth = false;
  double margin = -std::numeric_limits<double>::infinity();  // above 0: true; below 0: false; 0: either
  double value = 0.0, bound = 0.0;                           // the two sides of the comparison with this margin
  std::size_t comparison = nothing;                          // its node; nothing: no numbers were compared
  std::uint64_t time = 0;                                    // of its tick [ns]; set by signals
};

/// The lesser and the greater of two margins; of equal ones the false and the true one, else the first.
const Judgement& lesser(const Judgement& a, const Judgement& b);
const Judgement& greater(const Judgement& a, const Judgement& b);
Judgement opposite(Judgement judgement);

/// Why a condition isn't known at a tick.
struct Causes {
  bool cut = false;      // it depends on ticks after the end of the run
  bool nan = false;      // a number is NaN
  bool missing = false;  // a series has no sample up to the tick, or there is no tick before it
  bool blank = false;    // beside `missing`: that series had messages, and NaN in each of them
};

/// A condition at a tick. If data are missing, it is between the worst and the best judgement.
struct Judged {
  bool holds = false;  // as in C: a comparison with NaN is false, except !=
  Judgement worst, best;
  Causes causes;           // none if it is known
  std::uint64_t time = 0;  // of the tick [ns]; set by signals

  bool is_known() const { return worst.truth == best.truth; }
  /// True if the tick lies before the span of the condition, which begins with the first samples of its series.
  bool is_before_span() const { return !is_known() && causes.missing && !causes.nan && !causes.cut; }
};

/// Compares nothing; the margin is infinite.
Judged certain(bool truth);
/// Neither true nor false, because of these causes.
Judged unknown(bool holds, const Causes& causes);
/// The causes of either.
Causes operator|(const Causes& a, const Causes& b);
Judged both(const Judged& a, const Judged& b);
Judged either(const Judged& a, const Judged& b);
Judged negated(const Judged& judged);
/// The same truth without a margin.
Judged without_margin(const Judged& judged);

}  // namespace rehearse
