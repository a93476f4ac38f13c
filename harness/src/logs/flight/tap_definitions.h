// The series of a tap (<rehearse/tap.h>), and the data of a tick, as the ring contains them.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap_types.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

struct TapSeries {
  enum class Kind : std::uint8_t { joints, commands, imu, device };

  Kind kind = Kind::joints;
  std::string body, device;        // no device: of joints
  std::vector<std::string> names;  // of joints
  int quantities = 0;              // of joints: a sum of REHEARSE_TAP_Q, ...
  std::size_t numbers = 0;         // count of the numbers of a tick

  bool is_of_joints() const { return kind == Kind::joints || kind == Kind::commands; }
};

struct TapDefinitions {
  std::vector<TapSeries> series;
  mcap::StringMap parameters;
  mcap::StringMap machine;  // facts of the loop's machine and program, which the tap states itself

  /// Reads lines of words with tabs between them. Fails if a line can't be read, if the series are of several bodies,
  /// or if two of them have the same quantity of a joint or the same device.
  static Result<TapDefinitions> parse(std::string_view text);
};

/// What a loop wrote of a series, or beside the series, in a tick.
struct TapEntry {
  unsigned kind = 0;                     // tap_values, ... (tap_ring.h)
  std::size_t series = 0;                // of values and of what is absent
  std::span<const double> numbers = {};  // of values; of a variable one
  std::string_view text = {};            // a variable's name, a line, the reason of a mark, a picture's name
  std::string_view device = {};          // of a picture
};

struct TapTick {
  std::int64_t tick = 0;
  std::int64_t loop_time = 0;  // of the loop's clock [ns]
  std::vector<TapEntry> entries;

  /// Reads a record whose hash is right. Entries refer to `record` and to memory of this. False: it isn't one of these
  /// series.
  bool read(std::span<const std::uint64_t> record, const TapDefinitions& definitions);

 private:
  std::vector<double> numbers_;
};

}  // namespace rehearse
