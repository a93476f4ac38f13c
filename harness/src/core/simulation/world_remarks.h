// WorldRemarks: remarks on the steps of a world, as events of the run.
#pragma once

#include <rehearse/io.h>
#include <rehearse/messages.h>
#include <rehearse/scenario.h>
#include <rehearse/world.h>

#include <cstdint>
#include <string>
#include <vector>

namespace rehearse {

class WorldRemarks {
 public:
  /// The scenario must outlive this.
  explicit WorldRemarks(const Scenario& scenario);

  /// A controller ("BODY/NAME") reads a camera that the scenario doesn't run: a warning of the first tick.
  void add_idle_camera(const std::string& controller, int body, int device);

  /// Adds the events of the step before `tick`: steps that a solver didn't solve, joints beyond their limits or too
  /// fast, and links that connected or separated. For all but the last kind the first event is a warning, and so a
  /// remark of the run. The next event is a note that follows when it is twice as bad.
  /// `command`: in force. Drives that are commanded beyond a limit of their joints, or reach their effort limit, are
  /// reported once per joint, as are actuators that limit an effort.
  void observe(std::int64_t tick, const World& world, const Observation& seen, const Command& command,
               std::vector<msg::Event>& events);

 private:
  /// The remarks on a joint so far. Its limits are beside them: a model's joints lie far apart in memory.
  struct JointRemarks {
    double lower = 0.0, upper = 0.0;  // [rad] or [m]
    double last_excess = 0.0;         // beyond its limits, in the last step [rad] or [m]
    double excess = 0.0;              // as reported last [rad] or [m]
    double speed = 0.0;               // as reported last [rad/s] or [m/s]
    bool too_fast = false;            // its drive was commanded beyond the velocity limit
    bool blocked = false;             // its drive was commanded beyond a stop
    bool at_full_effort = false;
    bool sinks = false;    // its drive was too weak to stay where it was commanded
    bool limited = false;  // its actuator gave less than the effort that was commanded
    bool hot = false;      // likewise, or a drive was at its limit, because of its heat
  };
  /// The joint with the limits of its actuator.
  const Joint& joint_of(std::size_t body, std::size_t id) const;
  void add(std::int64_t tick, Severity severity, std::string text, std::vector<msg::Event>& events) const;
  void check_solver(std::int64_t tick, const World& world, std::vector<msg::Event>& events);
  void check_unsolved(std::int64_t tick, const Unsolved& unsolved, std::vector<msg::Event>& events);
  void check_residual(std::int64_t tick, const Residual& residual, std::vector<msg::Event>& events);
  bool is_calm(const Observation& seen) const;
  void check_speeds(std::int64_t tick, const Observation& seen, std::vector<msg::Event>& events);
  void check_missed(std::int64_t tick, const Residual& residual, std::vector<msg::Event>& events);
  void check_limits(std::int64_t tick, const Observation& seen, std::vector<msg::Event>& events);
  void check_drives(std::int64_t tick, const Observation& seen, const Command& command,
                    std::vector<msg::Event>& events);
  void check_actuators(std::int64_t tick, const Observation& seen, std::vector<msg::Event>& events);
  void check_drive(std::int64_t tick, std::size_t index, const Joint& joint, const JointReading& now,
                   const JointCommand& wanted, JointRemarks& known, std::vector<msg::Event>& events);

  const Scenario& scenario_;
  std::vector<std::string> idle_cameras_;          // not reported yet
  bool solver_failed_ = false;                     // in any step
  double residual_ = 0.0;                          // the largest that was reported
  double missed_ = 0.0;                            // likewise [rad/s] or [m/s]
  std::int64_t unconverged_steps_ = 0;             // so far
  std::int64_t next_unconverged_report_ = 10;      // at that number
  double unsolved_ = 0.0;                          // the last share that was reported
  std::vector<std::vector<Joint>> built_;          // by body and joint id; empty: the body has no actuators
  std::vector<bool> sinking_;                      // by body: the drive of any joint is too weak
  std::vector<bool> limited_, hot_;                // by body: the actuator of any joint
  double missing_at_contacts_ = 0.0;               // likewise
  bool crowded_ = false;                           // any island had too many contacts
  std::vector<std::vector<JointRemarks>> joints_;  // by body and joint id
};

}  // namespace rehearse
