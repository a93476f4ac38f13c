// Flights: recordings that a tap made in a robot's loop.
#pragma once

#include <rehearse/mcap_types.h>

#include <optional>
#include <string>

namespace rehearse::tool {

/// A recording that a tap made in a robot's loop.
struct Flight {
  std::string controller;  // its name
  mcap::StringMap facts;   // of the loop and its machine
  std::string other;       // why this process may compute other last bits: other_mathematics()
};

/// What a recording states, if it is a flight.
std::optional<Flight> flight_in(const std::string& trace);

/// The loop on the robot wasn't pinned: the program starts again without pinning, if it then computes as the loop did.
/// Returns if it needn't, or can't.
void take_mathematics_of(const Flight& flight);

/// "computed with the functions of the robot's libm", or why not.
std::string mathematics_line(const Flight& flight);

}  // namespace rehearse::tool
