// A channel of a recording and its numbers as a table. C++17, as trace.h, which includes it.
#pragma once

#include <rehearse/mcap_types.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// The part of the loop that produced the differing value.
enum class Stage {
  inputs,      // the inputs of a controller differ from the recorded inputs
  controller,  // equal inputs, different commands
  physics,     // the state of the simulated bodies
  sensors,     // the measurements of sensors
  renderer,    // pixels
  costs,       // what control() costs: a finding of its own, after all others
};

/// "inputs", "controller", "physics", "sensors", "renderer" or "costs".
std::string_view to_string(Stage stage);

/// The type of the 64 bits of a cell.
enum class CellKind { floating, signed_integer, unsigned_integer, boolean };

/// One column of a channel's table: one series.
struct TraceColumn {
  std::string element;  // within the channel: RLEG_KNEE/q
  std::string series;   // in the trace: SR1/RLEG_KNEE/q
  CellKind kind = CellKind::floating;
};

/// The rest of a channel's messages from one message on. The rest is all bytes of a message, except numbers that have a
/// column and a stamp that equals the log time.
struct TraceRest {
  std::size_t first = 0;    // index of the first message with this rest
  std::uint64_t hash = 0;   // hash of the rest
  mcap::Location location;  // place of that message
};

/// A message that can't be decoded.
struct UndecodedMessage {
  std::size_t index = 0;
  std::string reason;  // "ends at byte 12, within position/3"
};

/// A channel and its numbers as a table: a row per message, a column per series, 8 bytes per cell, row after row. If a
/// message has no value for a cell, the cell is NaN, or 0 in an integer column.
struct TraceChannel {
  std::string topic;
  std::string type;      // sensor_msgs/msg/JointState; empty without schema
  std::string encoding;  // cdr
  mcap::StringMap metadata;
  std::vector<std::uint64_t> times;       // log time of each message [ns]
  std::vector<TraceColumn> columns;       // empty if the channel has no numbers
  std::vector<std::uint64_t> cells;       // rows() * columns.size() bit patterns
  std::vector<mcap::Location> locations;  // place of each message, for Trace::payload; empty for the types listed above
  std::vector<std::uint64_t> hashes = {};  // hash of the bytes of each message
  std::vector<TraceRest> rests = {};       // in the order of `first`; empty if no column or no schema is known
  /// Messages that can't be decoded, in their order; their rows have no values. Only comparisons of logs load them.
  std::vector<UndecodedMessage> undecoded = {};
  std::size_t earlier = 0;  // for a piece: number of the channel's messages in earlier pieces

  std::size_t messages() const { return times.size(); }
  std::size_t rows() const { return columns.empty() ? 0 : times.size(); }
  /// The columns.size() cells of a row.
  const std::uint64_t* row(std::size_t index) const { return cells.data() + index * columns.size(); }
  std::uint64_t bits(std::size_t row_index, std::size_t column) const {
    return cells[row_index * columns.size() + column];
  }
  /// The rest of a message; null if it is unknown.
  const TraceRest* rest_of(std::size_t message) const;
  /// Why a message can't be decoded; null if it can.
  const std::string* problem_of(std::size_t message) const;
  /// The value as a double; integers beyond 2^53 are rounded.
  double number(std::size_t row_index, std::size_t column) const;
};

}  // namespace rehearse
