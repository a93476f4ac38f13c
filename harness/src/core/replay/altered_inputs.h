// AlteredInputs: changes of the values that controllers read. "Walker/KNEE/q=0.3@tick:1200..1300" states the series,
// the new value and the ticks. input_target.h explains the names of series.
#pragma once

#include <rehearse/io.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/host/controller_host.h"
#include "core/scenario/tick_span.h"
#include "input_target.h"

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
  struct Alteration {
    std::string text;
    InputTarget target;
    char operation = '=';  // '=', '+', '*'
    double operand = 0.0;
    std::optional<TickSpan> span;  // nullopt: all ticks
    bool used = false;
  };

  static Result<Alteration> parse_one(const std::string& text, const Scenario& scenario);
  static bool is_read(const InputTarget& target, const ControllerHost& host);
  static bool apply(const Alteration& alteration, Observation& observation);

  std::vector<Alteration> alterations_;
};

}  // namespace rehearse
