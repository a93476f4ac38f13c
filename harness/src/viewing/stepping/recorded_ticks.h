// RecordedTicks: the numbers of a recording at any tick: the latest row of a channel up to that tick. Internal.
#pragma once

#include <rehearse/trace.h>

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/trace/trace_rows.h"
#include "message_finder.h"

namespace rehearse {

class RecordedTicks {
 public:
  static constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();
  /// A row of numbers and its time.
  struct Row {
    std::uint64_t time = never;  // log time [ns]
    std::uint64_t until = 0;     // there is no later row up to this time [ns]
    std::uint64_t used = 0;
    std::vector<std::uint64_t> cells;
  };

  /// Reads the names of all series from a few messages of each channel.
  explicit RecordedTicks(MessageFinder& finder);
  /// Adds the variables that the controllers set in a replay. A variable that the recording lacks becomes a new series;
  /// all others are the replayed rows of their channels.
  void add_replayed(MessageFinder& variables);

  std::size_t channels() const { return sources_.size(); }
  const TraceChannel& channel(std::size_t index) const { return sources_[index]->rows.table; }
  std::uint16_t channel_id(std::size_t index) const { return sources_[index]->id; }

  /// The latest row up to that time; null: there is none. Valid until the next call for this channel.
  const Row* row(std::size_t channel, std::uint64_t time);
  /// The row of a variable in the replay, if the recording has this variable too; else null.
  const Row* replayed_row(std::size_t channel, std::uint64_t time);
  bool has_replayed_rows(std::size_t channel) const { return sources_[channel]->replayed != nullptr; }
  /// True if the recording has the channel; false if only a replay has it.
  bool is_recorded(std::size_t channel) const { return channel < recorded_channels_; }
  /// A cell of a row as a double; NaN if the row has no value for it, because the column was added later.
  double number(std::size_t channel, std::size_t column, const Row& row) const;

  const std::map<std::string, SeriesPlace, std::less<>>& series() const { return series_; }
  /// Reads channels with a varying number of numbers to their end, to find all names.
  void learn_all();
  /// The names of series_, sorted; made at the first request.
  const std::vector<std::string>& names();

 private:
  struct Source {
    Source(MessageFinder& in, const mcap::Channel& channel);

    MessageFinder& finder;
    std::uint16_t id;
    ChannelRows rows;  // the row that was read last
    std::array<Row, 4> recent;
    std::uint64_t none_until = 0;  // there is no message before that time [ns]
    bool varies;                   // messages may have different numbers of elements
    std::unique_ptr<Source> replayed;
  };
  const Row* row(Source& source, std::uint64_t time);
  bool read(Source& source, const MessageFinder::Found& found);
  void learn(Source& source);
  void name_all();

  std::vector<std::unique_ptr<Source>> sources_;
  std::size_t recorded_channels_ = 0;  // number of recorded channels: the first of sources_
  std::map<std::string, SeriesPlace, std::less<>> series_;
  std::vector<std::string> names_;
  std::uint64_t uses_ = 0;
  bool learned_all_ = false;
};

}  // namespace rehearse
