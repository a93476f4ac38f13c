// Flights: recordings of robots' loops, made from the rings of their taps.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tap_ring.h"

namespace rehearse {

struct FlightOptions {
  std::filesystem::path output;  // names that exist are passed over: walker.mcap, walker-2.mcap, ...
  /// Only the last seconds are kept, when the loop marks them, its process ends without closing the tap, a command is
  /// beyond the effort of its joint in the model, or keeps_now() is true.
  bool is_black_box = false;
  std::optional<double> seconds;  // of a black box [s]; nullopt: as the tap states them
  std::uint64_t part_size =
      0;  // a file that is larger is followed by another one, FILE_0, FILE_1, ... [bytes]; 0: no limit
  std::uint64_t keep_free = 0;                            // a recording ends when its disk has less room [bytes]
  std::function<bool()> stops;                            // asked all the time; null: never
  std::function<bool()> keeps_now;                        // likewise
  std::function<void(const std::string& sentence)> tell;  // what happens; null: nobody is told
};

/// How a recording ended.
enum class FlightEnd : std::uint8_t { closed, loop_ended, stopped, disk_full };

struct FlightReport {
  std::vector<std::filesystem::path> files;
  std::int64_t ticks = 0;     // in the files
  std::int64_t missing = 0;   // between them
  std::uint64_t dropped = 0;  // as the loop counted them
  std::uint64_t refused = 0;  // calls of the loop that broke a rule
  std::int64_t damaged = 0;   // places where the ring couldn't be read
  FlightEnd end = FlightEnd::closed;
  Diagnostics remarks;
};

/// Records a tap until its loop ends or options.stops(). Fails if a file can't be written; what was written before is
/// kept. The ring stays.
Result<FlightReport> record_flight(TapRing& ring, const std::string& name, const FlightOptions& options);

/// Writes what is in the ring into one file. The ring stays.
Result<FlightReport> save_ring(TapRing& ring, const std::string& name, const FlightOptions& options);

}  // namespace rehearse
