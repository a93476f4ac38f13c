// Feeds for joints, the root link and the joystick from a log.
#include <fmt/format.h>
#include <rehearse/messages.h>
#include <rehearse/units.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/hashing.h"
#include "joint_messages.h"
#include "log_feed.h"
#include "log_track.h"
#include "message_reader.h"
#include "number_messages.h"
#include "topic_watch.h"

namespace rehearse {
namespace {

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

/// The nearest multiple of a turn; 0 for NaN [rad].
double whole_turns(double angle) {
  constexpr double turn = 2.0 * std::numbers::pi;
  const double turns = std::round(angle / turn);
  return std::isfinite(turns) ? turns * turn : 0.0;
}

/// Scales a number of the log; a factor of 1 keeps all its bits, as those of NaN.
double scaled(double number, double factor) { return factor == 1.0 ? number : number * factor; }

class JointFeed : public LogFeed {
 public:
  JointFeed(const JointSource& source, const JointReadings& readings, const Model& model, const ros2msg::Schema& schema)
      : source_(source),
        angles_(readings.angles),
        half_steps_(readings.half_steps),
        model_(model),
        reader_(schema, JointRole::measured),
        names_(source.names, model) {
    tracks_.resize(model.joints.size());
    gaps_.assign(model.joints.size(), GapWatch(source.max_age));
  }

  Result<void> take(std::int64_t time, mcap::Bytes payload) override {
    const auto read = REHEARSE_TRY(reader_.read(payload));
    const JointArrays* state = read;
    const std::size_t count = state->names().size();
    for (const auto& [what, values] : {std::pair("positions", &state->position()),
                                       {"velocities", &state->velocity()},
                                       {"efforts", &state->effort()}})
      if (!values->empty() && values->size() != count)
        return error(fmt::format("{} {} of {} joints", values->size(), what, count));
    const std::vector<JointRename>& joints = names_.find(state->names());
    if (state->layout_changed()) note_strangers(time, state->names(), joints);
    for (std::size_t i = 0; i < count; ++i)
      if (joints[i].joint >= 0) take_joint(time, joints[i], *state, i);
    return {};
  }

  void look(const LogMoment& moment, Observation& seen) override {
    std::optional<std::int64_t> newest;  // time of the latest value of any joint [ns]
    may_miss_ = false;
    for (std::size_t joint = 0; joint < tracks_.size(); ++joint) {
      const auto span = span_at(tracks_[joint].values, moment.time, source_);
      if (!span) continue;
      tracks_[joint].shown = span->before->time;
      may_miss_ |= tracks_[joint].may_miss(moment.time);
      newest = std::max(newest.value_or(span->before->time), span->before->time);
      std::array<double, 3> values = span->before->values;
      if (span->after) {
        const bool turns = model_.links[model_.joints[joint]].joint.type == JointType::continuous;
        const double to = turns ? values[0] + shorter_way(values[0], span->after->values[0]) : span->after->values[0];
        values = {mix(values[0], to, span->fraction), mix(values[1], span->after->values[1], span->fraction),
                  mix(values[2], span->after->values[2], span->fraction)};
      }
      JointReading& reading = seen.bodies[0].joints[joint];
      const auto& known = tracks_[joint].known_from;
      if (known[0] <= span->before->time) reading.q = values[0];
      if (known[1] <= span->before->time) reading.dq = values[1];
      if (known[2] <= span->before->time) reading.u = values[2];
    }
    if (!newest || moment.time - *newest > nanoseconds(source_.max_age)) return;  // a gap of the whole topic
    for (std::size_t joint = 0; joint < tracks_.size(); ++joint)
      if (tracks_[joint].shown && gaps_[joint].look(moment.time - *tracks_[joint].shown, moment.seconds))
        silences_.push_back(model_.links[model_.joints[joint]].joint.name);
  }

  bool has_position(int joint) const override {
    return tracks_[joint].shown && tracks_[joint].known_from[0] <= *tracks_[joint].shown;
  }

  std::vector<SilentJoint> silent_joints() const override {
    std::vector<SilentJoint> silent;
    for (std::size_t joint = 0; joint < gaps_.size(); ++joint)
      if (gaps_[joint].found().gaps > 0)
        silent.push_back({gaps_[joint].found(), model_.links[model_.joints[joint]].joint.name});
    return silent;
  }
  std::vector<std::string> take_silences() override { return std::exchange(silences_, {}); }
  bool may_miss() const override { return may_miss_; }
  std::vector<LogStranger> strangers() const override { return strangers_; }

 private:
  static constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();
  struct Track {
    LogTrack<3> values;                                           // q, dq, u
    std::optional<std::int64_t> shown;                            // time of the value at the last tick [ns]
    std::array<std::int64_t, 3> known_from{never, never, never};  // time of the first message with each [ns]
    DurationCounts intervals{8};                                  // between its messages

    /// True if a message of the joint is missing at that time [ns], by its usual interval.
    bool may_miss(std::int64_t time) const {
      return intervals.is_regular() && misses_message(time - *shown, *shown, values.next(), intervals.median());
    }
  };

  /// Keeps the first names that aren't the model's.
  void note_strangers(std::int64_t time, const std::vector<std::string>& names,
                      const std::vector<JointRename>& joints) {
    constexpr std::size_t most = 32;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto is_it = [&](const LogStranger& known) { return known.name == names[i]; };
      if (joints[i].joint < 0 && strangers_.size() < most && std::ranges::none_of(strangers_, is_it))
        strangers_.push_back({names[i], static_cast<double>(time)});
    }
  }

  /// An angle of the log in radians; of wrapped ones that which is nearest to the one before.
  double displacement(double number, int joint, const LogTrack<3>::Sample* before) const {
    if (angles_ == LogAngles::radians || !is_angle(joint)) return number;
    if (angles_ == LogAngles::degrees) return number * units::degree;
    return before ? number + whole_turns(before->values[0] - number) : number;
  }
  double rate(double number, int joint) const {
    return angles_ == LogAngles::degrees && is_angle(joint) ? number * units::degree : number;
  }
  bool is_angle(int joint) const { return !is_linear(model_.links[model_.joints[joint]].joint.type); }

  void take_joint(std::int64_t time, const JointRename& joint, const JointArrays& state, std::size_t index) {
    Track& track = tracks_[joint.joint];
    const auto* before = track.values.newest();
    std::array<double, 3> values = before ? before->values : std::array<double, 3>{};
    const auto put = [&](std::size_t quantity, double value) {
      values[quantity] = value;
      track.known_from[quantity] = std::min(track.known_from[quantity], time);
    };
    if (before) track.intervals.add(time - before->time);
    if (!state.position().empty()) {
      put(0, scaled(displacement(state.position()[index], joint.joint, before), joint.scale));
      if (joint.offset != 0.0) values[0] += joint.offset;  // adding 0 would change -0 to 0
      if (const auto moved = half_steps_.find(joint.joint); moved != half_steps_.end())
        values[0] += hash_bytes(&time, sizeof time, static_cast<std::uint64_t>(joint.joint)) % 2 == 0 ? moved->second
                                                                                                      : -moved->second;
    }
    if (!state.effort().empty())
      put(2, joint.scale == 1.0 ? state.effort()[index] : state.effort()[index] / joint.scale);
    if (source_.differentiate) {
      put(1, before && before->time < time ? slope(joint.joint, *before, time, values[0]) : before ? values[1] : 0.0);
    } else if (!state.velocity().empty()) {
      put(1, scaled(rate(state.velocity()[index], joint.joint), joint.scale));
    }
    track.values.add(time, values);
  }

  double slope(int joint, const LogTrack<3>::Sample& before, std::int64_t time, double q) const {
    const bool turns = model_.links[model_.joints[joint]].joint.type == JointType::continuous;
    const double way = turns ? shorter_way(before.values[0], q) : q - before.values[0];
    return way / (static_cast<double>(time - before.time) * 1e-9);
  }

  const JointSource& source_;
  const LogAngles angles_;
  const std::map<int, double> half_steps_;
  const Model& model_;
  JointMessages reader_;
  JointNames names_;
  std::vector<Track> tracks_;   // by joint id
  std::vector<GapWatch> gaps_;  // by joint id
  std::vector<std::string> silences_;
  std::vector<LogStranger> strangers_;
  bool may_miss_ = false;  // at the last tick
};

/// Both types of messages with the root link's pose. A field that the schema lacks stays 0.
struct PoseOnly {
  static constexpr std::string_view type_name = "geometry_msgs/msg/PoseStamped";
  msg::Pose pose;
  REHEARSE_FIELDS(pose)
};

struct PoseWithCovariance {
  static constexpr std::string_view type_name = "geometry_msgs/msg/PoseWithCovariance";
  msg::Pose pose;
  REHEARSE_FIELDS(pose)
};

struct TwistWithCovariance {
  static constexpr std::string_view type_name = "geometry_msgs/msg/TwistWithCovariance";
  msg::Twist twist;
  REHEARSE_FIELDS(twist)
};

struct Odometry {
  static constexpr std::string_view type_name = "nav_msgs/msg/Odometry";
  PoseWithCovariance pose;
  TwistWithCovariance twist;
  REHEARSE_FIELDS(pose, twist)
};

class RootFeed : public LogFeed {
 public:
  RootFeed(const RootSource& source, const ros2msg::Schema& schema)
      : source_(source), pose_(schema), odometry_(schema), transforms_(schema) {}

  Result<void> take(std::int64_t time, mcap::Bytes payload) override {
    msg::Pose pose;
    msg::Twist twist;
    if (!source_.frame.empty()) {
      const msg::TFMessage* message = transforms_.read(payload);
      if (!message) return misfit(payload);
      const auto found = std::ranges::find_if(message->transforms,
                                              [this](const auto& one) { return one.child_frame_id == source_.frame; });
      if (found == message->transforms.end()) return {};  // transforms of other frames
      const msg::Vector3& place = found->transform.translation;
      pose = {{place.x, place.y, place.z}, found->transform.rotation};
    } else if (source_.has_covariance) {
      const Odometry* message = odometry_.read(payload);
      if (!message) return misfit(payload);
      pose = message->pose.pose;
      twist = message->twist.twist;
    } else {
      const PoseOnly* message = pose_.read(payload);
      if (!message) return misfit(payload);
      pose = message->pose;
    }
    const auto& [p, r] = pose;
    const double norm = std::sqrt(r.x * r.x + r.y * r.y + r.z * r.z + r.w * r.w);
    if (norm <= 0.5 || norm >= 2.0) return error(fmt::format("an orientation of length {:.4g}, not 1", norm));
    track_.add(time, {p.x, p.y, p.z, r.x, r.y, r.z, r.w, twist.linear.x, twist.linear.y, twist.linear.z,
                      twist.angular.x, twist.angular.y, twist.angular.z});
    return {};
  }

  void look(const LogMoment& moment, Observation& seen) override {
    const auto span = span_at(track_, moment.time, source_);
    if (!span) return;
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
    if (!source_.has_twist) return;
    root.velocity = rotation * Eigen::Vector3d(values[7], values[8], values[9]);
    root.angular_velocity = rotation * Eigen::Vector3d(values[10], values[11], values[12]);
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
  MessageReader<msg::TFMessage> transforms_;
  LogTrack<13> track_;  // position, orientation x y z w, twist in the link's own frame
};

class JoyFeed : public LogFeed {
 public:
  JoyFeed(const JoySource& source, const ros2msg::Schema& schema) : source_(source), reader_(schema), twist_(schema) {}

  Result<void> take(std::int64_t time, mcap::Bytes payload) override {
    const msg::Joy* joy = source_.is_twist ? joy_of_twist(payload) : reader_.read(payload);
    if (!joy) return misfit(payload);
    std::array<double, axes_ + buttons_> values{};
    for (std::size_t i = 0; i < axes_; ++i) {
      const JoyAxis& axis = source_.axes[i];
      if (axis.index < 0 || static_cast<std::size_t>(axis.index) >= joy->axes.size()) continue;
      values[i] = static_cast<double>(axis.invert ? -joy->axes[axis.index] : joy->axes[axis.index]) * axis.scale;
    }
    for (std::size_t i = 0; i < buttons_; ++i) {
      const int button = source_.buttons[i];
      if (button >= 0 && static_cast<std::size_t>(button) < joy->buttons.size())
        values[axes_ + i] = joy->buttons[button] != 0 ? 1.0 : 0.0;
    }
    track_.add(time, values);
    return {};
  }

  void look(const LogMoment& moment, Observation& seen) override {
    const auto span = track_.at(moment.time, false);
    if (!span) return;
    for (std::size_t i = 0; i < axes_; ++i) seen.joystick->axes[i] = static_cast<float>(span->before->values[i]);
    for (std::size_t i = 0; i < buttons_; ++i) seen.joystick->buttons[i] = span->before->values[axes_ + i] != 0.0;
  }

 private:
  static constexpr std::size_t axes_ = joystick_axes.size();
  static constexpr std::size_t buttons_ = joystick_buttons.size();

  /// The six numbers of a Twist as axes.
  const msg::Joy* joy_of_twist(mcap::Bytes payload) {
    const std::vector<double>* numbers = twist_.read(payload);
    if (!numbers) return nullptr;
    joy_.axes.assign(numbers->begin(), numbers->end());
    return &joy_;
  }

  const JoySource& source_;
  MessageReader<msg::Joy> reader_;
  NumberMessages twist_;
  msg::Joy joy_;
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

std::unique_ptr<LogFeed> make_joint_feed(const JointSource& source, const JointReadings& readings, const Model& model,
                                         const ros2msg::Schema& schema) {
  return std::make_unique<JointFeed>(source, readings, model, schema);
}

std::unique_ptr<LogFeed> make_root_feed(const RootSource& source, const ros2msg::Schema& schema) {
  return std::make_unique<RootFeed>(source, schema);
}

std::unique_ptr<LogFeed> make_joy_feed(const JoySource& source, const ros2msg::Schema& schema) {
  return std::make_unique<JoyFeed>(source, schema);
}

}  // namespace rehearse
