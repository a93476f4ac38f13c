// RecordedTicks: the numbers of a recording at any tick, as they are recorded: a row of a channel is the latest at or
// before. Internal.
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

#include "message_finder.h"
#include "trace/trace_rows.h"

namespace rehearse {

class RecordedTicks {
 public:
  static constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();
  /// A row of numbers and when it was recorded.
  struct Row {
    std::uint64_t time = never;  // log time [ns]
    std::uint64_t until = 0;     // it is known to be the latest up to then [ns]
    std::uint64_t used = 0;
    std::vector<std::uint64_t> cells;
  };

  /// Learns the names of all series from a few messages of each channel.
  explicit RecordedTicks(MessageFinder& finder);
  /// The variables that the controllers set when they are replayed: those that the recording hasn't become series like
  /// its own, the others are its channels' replayed rows.
  void add_replayed(MessageFinder& variables);

  std::size_t channels() const { return sources_.size(); }
  const TraceChannel& channel(std::size_t index) const { return sources_[index]->rows.table; }
  std::uint16_t channel_id(std::size_t index) const { return sources_[index]->id; }

  /// The latest row at or before that time; null: there is none. Valid until the next call for this channel.
  const Row* row(std::size_t channel, std::uint64_t time);
  /// What the controllers set in a replay, if that is a variable that the recording has too; else null.
  const Row* replayed_row(std::size_t channel, std::uint64_t time);
  bool has_replayed_rows(std::size_t channel) const { return sources_[channel]->replayed != nullptr; }
  /// The recording has the channel; else it is of a replay alone.
  bool is_recorded(std::size_t channel) const { return channel < recorded_channels_; }
  /// A cell of a row as a double; NaN where the row has none, because the column came later.
  double number(std::size_t channel, std::size_t column, const Row& row) const;

  const std::map<std::string, SeriesPlace, std::less<>>& series() const { return series_; }
  /// Channels whose messages have now more and now fewer numbers are read to their end, for names not met so far.
  void learn_all();
  /// The names of series_, sorted; made when asked for.
  const std::vector<std::string>& names();

 private:
  struct Source {
    Source(MessageFinder& in, const mcap::Channel& channel);

    MessageFinder& finder;
    std::uint16_t id;
    ChannelRows rows;  // the one that was read last
    std::array<Row, 4> recent;
    std::uint64_t none_until = 0;  // there is no message before that time [ns]
    bool varies;                   // messages needn't have the same numbers
    std::unique_ptr<Source> replayed;
  };
  const Row* row(Source& source, std::uint64_t time);
  bool read(Source& source, const MessageFinder::Found& found);
  void learn(Source& source);
  void name_all();

  std::vector<std::unique_ptr<Source>> sources_;
  std::size_t recorded_channels_ = 0;  // the first of sources_
  std::map<std::string, SeriesPlace, std::less<>> series_;
  std::vector<std::string> names_;
  std::uint64_t uses_ = 0;
  bool learned_all_ = false;
};

}  // namespace rehearse
