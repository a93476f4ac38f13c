// Writes logs with the kinds of trouble that logs of robots have, for kinds_test.cpp. A robot of two joints moves them
// by itself; its controller is called at each message of its joints, and commands half a millisecond later.
#pragma once

#include <rehearse/messages.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "robot_run.h"

namespace rehearse::kinds {

namespace fs = std::filesystem;
using robot_run::Chance;
using robot_run::latency;
using robot_run::period;
using robot_run::start;

inline constexpr std::int64_t microsecond = 1'000, millisecond = 1'000'000, second = 1'000'000'000;  // [ns]
inline constexpr int ticks = 1500;
inline const std::vector<std::string> joints{"PAN", "TILT"};

/// The robot's run, before it is logged.
struct Plan {
  explicit Plan(Chance& numbers);
  Chance& chance;
  std::vector<std::int64_t> times;    // of the messages of joints, rising [ns]
  std::size_t first_command = 0;      // the message with which the controller starts
  std::vector<std::size_t> restarts;  // messages at which another process of the controller begins
  std::string options;                // of the controller
  /// A message of TILT for so many of PAN: each has its own topic. 0: one topic has both.
  std::size_t tilt_every = 0;
  double turns = 0.0;            // added to each displacement [rad]
  std::size_t nan_at = 0;        // the message in which the displacement of TILT is NaN; 0: none
  bool publishes_state = false;  // after each command, on /state
};

/// A message of the log.
struct Logged {
  std::string topic;
  std::int64_t written = 0;  // gives its place in the file
  std::int64_t logged = 0;   // log time [ns]
  std::int64_t stamp = 0;    // header.stamp [ns]
  bool is_kept = true;
  bool is_cut = false;     // its last bytes are missing
  bool is_single = false;  // a Float32MultiArray of the efforts
  bool is_array = false;   // a Float64MultiArray of the efforts
  msg::JointState joints;
};

/// How the messages are stored.
enum class Container { file, split, unfinished, zstd, lz4, zstd_file };

/// A log while it is made.
struct Log {
  Chance& chance;
  std::vector<Logged> states;    // of the joints
  std::vector<Logged> commands;  // parallel to `states`
  std::vector<Logged> controller_states;
  std::vector<Logged> others;
  Container container = Container::file;

  void each(const std::function<void(Logged&)>& change) {
    for (std::vector<Logged>* part : {&states, &commands, &controller_states, &others})
      for (Logged& message : *part) change(message);
  }
};

/// Changes of the controller that made the log, against the one that the log is fed to.
enum class Change { none, gain, sign, swapped, late };
std::string_view name_of(Change change);

/// Runs the robot with the controller of ServoWith_NAME.
Log run(const Plan& plan, const std::string& controller, Change change);

/// Writes the log into a folder; returns its path.
fs::path write(const Log& log, const fs::path& folder);

/// A kind of trouble.
struct Kind {
  const char* name;
  void (*plan)(Plan& plan);    // null: nothing
  void (*spoil)(Log& log);     // null: nothing
  const char* map;             // its lines beside those that all maps have; "" is usual
  const char* same;            // exit codes of the unchanged controllers: no memory, filtered, integral
  const char* changed;         // and of the changed ones
  const char* late = nullptr;  // of a delay of one tick, if it isn't `changed`
  const char* cause = "";      // the first line of the map that is proposed for the unchanged integral
  const char* sign = nullptr;  // of a changed sign, and of exchanged joints, if it isn't `changed`

  const char* expected(Change change) const {
    if (change == Change::none) return same;
    if (change == Change::late && late) return late;
    return (change == Change::sign || change == Change::swapped) && sign ? sign : changed;
  }
};
const std::vector<Kind>& all();

inline std::ostream& operator<<(std::ostream& out, const Kind& kind) { return out << kind.name; }

}  // namespace rehearse::kinds
