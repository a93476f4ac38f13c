// The test of a history for drift. Internal.
#pragma once

#include <vector>

namespace rehearse {

/// The probability that a history with these changes falls as steadily as this one, or more, if each change shrinks the
/// margin as probably as it grows it, independently of the others. Steadiness is the correlation of the margin with the
/// number of the commit. Commits without a change keep their places, and have no sign.
///
/// This is R. A. Fisher's randomization test over the signs of the changes (The Design of Experiments, 1935, section
/// 21), one-sided. It assumes nothing about the sizes of the changes, and is exact for a random walk. Independent
/// margins, levels that last for several commits, and autoregressive ones return to their mean: their changes alternate
/// more often than independent ones, and the test finds fewer of them than it states. It doesn't hold if a change makes
/// the next one of its sign more probable.
///
/// All signs are counted up to 14 changes, and beyond that 16,383 that a hash draws beside those observed:
/// M. Dwass, Modified Randomization Tests for Nonparametric Hypotheses, Annals of Mathematical Statistics 28 (1957).
/// 1 for fewer than two values, or if all are equal.
double chance_of_fall(const std::vector<double>& values);

}  // namespace rehearse
