// AlteredInputs: what controllers read, other than it was. "Walker/KNEE/q=0.3@tick:1200..1300": the series, what
// becomes of its number, and when.
//
// Series are named as in a trace: of a body's joints, links and devices, and of the joystick. A name of a controller's
// input (Walker/Gait/input/KNEE/q) means the same quantity of its body: all controllers of a body read one.
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
  /// SERIES=VALUE, SERIES+=VALUE or SERIES*=VALUE, then @SPAN or nothing, which is all ticks; a VALUE is a number,
  /// which of an angle may end in deg, or nan, or inf. Each mistake is an error with its place in the text.
  static Result<AlteredInputs> parse(const std::vector<std::string>& texts, const Scenario& scenario);

  /// The first tick in which any of them acts; 0 if there are none.
  std::int64_t begins() const;
  bool empty() const { return alterations_.empty(); }
  /// Fails for what none of the controllers reads; they have been initialised.
  Result<void> check_read_by(const ControllerHost& host) const;
  /// In the order in which they were given.
  void apply(std::int64_t tick, Observation& observation);
  /// A warning for each that changed nothing so far: the run has no such tick, or the sensor said nothing then.
  Diagnostics unused() const;

  /// What a tick's alterations, of whatever tick, can reach.
  bool alters_joints(int body) const;
  bool alters_device(int body, int device) const;
  bool alters_joystick() const;

 private:
  enum class Kind { joint, link, device, ranges, contact, axis, button };
  /// One number of an Observation.
  struct Target {
    Kind kind = Kind::joint;
    int body = 0;
    int owner = 0;                    // joint id, link or device index
    std::size_t element = 0;          // by kind: of the quantity, of the values, beam, axis
    std::size_t contact = 0;          // number of the contact point
    Quantity quantity = Quantity::q;  // of joints and links
    bool is_angle = false;            // [rad]
  };
  struct Alteration {
    std::string text;
    Target target;
    char operation = '=';  // '=', '+', '*'
    double operand = 0.0;
    std::optional<TickSpan> span;  // none: all
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
