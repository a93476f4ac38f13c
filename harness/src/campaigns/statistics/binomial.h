// Probabilities of the binomial distribution. Internal.
#pragma once

namespace rehearse {

// The numbers of attempts and successes may lie between whole numbers, as those of a share do; the probabilities are
// then the incomplete beta functions that equal them at whole ones.

/// The probability of at least so many successes.
double binomial_at_least(double successes, double attempts, double probability);
/// The probability of at most so many successes.
double binomial_at_most(double successes, double attempts, double probability);

/// The probability of a success at which at least so many successes, above 0, have the probability `tail`.
double binomial_lower_bound(double successes, double attempts, double tail);
/// The probability of a success at which at most so many successes, below the attempts, have the probability `tail`.
double binomial_upper_bound(double successes, double attempts, double tail);

}  // namespace rehearse
