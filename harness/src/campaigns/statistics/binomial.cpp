#include "binomial.h"

#include <boost/math/special_functions/beta.hpp>

namespace rehearse {

double binomial_at_least(double successes, double attempts, double probability) {
  if (successes <= 0.0) return 1.0;
  return successes > attempts ? 0.0 : boost::math::ibeta(successes, attempts - successes + 1.0, probability);
}

double binomial_at_most(double successes, double attempts, double probability) {
  if (successes >= attempts) return 1.0;
  return successes < 0.0 ? 0.0 : boost::math::ibetac(successes + 1.0, attempts - successes, probability);
}

double binomial_lower_bound(double successes, double attempts, double tail) {
  return boost::math::ibeta_inv(successes, attempts - successes + 1.0, tail);
}

double binomial_upper_bound(double successes, double attempts, double tail) {
  return boost::math::ibetac_inv(successes + 1.0, attempts - successes, tail);
}

}  // namespace rehearse
