#include "joint_messages.h"

#include <rehearse/messages.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "message_reader.h"

namespace rehearse {
namespace {

struct TrajectoryPoint {
  static constexpr std::string_view type_name = "trajectory_msgs/msg/JointTrajectoryPoint";
  std::vector<double> positions, velocities, effort;
  REHEARSE_FIELDS(positions, velocities, effort)

  bool empty() const { return positions.empty() && velocities.empty() && effort.empty(); }
};

struct Trajectory {
  static constexpr std::string_view type_name = "trajectory_msgs/msg/JointTrajectory";
  std::vector<std::string> joint_names;
  std::vector<TrajectoryPoint> points;
  REHEARSE_FIELDS(joint_names, points)
};

/// With the fields of all versions: desired and actual are called reference and feedback since 2022.
struct ControllerState {
  static constexpr std::string_view type_name = "control_msgs/msg/JointTrajectoryControllerState";
  std::vector<std::string> joint_names;
  TrajectoryPoint desired, actual, reference, feedback, output;
  REHEARSE_FIELDS(joint_names, desired, actual, reference, feedback, output)
};

struct InterfaceValue {
  static constexpr std::string_view type_name = "control_msgs/msg/InterfaceValue";
  std::vector<std::string> interface_names;
  std::vector<double> values;
  REHEARSE_FIELDS(interface_names, values)
};

struct DynamicState {
  static constexpr std::string_view type_name = "control_msgs/msg/DynamicJointState";
  std::vector<std::string> joint_names;
  std::vector<InterfaceValue> interface_values;
  REHEARSE_FIELDS(joint_names, interface_values)
};

void convert(const std::vector<std::string>& names, const TrajectoryPoint& point, msg::JointState& state) {
  state.name = names;
  state.position = point.positions;
  state.velocity = point.velocities;
  state.effort = point.effort;
}

Result<void> convert(const Trajectory& message, JointRole, msg::JointState& state) {
  if (message.points.size() != 1)
    return error(fmt::format("a trajectory of {} points, which states no single set of values", message.points.size()));
  convert(message.joint_names, message.points[0], state);
  return {};
}

Result<void> convert(const ControllerState& message, JointRole role, msg::JointState& state) {
  const auto first = [](std::initializer_list<const TrajectoryPoint*> points) {
    return **std::ranges::find_if(points.begin(), points.end() - 1,
                                  [](const TrajectoryPoint* point) { return !point->empty(); });
  };
  convert(message.joint_names,
          role == JointRole::measured ? first({&message.feedback, &message.actual})
                                      : first({&message.output, &message.reference, &message.desired}),
          state);
  return {};
}

/// The values of one interface, by joint; empty if no joint has it.
std::vector<double> values_of(const DynamicState& message, std::string_view interface) {
  std::vector<double> values(message.joint_names.size(), std::numeric_limits<double>::quiet_NaN());
  bool any = false;
  for (std::size_t joint = 0; joint < values.size(); ++joint) {
    const InterfaceValue& has = message.interface_values[joint];
    for (std::size_t i = 0; i < has.interface_names.size(); ++i) {
      if (has.interface_names[i] != interface) continue;
      values[joint] = has.values[i];
      any = true;
    }
  }
  return any ? values : std::vector<double>();
}

Result<void> convert(const DynamicState& message, JointRole, msg::JointState& state) {
  if (message.interface_values.size() != message.joint_names.size())
    return error(fmt::format("interface values of {} joints, but names of {}", message.interface_values.size(),
                             message.joint_names.size()));
  for (std::size_t joint = 0; joint < message.joint_names.size(); ++joint) {
    const InterfaceValue& has = message.interface_values[joint];
    if (has.values.size() != has.interface_names.size())
      return error(fmt::format("{} values of {} interfaces of joint '{}'", has.values.size(),
                               has.interface_names.size(), message.joint_names[joint]));
  }
  state.name = message.joint_names;
  state.position = values_of(message, "position");
  state.velocity = values_of(message, "velocity");
  state.effort = values_of(message, "effort");
  return {};
}

/// Reads a JointState of the usual layout.
Result<const JointArrays*> read_arrays(JointArrays& arrays, mcap::Bytes payload) {
  if (!arrays.read(payload)) return misfit(payload);
  return &arrays;
}

/// A function that decodes a payload as a Message and converts it to a JointState.
template <class Message>
auto reader_of(const ros2msg::Schema& schema, JointRole role) {
  return [=, reader = std::make_shared<MessageReader<Message>>(schema), state = msg::JointState(),
          arrays = JointArrays()](mcap::Bytes payload) mutable -> Result<const JointArrays*> {
    const Message* message = reader->read(payload);
    if (!message) return misfit(payload);
    if constexpr (std::is_same_v<Message, msg::JointState>) {
      arrays.take(*message);
    } else {
      REHEARSE_TRY(convert(*message, role, state));
      arrays.take(state);
    }
    return &arrays;
  };
}

}  // namespace

JointMessages::JointMessages(const ros2msg::Schema& schema, JointRole role) {
  const auto has = [&schema](std::string_view name) {
    const auto& fields = schema.definitions[0].fields;
    return std::ranges::any_of(fields, [name](const auto& field) { return field.name == name; });
  };
  if (has("joint_names") && has("points")) {
    read_ = reader_of<Trajectory>(schema, role);
  } else if (has("joint_names") && has("interface_values")) {
    read_ = reader_of<DynamicState>(schema, role);
  } else if (has("joint_names")) {
    read_ = reader_of<ControllerState>(schema, role);
  } else if (has_layout_of<msg::JointState>(schema)) {
    read_ = [arrays = JointArrays()](mcap::Bytes payload) mutable { return read_arrays(arrays, payload); };
  } else {
    read_ = reader_of<msg::JointState>(schema, role);
  }
}

}  // namespace rehearse
