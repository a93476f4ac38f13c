// LogFeed: converts the messages of one source of a map to inputs of a controller at each tick.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/io.h>
#include <rehearse/mcap.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/ros2msg/ros2msg.h"
#include "log_replay.h"
#include "log_ticks.h"
#include "logs/map/log_map.h"

namespace rehearse {

/// A time at which feeds are read.
struct LogMoment {
  std::int64_t time = 0;  // of the log [ns]
  std::int64_t tick = 0;
  double seconds = 0.0;  // of the tick [s]
};

/// A message that a tick needed and that can't be read.
struct UnreadableMessage {
  std::int64_t time = 0;  // [ns]
  Diagnostic reason;
};

class LogFeed {
 public:
  virtual ~LogFeed() = default;

  /// Adds the next message, which isn't earlier than the one before it. Fails with the reason if it can't be read; then
  /// it is left out.
  virtual Result<void> take(std::int64_t time, mcap::Bytes payload) = 0;
  /// Writes the values at that time into the observation of the robot; unknown values stay unchanged.
  virtual void look(const LogMoment& moment, Observation& seen) = 0;
  /// True if it gave the joint a displacement, which may be NaN, at the last tick.
  virtual bool has_position(int /*joint*/) const { return false; }
  /// The messages that the last look() decoded and could not read.
  virtual std::vector<UnreadableMessage> take_unreadable() { return {}; }
  /// The joints without a message while others of the topic had some.
  virtual std::vector<SilentJoint> silent_joints() const { return {}; }
  /// The names of the joints whose silence became a gap since the last call.
  virtual std::vector<std::string> take_silences() { return {}; }
  /// True if a joint may lack a message at the last tick although its topic has one.
  virtual bool may_miss() const { return false; }
  /// The first names of joints that the model doesn't have.
  virtual std::vector<LogStranger> strangers() const { return {}; }
  /// Remarks on the messages, each once.
  virtual Diagnostics take_remarks() { return {}; }
};

/// How the displacements of joints are read.
struct JointReadings {
  LogAngles angles = LogAngles::radians;
  std::map<int, double> half_steps = {};  // by joint id, added or subtracted by chance [rad] or [m]
};

/// `schema`: of the source's topic. All except the schema must outlive the feed.
std::unique_ptr<LogFeed> make_joint_feed(const JointSource& source, const JointReadings& readings, const Model& model,
                                         const ros2msg::Schema& schema);
std::unique_ptr<LogFeed> make_root_feed(const RootSource& source, const ros2msg::Schema& schema);
std::unique_ptr<LogFeed> make_joy_feed(const JoySource& source, const ros2msg::Schema& schema);
/// The feed of a numeric device, a camera or a range sensor.
std::unique_ptr<LogFeed> make_device_feed(const DeviceSource& source, const Model& model, const LogTicks& ticks,
                                          const LogTopic& topic, const ros2msg::Schema& schema);

/// The joints of a JointState's names, as ids of the model; -1: the model has no such joint.
class JointNames {
 public:
  JointNames(const std::map<std::string, JointRename>& renamed, const Model& model)
      : renamed_(renamed), model_(model) {}

  /// Parallel to the names; for unchanged names only a comparison is needed.
  const std::vector<JointRename>& find(const std::vector<std::string>& names);

 private:
  const std::map<std::string, JointRename>& renamed_;
  const Model& model_;
  std::vector<std::string> names_;
  std::vector<JointRename> joints_;
};

}  // namespace rehearse
