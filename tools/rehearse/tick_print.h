// Prints a tick of a recording, for a terminal and as JSON.
#pragma once

#include "viewing/stepping/tick_view.h"

#include <string>
#include <string_view>
#include <vector>

#include "output.h"

namespace rehearse::tool {

/// The parts of a tick that are printed.
struct TickParts {
  bool full = false;              // also values that haven't changed, and all elements of long arrays
  std::vector<std::string> only;  // names of series; empty: all
  bool inputs = true, outputs = true, rest = true, messages = true, contacts = true, threads = true, differences = true;
};

/// "tick 1200, 1.2 s".
std::string tick_text(std::int64_t tick, double time);
/// The tick as text of many lines.
std::string text_of(const TickView& view, const TickParts& parts);
Json json_of(const TickView& view, const TickParts& parts);

/// A table whose columns are as wide as their widest cell, numbers right-aligned; each line with its newline.
std::string table_text(const std::vector<TableRow>& rows, std::string_view indent);
/// "Arm/Reach: error: text".
std::string message_text(const ViewMessage& message);
std::string contact_text(const ViewContact& contact);
/// "RLEG_KNEE/u: replayed 12.1, recorded 12 (difference +0.1, 5 ULPs)".
std::string difference_text(const Divergence& difference);

}  // namespace rehearse::tool
