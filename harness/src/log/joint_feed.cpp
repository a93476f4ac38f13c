// Feeds for joints, the root link and the joystick from a log.
#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "log_feed.h"
#include "log_track.h"
#include "message_reader.h"

namespace rehearse {
namespace {

constexpr double unknown_number = std::numeric_limits<double>::quiet_NaN();

std::int64_t nanoseconds(std::optional<double> seconds) {
  return seconds ? std::llround(*seconds * 1e9) : std::numeric_limits<std::int64_t>::max();
}

/// Interpolates between two samples, unless they are further apart than the allowed age.
template <std::size_t N>
std::optional<typename LogTrack<N>::Span> span_at(LogTrack<N>& track, std::int64_t time, const LogSource& source) {
  auto span = track.at(time, source.sampling == Sampling::interpolate);
  if (span && span->after && span->after->time - span->before->time > nanoseconds(source.max_age))
    span->after = nullptr;
  return span;
}

/// The difference of two angles, at most half a turn [rad].
double shorter_way(double from, double to) { return std::remainder(to - from, 2.0 * std::numbers::pi); }

class JointFeed : public LogFeed {
 public:
  JointFeed(const JointSource& source, const Model& model, const ros2msg::Schema& schema)
      : source_(source), model_(model), reader_(schema), names_(source.names, model), tracks_(model.joints.size()) {}

  bool take(std::int64_t time, mcap::Bytes payload) override {
    const msg::JointState* state = reader_.read(payload);
    if (!state) return false;
    const std::size_t count = state->name.size();
    const auto fits = [count](const std::vector<double>& values) { return values.empty() || values.size() == count; };
    if (!fits(state->position) || !fits(state->velocity) || !fits(state->effort)) return false;
    const std::vector<JointRename>& joints = names_.find(state->name);
    for (std::size_t i = 0; i < count; ++i)
      if (joints[i].joint >= 0) take_joint(time, joints[i], *state, i);
    return true;
  }

  Result<void> look(const LogMoment& moment, Observation& seen) override {
    for (std::size_t joint = 0; joint < tracks_.size(); ++joint) {
      const auto span = span_at(tracks_[joint], moment.time, source_);
      if (!span) continue;
      std::array<double, 3> values = span->before->values;
      if (span->after) {
        const bool turns = model_.links[model_.joints[joint]].joint.type == JointType::continuous;
        const double to = turns ? values[0] + shorter_way(values[0], span->after->values[0]) : span->after->values[0];
        values = {mix(values[0], to, span->fraction), mix(values[1], span->after->values[1], span->fraction),
                  mix(values[2], span->after->values[2], span->fraction)};
      }
      JointReading& reading = seen.bodies[0].joints[joint];
      if (!std::isnan(values[0])) reading.q = values[0];
      if (!std::isnan(values[1])) reading.dq = values[1];
      if (!std::isnan(values[2])) reading.u = values[2];
    }
    return {};
  }

 private:
  void take_joint(std::int64_t time, const JointRename& joint, const msg::JointState& state, std::size_t index) {
    LogTrack<3>& track = tracks_[joint.joint];
    const auto* before = track.newest();
    std::array<double, 3> values =
        before ? before->values : std::array<double, 3>{unknown_number, unknown_number, unknown_number};
    if (!state.position.empty()) {
      values[0] = state.position[index] * joint.scale;
      if (joint.offset != 0.0) values[0] += joint.offset;  // adding 0 would change -0 to 0
    }
    if (!state.effort.empty()) values[2] = state.effort[index] / joint.scale;
    if (source_.differentiate) {
      values[1] = before && before->time < time ? slope(joint.joint, *before, time, values[0])
                  : before                      ? values[1]
                                                : 0.0;
    } else if (!state.velocity.empty()) {
      values[1] = state.velocity[index] * joint.scale;
    }
    track.add(time, values);
  }

  double slope(int joint, const LogTrack<3>::Sample& before, std::int64_t time, double q) const {
    const bool turns = model_.links[model_.joints[joint]].joint.type == JointType::continuous;
    const double way = turns ? shorter_way(before.values[0], q) : q - before.values[0];
    return way / (static_cast<double>(time - before.time) * 1e-9);
  }

  const JointSource& source_;
  const Model& model_;
  MessageReader<msg::JointState> reader_;
  JointNames names_;
  std::vector<LogTrack<3>> tracks_;  // by joint id: q, dq, u; NaN: no value yet
};

/// Both types of messages with the root link's pose. A field that the schema lacks stays 0.
struct PoseOnly {
  static constexpr std::string_view type_name = "geometry_msgs/msg/PoseStamped";
  msg::Pose pose;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("pose", self.pose);
  }
};

struct PoseWithCovariance {
  static constexpr std::string_view type_name = "geometry_msgs/msg/PoseWithCovariance";
  msg::Pose pose;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("pose", self.pose);
  }
};

struct TwistWithCovariance {
  static constexpr std::string_view type_name = "geometry_msgs/msg/TwistWithCovariance";
  msg::Twist twist;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("twist", self.twist);
  }
};

struct Odometry {
  static constexpr std::string_view type_name = "nav_msgs/msg/Odometry";
  PoseWithCovariance pose;
  TwistWithCovariance twist;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("pose", self.pose);
    visit("twist", self.twist);
  }
};

class RootFeed : public LogFeed {
 public:
  RootFeed(const RootSource& source, const ros2msg::Schema& schema)
      : source_(source), pose_(schema), odometry_(schema) {}

  bool take(std::int64_t time, mcap::Bytes payload) override {
    msg::Pose pose;
    msg::Twist twist;
    if (source_.has_covariance) {
      const Odometry* message = odometry_.read(payload);
      if (!message) return false;
      pose = message->pose.pose;
      twist = message->twist.twist;
    } else {
      const PoseOnly* message = pose_.read(payload);
      if (!message) return false;
      pose = message->pose;
    }
    const auto& [p, r] = pose;
    const double norm = std::sqrt(r.x * r.x + r.y * r.y + r.z * r.z + r.w * r.w);
    if (!(norm > 0.5 && norm < 2.0)) return false;  // no valid orientation
    track_.add(time, {p.x, p.y, p.z, r.x, r.y, r.z, r.w, twist.linear.x, twist.linear.y, twist.linear.z,
                      twist.angular.x, twist.angular.y, twist.angular.z});
    return true;
  }

  Result<void> look(const LogMoment& moment, Observation& seen) override {
    const auto span = span_at(track_, moment.time, source_);
    if (!span) return {};
    std::array<double, 13> values = span->before->values;
    Eigen::Quaterniond rotation = rotation_of(values);
    if (span->after) {
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = mix(values[i], span->after->values[i], span->fraction);
      rotation = rotation.slerp(span->fraction, rotation_of(span->after->values));
    }
    LinkReading& root = seen.bodies[0].links[0];
    root.position = {values[0], values[1], values[2]};
    root.rotation = rotation;
    if (!source_.has_twist) return {};
    root.velocity = rotation * Eigen::Vector3d(values[7], values[8], values[9]);
    root.angular_velocity = rotation * Eigen::Vector3d(values[10], values[11], values[12]);
    return {};
  }

 private:
  /// The orientation as sent if it has unit length up to rounding; else normalised.
  static Eigen::Quaterniond rotation_of(const std::array<double, 13>& values) {
    constexpr double rounding = 1e-12;
    Eigen::Quaterniond rotation(values[6], values[3], values[4], values[5]);
    if (std::abs(rotation.squaredNorm() - 1.0) > rounding) rotation.normalize();
    return rotation;
  }

  const RootSource& source_;
  MessageReader<PoseOnly> pose_;
  MessageReader<Odometry> odometry_;
  LogTrack<13> track_;  // position, orientation x y z w, twist in the link's own frame
};

class JoyFeed : public LogFeed {
 public:
  JoyFeed(const JoySource& source, const ros2msg::Schema& schema) : source_(source), reader_(schema) {}

  bool take(std::int64_t time, mcap::Bytes payload) override {
    const msg::Joy* joy = reader_.read(payload);
    if (!joy) return false;
    std::array<double, axes_ + buttons_> values{};
    for (std::size_t i = 0; i < axes_; ++i) {
      const JoyAxis& axis = source_.axes[i];
      if (axis.index < 0 || static_cast<std::size_t>(axis.index) >= joy->axes.size()) continue;
      values[i] = static_cast<double>(axis.invert ? -joy->axes[axis.index] : joy->axes[axis.index]);
    }
    for (std::size_t i = 0; i < buttons_; ++i) {
      const int button = source_.buttons[i];
      if (button >= 0 && static_cast<std::size_t>(button) < joy->buttons.size())
        values[axes_ + i] = joy->buttons[button] != 0 ? 1.0 : 0.0;
    }
    track_.add(time, values);
    return true;
  }

  Result<void> look(const LogMoment& moment, Observation& seen) override {
    const auto span = track_.at(moment.time, false);
    if (!span) return {};
    for (std::size_t i = 0; i < axes_; ++i) seen.joystick->axes[i] = static_cast<float>(span->before->values[i]);
    for (std::size_t i = 0; i < buttons_; ++i) seen.joystick->buttons[i] = span->before->values[axes_ + i] != 0.0;
    return {};
  }

 private:
  static constexpr std::size_t axes_ = joystick_axes.size();
  static constexpr std::size_t buttons_ = joystick_buttons.size();

  const JoySource& source_;
  MessageReader<msg::Joy> reader_;
  LogTrack<axes_ + buttons_> track_;
};

}  // namespace

const std::vector<JointRename>& JointNames::find(const std::vector<std::string>& names) {
  if (names == names_ && joints_.size() == names.size()) return joints_;
  names_ = names;
  joints_.clear();
  for (const std::string& name : names) {
    JointRename joint;
    joint.joint = -1;
    if (const auto renamed = renamed_.find(name); renamed != renamed_.end()) {
      joint = renamed->second;
    } else {
      for (std::size_t id = 0; id < model_.joints.size(); ++id)
        if (model_.links[model_.joints[id]].joint.name == name) joint.joint = static_cast<int>(id);
    }
    joints_.push_back(joint);
  }
  return joints_;
}

std::unique_ptr<LogFeed> make_joint_feed(const JointSource& source, const Model& model, const ros2msg::Schema& schema) {
  return std::make_unique<JointFeed>(source, model, schema);
}

std::unique_ptr<LogFeed> make_root_feed(const RootSource& source, const ros2msg::Schema& schema) {
  return std::make_unique<RootFeed>(source, schema);
}

std::unique_ptr<LogFeed> make_joy_feed(const JoySource& source, const ros2msg::Schema& schema) {
  return std::make_unique<JoyFeed>(source, schema);
}

}  // namespace rehearse
