// The event of a command that isn't finite, and its reader.
#pragma once

#include <rehearse/run_options.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "io_layout.h"

namespace rehearse {

struct Link;

/// "wrote nan into u of joint 'KNEE' at tick 12 (0.012 s); it was recorded, but the robot keeps the command before it".
std::string odd_command_text(double number, Quantity quantity, const Link& link, std::int64_t tick, double time);

/// A command that isn't finite.
struct OddCommand {
  std::string sentence;  // "controller 'Robot/Walker' wrote nan into u of joint 'KNEE' at tick 12 (0.012 s)"
  std::int64_t tick = 0;
};

/// The command of that event, whose text follows "CONTROLLER: ". None: the remark is another one.
std::optional<OddCommand> odd_command_in(std::string_view remark);

/// The first of a run; none: its commands are finite.
std::optional<OddCommand> odd_command_of(const RunSummary& run);

}  // namespace rehearse
