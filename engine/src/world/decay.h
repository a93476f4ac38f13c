// exp(-x), with the same bits on every processor.
#pragma once

namespace rehearse {

/// exp(-x) for x >= 0, without the functions of libm, whose last bits depend on the processor.
inline double decay(double x) {
  constexpr int halvings = 10, terms = 10;
  constexpr double longest = 700.0;
  if (x > longest) return 0.0;
  const double part = -x / (1 << halvings);
  double sum = 1.0;
  for (int term = terms; term > 0; --term) sum = 1.0 + part / term * sum;
  for (int i = 0; i < halvings; ++i) sum *= sum;
  return sum;
}

}  // namespace rehearse
