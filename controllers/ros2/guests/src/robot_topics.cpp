#include "robot_topics.h"

#include <algorithm>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/msg/joint_state.hpp>

namespace rehearse::ros2 {
namespace {

namespace introspection = rosidl_typesupport_introspection_cpp;
using rehearse_ros2::field_named;
using rehearse_ros2::MessageMember;
using rehearse_ros2::MessageMembers;
using sensor_msgs::msg::JointState;

int checked(rehearse_io* io, int code, const TopicBinding& binding) {
  if (code < 0) throw mistake(binding.place, rehearse_error(io));
  return code;
}

struct NamedHandle {
  std::string name;
  int handle;
};

std::vector<NamedHandle> joints_of(const TopicBinding& binding, rehearse_io* io) {
  std::vector<NamedHandle> joints;
  for (const std::string& name : binding.names)
    joints.push_back({name, checked(io, rehearse_joint(io, name.c_str()), binding)});
  for (int id = 0; binding.names.empty() && id < rehearse_joint_count(io); ++id) {
    const int joint = rehearse_joint_of_id(io, id);
    if (joint >= 0) joints.push_back({rehearse_joint_name(io, joint), joint});
  }
  return joints;
}

class JointStates final : public RobotSource {
 public:
  JointStates(const TopicBinding& binding, rehearse_io* io, rclcpp::Node& robot)
      : io_(io),
        clock_(robot.get_clock()),
        publisher_(robot.create_publisher<JointState>(binding.topic, rclcpp::SystemDefaultsQoS())),
        joints_(joints_of(binding, io)) {
    for (const NamedHandle& joint : joints_) {
      checked(io, rehearse_read(io, joint.handle, REHEARSE_Q | REHEARSE_DQ | REHEARSE_U), binding);
      message_.name.push_back(joint.name);
    }
    for (auto* values : {&message_.position, &message_.velocity, &message_.effort}) values->resize(joints_.size());
  }
  void publish() override {
    message_.header.stamp = clock_->now();
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      message_.position[i] = rehearse_get(io_, joints_[i].handle, REHEARSE_Q);
      message_.velocity[i] = rehearse_get(io_, joints_[i].handle, REHEARSE_DQ);
      message_.effort[i] = rehearse_get(io_, joints_[i].handle, REHEARSE_U);
    }
    publisher_->publish(message_);
  }

 private:
  rehearse_io* io_;
  rclcpp::Clock::SharedPtr clock_;
  rclcpp::Publisher<JointState>::SharedPtr publisher_;
  std::vector<NamedHandle> joints_;
  JointState message_;
};

class Imu final : public RobotSource {
 public:
  Imu(const TopicBinding& binding, rehearse_io* io, rclcpp::Node& robot)
      : io_(io),
        clock_(robot.get_clock()),
        publisher_(robot.create_publisher<sensor_msgs::msg::Imu>(binding.topic, rclcpp::SensorDataQoS())) {
    for (const std::string& name : binding.names) {
      const int device = checked(io, rehearse_device(io, name.c_str()), binding);
      const std::string type = rehearse_device_type(io, device);
      const bool is_gyro = type == "RateGyroSensor", is_both = type == "Imu";
      if (!is_gyro && !is_both && type != "AccelerationSensor")
        throw mistake(binding.place, "device '" + name + "' is a " + type + ", no part of an IMU");
      checked(io, rehearse_read_device(io, device), binding);
      if (is_gyro || is_both) gyro_ = device;
      if (!is_gyro) accelerometer_ = device;
      is_both_ |= is_both;
    }
    message_.header.frame_id = binding.names.front();
    message_.orientation_covariance[0] = -1.0;  // no orientation, as the definition of the message states
  }
  void publish() override {
    message_.header.stamp = clock_->now();
    double numbers[6] = {};
    if (is_both_) {
      // The numbers of an IMU: the acceleration, then the angular velocity.
      rehearse_device_numbers(io_, gyro_, numbers, 6);
    } else {
      if (accelerometer_ >= 0) rehearse_device_numbers(io_, accelerometer_, numbers, 3);
      if (gyro_ >= 0) rehearse_device_numbers(io_, gyro_, numbers + 3, 3);
    }
    message_.angular_velocity.x = numbers[3];
    message_.angular_velocity.y = numbers[4];
    message_.angular_velocity.z = numbers[5];
    message_.linear_acceleration.x = numbers[0];
    message_.linear_acceleration.y = numbers[1];
    message_.linear_acceleration.z = numbers[2];
    publisher_->publish(message_);
  }

 private:
  rehearse_io* io_;
  rclcpp::Clock::SharedPtr clock_;
  rclcpp::Publisher<sensor_msgs::msg::Imu>::SharedPtr publisher_;
  int gyro_ = -1, accelerometer_ = -1;
  bool is_both_ = false;
  sensor_msgs::msg::Imu message_;
};

}  // namespace

struct CommandRow {
  TopicBinding::Part part;
  int quantity;
  const char* field;  // of a JointState
  std::vector<double> JointState::*values;
};

namespace {

constexpr CommandRow commands[] = {
    {TopicBinding::Part::efforts, REHEARSE_U, "effort", &JointState::effort},
    {TopicBinding::Part::velocities, REHEARSE_DQ, "velocity", &JointState::velocity},
    {TopicBinding::Part::positions, REHEARSE_Q, "position", &JointState::position},
};

const CommandRow& command_of(TopicBinding::Part part) {
  return *std::find_if(std::begin(commands), std::end(commands),
                       [&](const CommandRow& row) { return row.part == part; });
}

}  // namespace

std::unique_ptr<RobotSource> make_source(const TopicBinding& binding, rehearse_io* io, rclcpp::Node& robot) {
  switch (binding.part) {
    case TopicBinding::Part::joint_states: return std::make_unique<JointStates>(binding, io, robot);
    case TopicBinding::Part::imu: return std::make_unique<Imu>(binding, io, robot);
    default: return nullptr;
  }
}

RobotSink::RobotSink(const TopicBinding& binding, rehearse_io* io)
    : binding_(binding), io_(io), row_(command_of(binding.part)) {
  for (const NamedHandle& joint : joints_of(binding, io)) {
    checked(io, rehearse_command(io, joint.handle, row_.quantity), binding);
    joints_.push_back({joint.name, joint.handle});
  }
}

void RobotSink::connect() {
  if (endpoint_) return;
  const MessageMembers* type = rehearse_ros2::Topics::instance().type_of(binding_.topic);
  if (type == nullptr) return;
  const MessageMember* data = field_named(*type, "data");
  const bool has_numbers = data != nullptr && data->type_id_ == introspection::ROS_TYPE_DOUBLE;
  if (!has_numbers && rehearse_ros2::type_name_of(*type) != "sensor_msgs/msg/JointState")
    throw mistake(binding_.place, "the topic '" + binding_.topic + "' has the type " +
                                      rehearse_ros2::type_name_of(*type) +
                                      "; commands are std_msgs/msg/Float64MultiArray, std_msgs/msg/Float64 or "
                                      "sensor_msgs/msg/JointState");
  endpoint_ = std::make_shared<rehearse_ros2::Endpoint>(binding_.topic, *type, rclcpp::QoS(1).best_effort());
  rehearse_ros2::Topics::instance().add_subscription(endpoint_);
}

void RobotSink::command() {
  connect();
  if (!endpoint_) return;
  rehearse_ros2::Delivery delivery;
  {
    const rehearse_ros2::BusLock lock(rehearse_ros2::Bus::instance().mutex);
    if (!endpoint_->take(delivery)) return;
  }
  const void* const message = delivery.message.get();
  if (const MessageMember* data = field_named(endpoint_->type, "data")) {
    const void* const place = rehearse_ros2::place_of(message, *data);
    if (!data->is_array_) return set(joints_.at(0), *static_cast<const double*>(place));
    const std::size_t count = rehearse_ros2::count_of(place, *data);
    if (count != joints_.size())
      throw std::runtime_error("a message on '" + binding_.topic + "' has " + std::to_string(count) + " numbers for " +
                               std::to_string(joints_.size()) + " joints");
    for (std::size_t i = 0; i < count; ++i)
      set(joints_[i], *static_cast<const double*>(data->get_const_function(place, i)));
    return;
  }
  const auto& state = *static_cast<const JointState*>(message);
  const std::vector<double>& values = state.*row_.values;
  if (values.size() != state.name.size())
    throw std::runtime_error("a message on '" + binding_.topic + "' has " + std::to_string(state.name.size()) +
                             " names and " + std::to_string(values.size()) + " values of " + row_.field);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto joint =
        std::find_if(joints_.begin(), joints_.end(), [&](const Joint& known) { return known.name == state.name[i]; });
    if (joint == joints_.end())
      throw std::runtime_error("a message on '" + binding_.topic + "' commands '" + state.name[i] +
                               "', which is no joint of this topic");
    set(*joint, values[i]);
  }
}

void RobotSink::set(const Joint& joint, double value) {
  if (rehearse_set(io_, joint.handle, row_.quantity, value) < 0) throw std::runtime_error(rehearse_error(io_));
}

}  // namespace rehearse::ros2
