// `rehearse replay LOG --controller LIB --model ROBOT --map FILE`: replays the log of a robot into a controller.
#pragma once

#include "logs/robot_log/log_replay.h"

#include <optional>
#include <string>

#include "command.h"

namespace rehearse::tool {

struct LogSettings {
  std::string log;
  std::string trace;     // output file; empty: named like the log, in the working directory
  std::string scenario;  // of a run that begins as the log did, to write; empty: none
  bool json = false;
  std::optional<double> deadline;  // of control() [s]
  LogReplayOptions replay;
};

}  // namespace rehearse::tool
