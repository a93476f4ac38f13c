// Trace: a whole recording in memory, for tests and comparisons.
//
// Every number in a trace is an element of a series. The name of a series is the topic of its channel, without the
// leading slash and without the last segment, followed by the element. (The last segment states the kind of message,
// the part before it the owner.) By the type of the message:
//
//   topic                     type                series
//   /SR1/joints               JointState          SR1/RLEG_KNEE/q, .../dq, .../u
//   /SR1/Walker/input/joint_accelerations  JointAccelerations  SR1/Walker/input/RLEG_KNEE/ddq
//   /SR1/WAIST/pose           PoseStamped         SR1/WAIST/position/x, .../orientation/w
//   /SR1/WAIST/twist          TwistStamped        SR1/WAIST/linear/x, .../angular/x
//   /SR1/WAIST/accel          AccelStamped        SR1/WAIST/linear_acceleration/x, .../angular_acceleration/x
//   /SR1/LeftForce/wrench     WrenchStamped       SR1/LeftForce/force/z, .../torque/x
//   /SR1/WaistIMU/imu         Imu                 SR1/WaistIMU/angular_velocity/x, .../linear_acceleration/x
//   /tf                       TFMessage           WAIST/position/x (the child frame), .../orientation/w
//   /joy                      Joy                 axes/L_STICK_V, buttons/A (by the channel's metadata, else by number)
//   /tick                     Tick                tick, state_hash, input_hash, output_hash, controller_results/0
//   any other with a ros2msg schema               the path of each numeric field, except header and stamp
//
// If two series would get the same name, the later channel's series have its whole topic before the element. Pictures,
// checkpoints, events and changes of contact have no series. Their bytes can be read by message index, and events() and
// contact_changes() are decoded.
//
// C++17, because tests of controllers include it. Code that uses attachments, metadata or events includes mcap.h or
// messages.h too (C++20).
#pragma once

#include <rehearse/call_place.h>
#include <rehearse/diagnostic.h>
#include <rehearse/mcap_types.h>
#include <rehearse/trace_table.h>

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

struct StateRate;

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

/// The place of a series in the trace.
struct SeriesPlace {
  std::size_t channel = 0;  // index into Trace::channels()
  std::size_t column = 0;
};

class Trace {
 public:
  enum class Damage {
    refuse,    // a trace that is incomplete is an error
    tolerate,  // load all undamaged parts; damage() reports the rest
  };
  /// Reads the whole file, in one pass, and checks its CRCs. Pictures stay in the file. The messages of a channel are
  /// sorted by their log times; messages of the same time keep their order in the file.
  static Result<Trace> load(const std::filesystem::path& file, Damage damage = Damage::refuse);

  using OnPiece = std::function<void(const Trace& piece)>;
  static constexpr std::size_t usual_piece_size = std::size_t{4} << 20;  // [bytes]
  /// Loads a file that is larger than the memory. `on_piece` is called with some ticks at a time, in file order, as
  /// soon as their numbers take about `piece_size` bytes. A piece has all attachments and metadata, and the channels
  /// and series that were found so far. Returns the trace without its tables' rows: all of its channels, series and
  /// changes of contact. Damage is reported at the end, after the pieces.
  static Result<Trace> load_in_pieces(const std::filesystem::path& file, const OnPiece& on_piece,
                                      std::size_t piece_size = usual_piece_size);

  /// Channels without columns, attachments and metadata of a recording, read from the end of the file; no message is
  /// read.
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
  /// In the order of time. The result of load_in_pieces() reads them from its file at the first call.
  const std::vector<msg::Event>& events() const;
  const std::vector<msg::ContactChange>& contact_changes() const;

  /// All series, sorted by name.
  const std::map<std::string, SeriesPlace, std::less<>>& series() const { return series_; }
  std::optional<SeriesPlace> find_series(std::string_view name) const;
  /// The three names that are most similar to that name or pattern, for messages: "a, b, c"; fewer if there are no
  /// more.
  std::string nearest_series(std::string_view name) const;

  // For tests. If a series is unknown, or has no sample where one is needed, they throw std::out_of_range; the message
  // begins with the line of the call, and lists similar names. If one of the samples is NaN, so are min, max and mean,
  // so that no comparison passes by accident.
  double first(std::string_view series, const CallPlace& from = CallPlace::here()) const;
  double last(std::string_view series, const CallPlace& from = CallPlace::here()) const;
  double min(std::string_view series, const CallPlace& from = CallPlace::here()) const;
  double max(std::string_view series, const CallPlace& from = CallPlace::here()) const;
  /// Mean of the samples with from_s <= t < until_s [s].
  double mean(std::string_view series, double from_s, double until_s, const CallPlace& from = CallPlace::here()) const;
  /// The latest sample at or before time_s [s].
  double at(std::string_view series, double time_s, const CallPlace& from = CallPlace::here()) const;
  std::vector<double> values(std::string_view series, const CallPlace& from = CallPlace::here()) const;
  std::vector<double> times(std::string_view series, const CallPlace& from = CallPlace::here()) const;  // [s]
  /// The exact values of an integer series, signed values in two's complement; std::invalid_argument for a
  /// floating series.
  std::vector<std::uint64_t> integers(std::string_view series, const CallPlace& from = CallPlace::here()) const;

  /// The bytes (CDR) of a message of a channel that has locations, read again from the file.
  Result<std::vector<std::byte>> payload(const TraceChannel& channel, std::size_t index) const;
  /// The bytes of a message of a channel that has rests, with 0 in place of each number that has a column.
  Result<std::vector<std::byte>> rest(const TraceChannel& channel, std::size_t index) const;
  /// The schema of one of channels(); null if it has none.
  const mcap::Schema* schema_of(const TraceChannel& channel) const;

 private:
  friend class EventStream;
  friend class TraceLoader;
  friend class TraceWindows;
  struct Samples;  // the samples of the named series
  struct Rests;    // index of the rests of each channel; made at the first request
  Samples samples(std::string_view name, const CallPlace& from) const;

  std::string file_;
  std::shared_ptr<mcap::Reader> reader_;            // keeps the file mapped
  std::shared_ptr<const StateRate> state_samples_;  // null: all messages were read
  bool keeps_undecoded_ = false;                    // messages that can't be decoded are in the tables
  Diagnostics damage_;
  std::vector<TraceChannel> channels_;
  std::map<std::string, SeriesPlace, std::less<>> series_;
  mutable std::shared_ptr<std::vector<msg::Event>> events_;           // null: they are in the file
  std::shared_ptr<std::vector<msg::ContactChange>> contact_changes_;  // never null in a loaded trace
  mutable std::shared_ptr<Rests> rests_;
};

}  // namespace rehearse
