// The sources of a map in a log, and the times of their messages on one clock.
//
// Times of messages are the log's, or those of their header.stamp. If a map uses both, stamps are converted to the
// log's clock (clock_estimate.h).
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>
#include <rehearse/model.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "log_replay.h"
#include "logs/map/log_map.h"

namespace rehearse {

/// One source of a map of any kind. One of the pointers is set, except for a topic that only makes ticks.
struct MappedSource {
  const LogSource* source = nullptr;  // never null
  std::string use;                    // "joints", the names of devices, "commands"
  const JointSource* joints = nullptr;
  const DeviceSource* devices = nullptr;
  const JoySource* joystick = nullptr;
  const RootSource* root = nullptr;
  const CommandSource* commands = nullptr;
  const StateSource* state = nullptr;

  /// True if the first tick waits for it: a joystick sends only when it is moved, and commands and camera infos are no
  /// inputs.
  bool is_awaited() const {
    return joints || root || (devices && devices->input->content != LogInput::Content::camera_info);
  }
};

/// The sources in the map's order; they point into it.
std::vector<MappedSource> sources_of(const LogMap& map, const Model& model);

/// The channels of the log with the topics of the sources.
std::vector<std::uint16_t> channels_of(const mcap::Reader& log, const std::vector<MappedSource>& sources);

/// Delivers the messages of `channels`, of any topic, in order of log time. A damaged log is read as far as possible;
/// the damage is returned.
Diagnostics read_in_order(mcap::Reader& log, const std::vector<std::uint16_t>& channels,
                          const std::function<bool(const mcap::Message&)>& callback);

/// The times of messages.
class LogTimes {
 public:
  /// Reads the log once if a map uses stamps and log times, to estimate the offsets.
  LogTimes(mcap::Reader& log, const std::vector<MappedSource>& sources);
  ~LogTimes();
  /// [ns]; fails with the reason if the message has no such time: its header can't be read, its stamp isn't set, is out
  /// of range, or is later than the message was logged.
  Result<std::int64_t> of(const mcap::Message& message);
  /// The message's header.stamp [ns]; nullopt: it has none, or it isn't set.
  std::optional<std::int64_t> stamp_of(const mcap::Message& message);
  /// True if the message was recorded before, as by a second recorder: its bytes are those of one of the last messages
  /// of its topic, and so is its stamp, or they were logged within microseconds. Messages come in the order of the log.
  bool is_twin(const mcap::Message& message);
  /// The log is read from its beginning.
  void begin_pass() { recent_.clear(); }
  /// True if all times are stamps, whose clock may be another one than the log's.
  bool are_stamps() const;
  /// The offset of a topic's stamps from the log's clock; nullopt: it isn't needed.
  std::optional<LogClockReport> clock_of(const std::string& topic) const;

 private:
  struct Stamps;
  /// Stamps and log times, of which no offset is known.
  struct Delays {
    std::int64_t logged = 0;  // of the last message [ns]
    std::optional<std::int64_t> accepted,
        last{};  // log time minus stamp, of the last used message and of the last [ns]
  };
  /// The last messages of a channel.
  struct Recent {
    static constexpr std::size_t most = 16;
    struct Seen {
      std::uint64_t hash = 0;
      std::int64_t logged = 0;  // [ns]
    };
    std::deque<Seen> seen;
  };
  /// True if the stamp is over a second further ahead than that of the message before, unless that was so, too.
  bool jumps_ahead(const mcap::Message& message, std::int64_t stamp);
  struct Topic {
    LogClock clock = LogClock::log_time;
    std::vector<LogClockReport> offsets;  // one for each span between steps of a clock; empty: not needed
  };
  void estimate(mcap::Reader& log, const std::vector<MappedSource>& sources);

  const mcap::Reader& log_;
  std::map<std::string, Topic> topics_;
  /// The source's topic and its clock.
  std::map<std::uint16_t, const std::pair<const std::string, Topic>*> by_channel_;
  std::map<std::uint16_t, std::unique_ptr<Stamps>> stamps_;  // by channel id
  std::map<std::uint16_t, Delays> delays_;                   // likewise
  std::map<std::string, Recent> recent_;                     // by topic
};

}  // namespace rehearse
