// The interfaces of ros2_control that the simulated robot has: a number each.
#pragma once

#include <rehearse/controller.h>

#include <cstddef>
#include <limits>
#include <set>
#include <string>
#include <vector>

namespace rehearse_ros2_control {

/// Components read and write copies, which exchange() passes to and from the run: a component may have a thread of its
/// own, and the functions of a run are for the thread that calls the controller.
class Robot {
 public:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

  explicit Robot(rehearse_io* io) : io_(io) {}
  /// The robot of the components that are made now. Null: none are.
  static Robot*& being_made();

  /// The index of a state: of a joint's "position", "velocity", "acceleration", "effort", or of a device's numbers, as
  /// "force.x". `none`: the robot has no such number. Before the first tick only.
  std::size_t state(const std::string& part, const std::string& interface);
  /// The index of a command to a joint, or `none`.
  std::size_t command(const std::string& joint, const std::string& interface);

  double value_of(std::size_t state) const { return states_[state].value; }
  void set(std::size_t command, double value) { commands_[command].value = value; }
  /// Commands that controllers have claimed, or let go, by their full names. Others are unknown, and left out.
  void claim(const std::vector<std::string>& names, bool is_claimed);

  /// Chooses what drives the joints: commands that one controller claims. Throws std::runtime_error if another one
  /// claims a different quantity of such a joint. Before the first tick only.
  void choose_drives(const std::string& controller, const std::vector<std::string>& claimed);

  /// Copies the states from the run.
  void read();
  /// A command that can't be passed to the run.
  struct BadCommand {
    std::string name, problem;  // the name is empty: there is none
  };
  /// Passes the claimed commands to the run. NaN before the first number means that there is no command yet.
  BadCommand write();
  /// Records the values: "state/J1/position", "command/J1/effort".
  void record() const;

 private:
  struct State {
    std::string name;  // "J1/position"
    int handle = -1, quantity = 0;
    int element = -1;  // of a device's numbers; -1: it is a joint's
    double value = 0.0;
  };
  struct Command {
    std::string name;
    int handle = -1, quantity = 0;
    double value = std::numeric_limits<double>::quiet_NaN();
    bool is_claimed = false, had_number = false;
  };
  struct Drive {
    int joint = -1, quantities = 0;
    std::string controller;
  };
  void check(int code) const;

  rehearse_io* io_;
  std::vector<State> states_;
  std::vector<Command> commands_;
  std::vector<Drive> drives_;
};

}  // namespace rehearse_ros2_control
