#include "command_ranges.h"

#include <rehearse/scenario.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rehearse {

bool CommandRanges::takes_next() { return messages_++ % stride_ == 0; }

void CommandRanges::add(CommandedJoints joints) {
  samples_.push_back(std::move(joints));
  if (samples_.size() < most) return;
  for (std::size_t i = 1; 2 * i < samples_.size(); ++i) samples_[i] = std::move(samples_[2 * i]);
  samples_.resize((samples_.size() + 1) / 2);
  stride_ *= 2;
}

std::vector<double> CommandRanges::numbers(int joint, std::optional<double> CommandedJoint::*part) const {
  std::vector<double> found;
  for (const CommandedJoints& sample : samples_)
    if (const auto& number = sample[static_cast<std::size_t>(joint)].*part; number && std::isfinite(*number))
      found.push_back(*number);
  std::ranges::stable_sort(found);
  return found;
}

namespace {

/// Between the 1st and the 99th of a hundred.
double range_of(const std::vector<double>& rising) {
  if (rising.empty()) return 0.0;
  const std::size_t left_out = rising.size() / 100;
  return rising[rising.size() - 1 - left_out] - rising[left_out];
}

}  // namespace

double CommandRanges::range(int joint, std::optional<double> CommandedJoint::*part) const {
  return range_of(numbers(joint, part));
}

double CommandRanges::tolerance(int joint, std::optional<double> CommandedJoint::*part, std::string_view unit) const {
  constexpr double share_of_range = 1e-4, share_of_largest = 1e-6, share_of_unit = 1e-3;
  const std::vector<double> rising = numbers(joint, part);
  const double largest = rising.empty() ? 0.0 : std::max(std::abs(rising.front()), std::abs(rising.back()));
  return std::max(
      {share_of_range * range_of(rising), share_of_largest * largest, share_of_unit * default_tolerance(unit).atol});
}

}  // namespace rehearse
