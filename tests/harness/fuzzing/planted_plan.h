// The plan of a fuzz test of a controller in planted.cpp.
#pragma once

#include <rehearse/fuzz.h>

#include <string>

namespace rehearse {

/// `words`: "ChainOfThree", or "sound ChainOfThree".
inline FuzzPlan planted_plan(const std::string& words, const std::string& library = "Planted") {
  const std::string controller = words.substr(words.rfind(' ') + 1);
  FuzzPlan plan;
  plan.name = "Planted." + controller;
  plan.library = std::string(PLANTED_CONTROLLERS) + "/" + library + ".so";
  plan.options = words;
  plan.model = PLANTED_MODEL;
  using Quantity = FuzzRange::Quantity;
  for (const char* joint : {"A", "B", "C"})
    plan.joints.push_back({joint, {{Quantity::q, -1.0, 1.0}, {Quantity::dq, -3.0, 3.0}}});
  plan.devices.push_back({"Imu", {}});
  plan.ticks = controller == "Wraps" ? 320 : 64;
  if (controller == "NoRateLimit") plan.expectations.push_back("always: abs(delta(Trio/A/u)) < 1 N·m");
  if (controller == "SignSlip") plan.expectations.push_back("always: Trio/B/u * prev(Trio/B/dq) < 1");
  return plan;
}

}  // namespace rehearse
