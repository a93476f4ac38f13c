// AlteredInputs: changes of the values that controllers read. "Walker/KNEE/q=0.3@tick:1200..1300" states the series,
// the new value and the ticks.
//
// Series are named as in a trace: series of a body's joints, links and devices, and of the joystick. The name of a
// controller's input (Walker/Gait/input/KNEE/q) means that quantity of its body: all controllers of a body read the
// same value.
#pragma once

#include <rehearse/io.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/controller_host.h"
#include "scenario/tick_span.h"

namespace rehearse {

class AlteredInputs {
 public:
  /// Parses SERIES=VALUE, SERIES+=VALUE or SERIES*=VALUE, each with or without @SPAN; without a span all ticks are
  /// altered. VALUE is a number, nan or inf; an angle may end in deg. Each mistake is an error with its place in the
  /// text.
  static Result<AlteredInputs> parse(const std::vector<std::string>& texts, const Scenario& scenario);

  /// The first tick with an alteration; 0 if there are no alterations.
  std::int64_t begins() const;
  bool empty() const { return alterations_.empty(); }
  /// Fails for inputs that no controller reads. The controllers must be initialised.
  Result<void> check_read_by(const ControllerHost& host) const;
  /// Makes the alterations of the tick, in the order of the texts.
  void apply(std::int64_t tick, Observation& observation);
  /// A warning for each alteration without effect so far: the run lacks its ticks, or the sensor measured nothing then.
  Diagnostics unused() const;

  // True if an alteration of any tick changes these inputs.
  bool alters_joints(int body) const;
  bool alters_device(int body, int device) const;
  bool alters_joystick() const;

 private:
  enum class Kind { joint, link, device, ranges, contact, axis, button };
  /// One number of an Observation.
  struct Target {
    Kind kind = Kind::joint;
    int body = 0;
    int owner = 0;                    // joint id, link index or device index
    std::size_t element = 0;          // by kind: index of the quantity's element, of the value, beam, axis or button
    std::size_t contact = 0;          // number of the contact point
    Quantity quantity = Quantity::q;  // for joints and links
    bool is_angle = false;            // [rad]
  };
  struct Alteration {
    std::string text;
    Target target;
    char operation = '=';  // '=', '+', '*'
    double operand = 0.0;
    std::optional<TickSpan> span;  // nullopt: all ticks
    bool used = false;
  };

  static Result<Alteration> parse_one(const std::string& text, const Scenario& scenario);
  static std::optional<Target> find(const std::string& series, const Scenario& scenario);
  static void add_names(const Scenario& scenario, std::vector<std::pair<std::string, Target>>& names);
  static std::string near_inputs(const std::string& series, const Scenario& scenario);
  static bool is_read(const Target& target, const ControllerHost& host);
  static bool apply(const Alteration& alteration, Observation& observation);

  std::vector<Alteration> alterations_;
};

}  // namespace rehearse
