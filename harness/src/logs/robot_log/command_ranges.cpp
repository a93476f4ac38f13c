#include "command_ranges.h"

#include <rehearse/scenario.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace rehearse {

bool are_zero(const CommandedJoints& joints) {
  return std::ranges::all_of(joints, [](const CommandedJoint& joint) {
    return joint.q.value_or(0.0) == 0.0 && joint.dq.value_or(0.0) == 0.0 && joint.u.value_or(0.0) == 0.0;
  });
}

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

/// True if the number is 1, 2, 2.5 or 5 times a power of ten.
bool is_round(double number) {
  const double digit = number / std::pow(10.0, std::floor(std::log10(number)));
  return std::ranges::any_of(std::array{1.0, 2.0, 2.5, 5.0, 10.0},
                             [digit](double one) { return std::abs(digit - one) < 1e-6 * one; });
}

/// Between the 1st and the 99th of a hundred.
double range_of(const std::vector<double>& rising) {
  if (rising.empty()) return 0.0;
  const std::size_t left_out = rising.size() / 100;
  return rising[rising.size() - 1 - left_out] - rising[left_out];
}

}  // namespace

double step_of(const std::vector<double>& rising) {
  constexpr int fewest_values = 50, fewest_of_round_step = 5, most_parts = 8;
  constexpr double rounding = 1e-3;  // [steps]
  if (rising.size() < fewest_of_round_step) return 0.0;
  const double largest = std::max(std::abs(rising.front()), std::abs(rising.back()));
  double least = 0.0;  // difference of two neighbours
  int values = 1;
  for (std::size_t i = 1; i < rising.size(); ++i) {
    const double difference = rising[i] - rising[i - 1];
    if (difference <= 1e-9 * largest) continue;
    ++values;
    if (least == 0.0 || difference < least) least = difference;
  }
  if (values < fewest_of_round_step) return 0.0;
  const auto off = [](double number, double step) { return std::abs(number / step - std::round(number / step)); };
  for (int parts = 1; parts <= most_parts; ++parts) {
    double step = least / parts;
    // The error of the step grows with the multiple; the largest number that still fits gives it more exactly.
    for (std::size_t i = 0; i < rising.size(); ++i)
      if (std::abs(rising[i]) > step && off(rising[i], step) < 0.1) step = rising[i] / std::round(rising[i] / step);
    if (std::ranges::all_of(rising, [&](double number) { return off(number, step) < rounding; }))
      return values >= fewest_values || is_round(step) ? step : 0.0;
  }
  return 0.0;
}

double CommandRanges::step(int joint, std::optional<double> CommandedJoint::*part) const {
  return step_of(numbers(joint, part));
}

bool CommandRanges::has_steps() const {
  const std::size_t joints = samples_.empty() ? 0 : samples_[0].size();
  for (int joint = 0; joint < static_cast<int>(joints); ++joint)
    for (const auto part : {&CommandedJoint::q, &CommandedJoint::dq, &CommandedJoint::u})
      if (step(joint, part) > 0.0) return true;
  return false;
}

double CommandRanges::limit(int joint, std::optional<double> CommandedJoint::*part) const {
  constexpr std::ptrdiff_t fewest = 3;
  const std::vector<double> rising = numbers(joint, part);
  if (rising.empty()) return 0.0;
  const double largest = std::max(std::abs(rising.front()), std::abs(rising.back()));
  const auto reach = std::ranges::count_if(rising, [&](double number) { return std::abs(number) == largest; });
  const bool is_always = reach == std::ssize(rising);
  return reach >= fewest && !is_always ? largest : 0.0;
}

bool CommandRanges::has_zeros() const {
  return std::ranges::any_of(samples_, are_zero) && !std::ranges::all_of(samples_, are_zero);
}

double CommandRanges::range(int joint, std::optional<double> CommandedJoint::*part) const {
  return range_of(numbers(joint, part));
}

double CommandRanges::tolerance(int joint, std::optional<double> CommandedJoint::*part, std::string_view unit) const {
  constexpr double share_of_range = 1e-4, share_of_largest = 1e-6, share_of_unit = 1e-3;
  constexpr double rounding = 1e-6;  // of numbers that are a little off a multiple
  const std::vector<double> rising = numbers(joint, part);
  const double largest = rising.empty() ? 0.0 : std::max(std::abs(rising.front()), std::abs(rising.back()));
  return std::max({tolerates_steps_ ? 0.5 * (1.0 + rounding) * step_of(rising) : 0.0, share_of_range * range_of(rising),
                   share_of_largest * largest, share_of_unit * default_tolerance(unit).atol});
}

}  // namespace rehearse
