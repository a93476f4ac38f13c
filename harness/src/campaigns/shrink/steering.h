// How the cases of a round steer the distributions of the next one. Internal.
#pragma once

#include <rehearse/campaign.h>
#include <rehearse/scenario.h>

#include <cstddef>
#include <vector>

namespace rehearse {

inline constexpr std::size_t least_elite = 4;  // cases that steer a round

/// True for the distributions that a search can steer: uniform, log_uniform and normal, of numbers that aren't whole.
bool can_be_steered(const Variation& variation);

/// The tenth of the cases with the smallest margins, and at least least_elite, the smallest first. If more violate the
/// expectation, all that do: the parameters aren't steered past the boundary of the failure, where most of its
/// probability is. `margins`: by case; NaN: none.
std::vector<std::size_t> elite_of(const std::vector<double>& margins);

/// The distribution of a parameter in the next round. `round`: the distributions of the round; those that it doesn't
/// name are the scenario's own. `elite`: the parameter's values in the cases of elite_of().
///
/// Its mean is 0.9 times that of the elite, and its deviation that of the elite from the mean of the round, as in N.
/// Hansen, A. Ostermeier, Completely Derandomized Self-Adaptation in Evolution Strategies, Evolutionary Computation 9
/// (2001), section 3; the rest is that of the round. So the deviation shrinks only where the elite surrounds the mean,
/// and stays that of the scenario, its largest value, as long as the elite is beside it. The deviation of n values is
/// multiplied by 1 + 1 / sqrt(n), because few values may surround the mean by chance.
SteeredParameter steered_by(const Variation& variation, const std::vector<SteeredParameter>& round,
                            const std::vector<double>& elite);

}  // namespace rehearse
