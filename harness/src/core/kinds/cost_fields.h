// The counts of msg::ControlCost, a row each: series, units, and whether a count of more than 0 breaks real time.
#pragma once

#include <rehearse/messages.h>
#include <rehearse/units.h>

#include <cstdint>
#include <string_view>

namespace rehearse {

struct CostField {
  std::string_view name;
  UnitName unit;
  std::uint64_t msg::ControlCost::*count;
  std::string_view one = {}, many = {};  // "allocation", "allocations"; empty: the count is no fault
};

/// The source of the event that a run doesn't count the costs that its scenario asks for. No comparison judges it: it
/// follows from the process, as the missing channels do.
inline constexpr std::string_view uncounted_costs_source = "costs";

inline constexpr CostField cost_fields[] = {
    {"allocations", "", &msg::ControlCost::allocations, "allocation", "allocations"},
    {"allocated_bytes", "B", &msg::ControlCost::allocated_bytes},
    {"releases", "", &msg::ControlCost::releases, "release of memory", "releases of memory"},
    {"locks", "", &msg::ControlCost::locks, "lock", "locks"},
    {"system_calls", "", &msg::ControlCost::system_calls, "system call", "system calls"},
    {"exceptions", "", &msg::ControlCost::exceptions, "exception", "exceptions"},
    {"message_bytes", "B", &msg::ControlCost::message_bytes},
};

}  // namespace rehearse
