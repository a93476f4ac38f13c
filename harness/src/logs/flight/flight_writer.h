// FlightWriter: makes a recording of what a robot's loop wrote into its tap.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tap_definitions.h"
#include "tap_ring.h"

namespace rehearse {

/// Everything about a flight that is known before its first tick. All its files have it.
struct FlightPlan {
  std::string label;       // BODY/CONTROLLER
  double time_step = 0.0;  // [s]
  double duration = 0.0;   // that the scenario states [s]
  TapDefinitions definitions;
  Scenario scenario;  // a body without joints and devices if the tap states no model
  bool has_model = false;
  std::vector<Device> devices;                        // of series, as their messages need them
  std::vector<std::optional<std::size_t>> device_of;  // index into `devices`, by series
  mcap::StringMap provenance, flight;                 // metadata
  Diagnostics remarks;                                // what of the series the model lacks

  /// `name`: of the tap. `ticks`: the number of ticks that the scenario states; nullopt: it isn't known.
  static Result<std::unique_ptr<FlightPlan>> of(const TapRing& ring, const std::string& name,
                                                std::optional<std::int64_t> ticks);
};

class FlightWriter {
 public:
  /// Creates the file, and writes all but ticks. The plan must outlive this.
  static Result<std::unique_ptr<FlightWriter>> create(const std::filesystem::path& file, const FlightPlan& plan);
  ~FlightWriter();
  FlightWriter(const FlightWriter&) = delete;
  FlightWriter& operator=(const FlightWriter&) = delete;

  /// `dropped`: the number of ticks so far that are in no recording.
  Result<void> write(const TapTick& tick, std::uint64_t dropped);
  /// States an event of the recorder itself, at the time of that tick.
  Result<void> write_event(std::int64_t tick, const std::string& severity, const std::string& text);
  /// Everything that was written is on the disk when it returns.
  Result<void> sync();
  /// Ends the file. `ticks`: of the whole flight; nullopt: another file follows.
  Result<void> close(std::optional<std::int64_t> ticks);

  std::int64_t ticks() const;  // in this file
  std::uint64_t size() const;  // of the file up to the last sync() [bytes]

 private:
  struct Impl;
  explicit FlightWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rehearse
