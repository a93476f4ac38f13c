// Trace: a whole recording in memory, for tests and comparisons.
//
// Every number in it is an element of a series, and a series has a name: the topic of its channel without the leading
// slash and without the last segment (the last segment says the kind of message, what is before it whose it is), then
// the element. By the type of the message:
//
//   topic                     type                series
//   /SR1/joints               JointState          SR1/RLEG_KNEE/q, .../dq, .../u
//   /SR1/accelerations        JointAccelerations  SR1/RLEG_KNEE/ddq
//   /SR1/WAIST/pose           PoseStamped         SR1/WAIST/position/x, .../orientation/w
//   /SR1/WAIST/twist          TwistStamped        SR1/WAIST/linear/x, .../angular/x
//   /SR1/WAIST/accel          AccelStamped        SR1/WAIST/linear_acceleration/x, .../angular_acceleration/x
//   /SR1/LeftForce/wrench     WrenchStamped       SR1/LeftForce/force/z, .../torque/x
//   /SR1/WaistIMU/imu         Imu                 SR1/WaistIMU/angular_velocity/x, .../linear_acceleration/x
//   /tf                       TFMessage           WAIST/position/x (the child frame), .../orientation/w
//   /joy                      Joy                 axes/L_STICK_V, buttons/A (by the channel's metadata, else by number)
//   /tick                     Tick                tick, state_hash, input_hash, output_hash, controller_results/0
//   any other with a ros2msg schema               the path of each numeric field, but for header and stamp
//
// If that would name two series alike, the later channel's have its whole topic before the element.
// Pictures, checkpoints, events and changes of contact have no series; their bytes are at hand by number, and events()
// and contact_changes() are decoded.
//
// C++17, because tests of controllers include it. Whoever looks into attachments, metadata or events includes mcap.h or
// messages.h too (C++20).
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap_types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

namespace mcap {
class Reader;
struct Attachment;
struct Metadata;
struct Schema;
}  // namespace mcap
namespace msg {
struct ContactChange;
struct Event;
}  // namespace msg

/// Which part of the loop produced the value that differs.
enum class Stage {
  inputs,      // what was fed to a controller isn't what was recorded
  controller,  // the same inputs, other commands
  physics,     // the state of the simulated bodies
  sensors,     // what a sensor measured of it
  renderer,    // pixels
};

/// "inputs", "controller", "physics", "sensors" or "renderer".
std::string_view to_string(Stage stage);

/// What the 64 bits of a cell are.
enum class CellKind { floating, signed_integer, unsigned_integer, boolean };

/// One column of a channel's table: one series.
struct TraceColumn {
  std::string element;  // within the channel: RLEG_KNEE/q
  std::string series;   // in the trace: SR1/RLEG_KNEE/q
  CellKind kind = CellKind::floating;
};

/// From which message on a channel's messages have the same rest: the same bytes, but for the numbers that have a
/// column and for a stamp that is the log time.
struct TraceRest {
  std::size_t first = 0;    // message
  std::uint64_t hash = 0;   // of the rest
  mcap::Location location;  // of that message
};

/// A channel and its numbers as a table: a row per message, a column per series, 8 bytes a cell, rows one after the
/// other. A cell that a message has no value for holds NaN, or 0 in an integer column.
struct TraceChannel {
  std::string topic;
  std::string type;      // sensor_msgs/msg/JointState; empty without schema
  std::string encoding;  // cdr
  mcap::StringMap metadata;
  std::vector<std::uint64_t> times;        // log time of each message [ns]
  std::vector<TraceColumn> columns;        // empty if the channel has no numbers
  std::vector<std::uint64_t> cells;        // rows() * columns.size() bit patterns
  std::vector<mcap::Location> locations;   // of each message, for Trace::payload; empty for the types listed above
  std::vector<std::uint64_t> hashes = {};  // of the bytes of each message
  std::vector<TraceRest> rests = {};       // in the order of `first`; empty if no column or no schema is known
  std::size_t earlier = 0;                 // of a piece: messages of the channel that earlier pieces had

  std::size_t messages() const { return times.size(); }
  std::size_t rows() const { return columns.empty() ? 0 : times.size(); }
  /// The columns.size() cells of a row.
  const std::uint64_t* row(std::size_t index) const { return cells.data() + index * columns.size(); }
  std::uint64_t bits(std::size_t row_index, std::size_t column) const {
    return cells[row_index * columns.size() + column];
  }
  /// The rest of a message; null if none is known.
  const TraceRest* rest_of(std::size_t message) const;
  /// As a double; integers beyond 2^53 are rounded.
  double number(std::size_t row_index, std::size_t column) const;
};

/// Where a series is.
struct SeriesPlace {
  std::size_t channel = 0;  // index into Trace::channels()
  std::size_t column = 0;
};

class Trace {
 public:
  enum class Damage {
    refuse,    // a trace that isn't whole is an error
    tolerate,  // load what is whole; damage() says what isn't
  };
  /// Reads the whole file, in one pass, CRCs checked. Pictures stay in the file. The messages of a channel are in the
  /// order of their log times, those of one time as in the file.
  static Result<Trace> load(const std::filesystem::path& file, Damage damage = Damage::refuse);

  using OnPiece = std::function<void(const Trace& piece)>;
  static constexpr std::size_t usual_piece_size = std::size_t{4} << 20;  // [bytes]
  /// The same for a file that is too long for the memory: `on_piece` is called with some ticks at a time, in their
  /// order in the file, as soon as their numbers take about `piece_size` bytes. A piece has all attachments and
  /// metadata, and the channels and series that were met so far. Returns the trace without its tables' rows: all of its
  /// channels, series, events and changes of contact. Damage is told at the end, after the pieces.
  static Result<Trace> load_in_pieces(const std::filesystem::path& file, const OnPiece& on_piece,
                                      std::size_t piece_size = usual_piece_size);

  /// Channels without columns, attachments and metadata of a recording, as the end of the file states them; no message
  /// is read.
  static Result<Trace> outline(const std::filesystem::path& file);

  const std::string& file() const { return file_; }      // as the user named it
  const Diagnostics& damage() const { return damage_; }  // only with Damage::tolerate

  double duration() const;     // from the first message to the last [s]
  std::int64_t ticks() const;  // messages of type rehearse_msgs/msg/Tick

  /// In the order in which they were defined.
  const std::vector<TraceChannel>& channels() const { return channels_; }
  const TraceChannel* find_channel(std::string_view topic) const;  // null: none
  const std::vector<mcap::Attachment>& attachments() const;
  const mcap::Attachment* find_attachment(std::string_view name) const;  // null: none
  const std::vector<mcap::Metadata>& metadata() const;
  const mcap::StringMap* find_metadata(std::string_view name) const;  // null: none
  const std::vector<msg::Event>& events() const;
  const std::vector<msg::ContactChange>& contact_changes() const;

  /// All series, sorted by name.
  const std::map<std::string, SeriesPlace, std::less<>>& series() const { return series_; }
  std::optional<SeriesPlace> find_series(std::string_view name) const;
  /// The three names that are most like that name or pattern, for messages: "a, b, c"; fewer if there are no more.
  std::string nearest_series(std::string_view name) const;

  // For tests. An unknown series, or one without a sample where one is needed, throws std::out_of_range and says which
  // names are near. NaN among the samples makes min, max and mean NaN, so that no comparison holds by oversight.
  double first(std::string_view series) const;
  double last(std::string_view series) const;
  double min(std::string_view series) const;
  double max(std::string_view series) const;
  /// Mean of the samples with from_s <= t < until_s [s].
  double mean(std::string_view series, double from_s, double until_s) const;
  /// The latest sample at or before time_s [s].
  double at(std::string_view series, double time_s) const;
  std::vector<double> values(std::string_view series) const;
  std::vector<double> times(std::string_view series) const;  // [s]
  /// The exact values of an integer series, signed ones in two's complement; std::invalid_argument if it is floating.
  std::vector<std::uint64_t> integers(std::string_view series) const;

  /// The bytes (CDR) of a message of a channel that has locations, read from the file again.
  Result<std::vector<std::byte>> payload(const TraceChannel& channel, std::size_t index) const;
  /// The bytes of a message of a channel that has rests, with 0 in place of each number that has a column.
  Result<std::vector<std::byte>> rest(const TraceChannel& channel, std::size_t index) const;
  /// The schema of one of channels(); null if it has none.
  const mcap::Schema* schema_of(const TraceChannel& channel) const;

 private:
  friend class TraceLoader;
  friend class TraceWindows;
  struct Samples;  // the series that a name means
  struct Rests;    // what finds rests, by channel; made when it is asked for
  Samples samples(std::string_view name) const;

  std::string file_;
  std::shared_ptr<mcap::Reader> reader_;  // keeps the file mapped
  Diagnostics damage_;
  std::vector<TraceChannel> channels_;
  std::map<std::string, SeriesPlace, std::less<>> series_;
  std::shared_ptr<std::vector<msg::Event>> events_;  // these are never null in a loaded trace
  std::shared_ptr<std::vector<msg::ContactChange>> contact_changes_;
  mutable std::shared_ptr<Rests> rests_;
};

}  // namespace rehearse
