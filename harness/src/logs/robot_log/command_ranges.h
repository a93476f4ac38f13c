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

/// A number that the controllers command.
struct CommandColumn {
  std::string name;  // joint and quantity, as PAN/u
  std::string unit;
  double range = 0.0;
};

class CommandRanges {
 public:
  /// Counts a message. True: it is one of those from which ranges are taken; they are evenly distributed over the log.
  bool takes_next();
  void add(CommandedJoints joints);

  /// The default tolerance of a number: 1e-4 of the range between the 1st and the 99th of a hundred commands; at least
  /// 1e-6 of the largest magnitude, for numbers of single precision, and a thousandth of the default of its unit.
  double tolerance(int joint, std::optional<double> CommandedJoint::*part, std::string_view unit) const;
  /// True if the log has the number.
  bool has(int joint, std::optional<double> CommandedJoint::*part) const { return !numbers(joint, part).empty(); }
  /// The range [the unit of the number].
  double range(int joint, std::optional<double> CommandedJoint::*part) const;

 private:
  /// The numbers that are finite, rising.
  std::vector<double> numbers(int joint, std::optional<double> CommandedJoint::*part) const;

  static constexpr std::size_t most = 2048;
  std::int64_t messages_ = 0, stride_ = 1;
  std::vector<CommandedJoints> samples_;
};

}  // namespace rehearse
