// CommandRanges: the usual range of each number that a log's controller commanded, which gives its default tolerance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// The command of a message for a joint.
struct CommandedJoint {
  std::optional<double> q, dq, u;
};
using CommandedJoints = std::vector<CommandedJoint>;  // by joint id

/// True if all numbers of a message are exactly 0.
bool are_zero(const CommandedJoints& joints);

/// A number that the controllers command.
struct CommandColumn {
  std::string name;  // joint and quantity, as PAN/u
  std::string unit;
  double range = 0.0;
};

/// The step of which all numbers are multiples; 0: there is none, or fewer than 50 values differ, 5 if the
/// step is 1, 2, 2.5 or 5 times a power of ten. `rising`: in order.
double step_of(const std::vector<double>& rising);

class CommandRanges {
 public:
  /// Counts a message. True: it is one of those from which ranges are taken; they are evenly distributed over the log.
  bool takes_next();
  void add(CommandedJoints joints);

  /// Half a step of each number is a part of its tolerance.
  void tolerate_steps() { tolerates_steps_ = true; }
  /// The default tolerance of a number: 1e-4 of the range between the 1st and the 99th of a hundred commands; at least
  /// 1e-6 of the largest magnitude, for numbers of single precision, a thousandth of the default of its unit, and half
  /// a step.
  double tolerance(int joint, std::optional<double> CommandedJoint::*part, std::string_view unit) const;
  /// True if the log has the number.
  bool has(int joint, std::optional<double> CommandedJoint::*part) const { return !numbers(joint, part).empty(); }
  /// The step of which all numbers are multiples, as those of a bus with 16 bits; 0: there is none, or the numbers have
  /// so few values that a controller may command them itself [the unit of the number].
  double step(int joint, std::optional<double> CommandedJoint::*part) const;
  /// True if any number has a step.
  bool has_steps() const;
  /// The magnitude that the numbers reach again and again, and never exceed, as where they are clipped; 0: none.
  double limit(int joint, std::optional<double> CommandedJoint::*part) const;
  /// True if in some messages all numbers are 0, and in others not.
  bool has_zeros() const;
  /// The range [the unit of the number].
  double range(int joint, std::optional<double> CommandedJoint::*part) const;

 private:
  /// The numbers that are finite, rising.
  std::vector<double> numbers(int joint, std::optional<double> CommandedJoint::*part) const;

  static constexpr std::size_t most = 2048;
  std::int64_t messages_ = 0, stride_ = 1;
  bool tolerates_steps_ = false;
  std::vector<CommandedJoints> samples_;
};

}  // namespace rehearse
