#include "channel_findings.h"

#include <cmath>
#include <limits>

#include "divergence_text.h"
#include "series_rules.h"

namespace rehearse {

bool ChannelFindings::count(double difference, double tolerance, bool beyond) {
  ++result_.differing;
  if (beyond) ++result_.beyond;
  const double times = times_tolerance(difference, tolerance);
  // a difference of NaN (a number against NaN) fails these comparisons, so it is the worst
  const bool worse = !(times <= worst_times_) || (times == worst_times_ && !(difference <= worst_difference_));
  return worse || !result_.first_bit || (beyond && !result_.first);
}

void ChannelFindings::describe(const Divergence& divergence, bool beyond) {
  mark(divergence);
  if (beyond && (!result_.first || comes_before(divergence, *result_.first))) result_.first = divergence;
  const double times = times_tolerance(divergence.judged(), divergence.tolerance);
  if (times < worst_times_ || (times == worst_times_ && divergence.judged() <= worst_difference_)) return;
  const auto or_infinite = [](double value) {
    return std::isnan(value) ? std::numeric_limits<double>::infinity() : value;
  };
  worst_times_ = or_infinite(times);
  worst_difference_ = or_infinite(divergence.judged());
  result_.worst = divergence;
}

void ChannelFindings::structure(const Divergence& divergence) {
  if (!result_.first || comes_before(divergence, *result_.first)) result_.first = divergence;
  mark(divergence);
}

void ChannelFindings::structure_before(const Divergence& divergence) {
  for (std::optional<Divergence>* place : {&result_.first, &result_.first_bit})
    if (!*place || !comes_before(**place, divergence)) *place = divergence;
}

void ChannelFindings::mark(const Divergence& divergence) {
  if (!result_.first_bit || comes_before(divergence, *result_.first_bit)) result_.first_bit = divergence;
}

}  // namespace rehearse
