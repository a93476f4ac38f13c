// InputTarget: one number that controllers read, found by the name of its series.
//
// Series are named as in a trace: series of a body's joints, links and devices, and of the joystick. The name of a
// controller's input (Walker/Gait/input/KNEE/q) means that quantity of its body: all controllers of a body read the
// same value.
#pragma once

#include <rehearse/io.h>
#include <rehearse/scenario.h>

#include <cstddef>
#include <optional>
#include <string>

#include "core/host/io_layout.h"

namespace rehearse {

/// One number of an Observation.
struct InputTarget {
  enum class Kind { joint, link, device, ranges, contact, axis, button };
  Kind kind = Kind::joint;
  int body = 0;                     // -1: the joystick
  int owner = 0;                    // joint id, link index or device index
  std::size_t element = 0;          // by kind: index of the quantity's element, of the value, beam, axis or button
  std::size_t contact = 0;          // number of the contact point
  Quantity quantity = Quantity::q;  // for joints and links
  bool is_angle = false;            // [rad]
};

std::optional<InputTarget> find_input(const std::string& series, const Scenario& scenario);
/// A hint with names that the user may have meant: similar names, else names that are similar without the body, else up
/// to three names with the same last part.
std::string near_inputs(const std::string& series, const Scenario& scenario);

}  // namespace rehearse
