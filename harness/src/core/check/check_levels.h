// The three levels of a check: the controllers on the golden's inputs, the world under its commands, and both.
// Internal.
#pragma once

#include <rehearse/check.h>

#include <filesystem>
#include <string>

#include "golden_noise.h"
#include "proof.h"

namespace rehearse {

/// Reads the whole recording, to find its damage and its events.
Result<Trace> load_without_messages(const std::filesystem::path& file);

/// One check under way: each function makes a level, and writes its result into the report.
struct Check {
  const Scenario& scenario;
  const Trace& golden;  // without messages
  std::filesystem::path actual;
  const CheckOptions& options;
  const Simulation& simulation;
  CheckReport report;
  bool world_is_known = false;  // it makes the golden under the golden's commands
  GoldenNoise noise = {};

  std::filesystem::path plant_trace() const { return actual.parent_path() / "plant" / actual.filename(); }
  /// Without a simulation: it is proved that the world makes the golden. Levels that remain unproved are simulated
  /// later.
  Result<void> check_proved(const Proof& proof);
  /// Makes the levels that aren't proved.
  Result<void> simulate();
  /// Stores a certificate if every bit of the golden was compared and is equal.
  Result<void> certify(const Proof& proof);
  /// Names in the report a file that differs from the golden, and draws the differing pictures.
  void tell_files(const Trace& fresh, const Comparison& comparison, const std::filesystem::path& file,
                  const char* what);

 private:
  Result<void> check_controller();
  Result<void> check_plant();
  Result<void> make_closed_loop();
  Result<void> check_closed();
  /// True, with the reason in the report, if another physics engine moved the golden's world.
  bool is_of_other_physics(const Trace& fresh, const Comparison& comparison);
};

}  // namespace rehearse
