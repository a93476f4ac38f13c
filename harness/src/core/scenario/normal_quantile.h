// Quantiles of the normal distribution.
#pragma once

namespace rehearse {

/// The number of the standard normal distribution below which a share of `probability`, above 0 and below 1, lies.
/// M. J. Wichura, Algorithm AS 241: The Percentage Points of the Normal Distribution, Applied Statistics 37 (1988),
/// pp. 477-484, routine PPND16: about 16 digits.
double normal_quantile(double probability);

}  // namespace rehearse
