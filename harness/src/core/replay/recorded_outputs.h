// RecordedOutputs: the commands of the controllers in a recording, tick by tick. They are compared with the row of an
// OutputRecord: equal numbers here, numbers that differ by a RowJudge.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/mcap.h>
#include <rehearse/replay.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/compare/row_judge.h"
#include "core/host/controller_host.h"
#include "core/kinds/channel_name.h"
#include "core/trace/trace_rows.h"

namespace rehearse {

class RecordedOutputs {
 public:
  /// Finds the output channels of the controllers, which must have started. `fields`: the fields of the rows. All
  /// references must outlive this.
  RecordedOutputs(const ControllerHost& host, const std::vector<OutputField>& fields, const mcap::Reader& trace,
                  RowJudge& judge);

  const std::vector<std::uint16_t>& channels() const { return channels_; }
  void begin_tick();
  /// Takes a message of one of channels(). An error names topic and time if its bytes don't fit.
  Result<void> accept(const mcap::Message& message);

  /// Takes the recorded numbers of a tick that isn't compared with a row.
  Result<void> accept_later(const mcap::Message& message, std::int64_t tick);

  using OnDifference = std::function<void(Divergence&&)>;
  /// Passes the numbers of the tick to the judge, and calls `differs` for each other difference: recorded numbers
  /// without a field by channel, then numbers that only the row has. The caller fills in tick and time. Returns the
  /// number of compared recorded values.
  std::int64_t compare(std::int64_t tick, const std::vector<std::uint64_t>& row, const OnDifference& differs);
  /// Keeps the recorded numbers of a tick that isn't compared.
  void pass_over(std::int64_t tick);

 private:
  static constexpr std::size_t none = ~std::size_t{0};

  struct Channel {
    Channel(const mcap::Channel& channel, const mcap::Schema* schema)
        : kind(ChannelName::parse(channel.topic).kind), rows(channel, schema) {}

    ChannelKind kind;
    ChannelRows rows;  // the row of the last message
    const HostedController* hosted = nullptr;
    std::size_t judged = 0;              // its number in the judge
    std::size_t commanded = none;        // the word that is 1 if the device was commanded; none: no device's channel
    bool here = false;                   // the channel had a message in this tick
    bool was_here = false;               // the channel had a message in the tick of unpaired_
    std::vector<TraceColumn> columns;    // of its rows, then the values of a device that the recording lacks
    std::vector<std::size_t> words;      // of the row, by column; none: no controller commands the number now
    std::vector<std::size_t> unmatched;  // columns without a word
    std::vector<std::uint64_t> expected, actual;  // by column

    const std::string& topic() const { return rows.table.topic; }
  };
  /// A word of the row, and its controller.
  struct Word {
    std::size_t word;
    const HostedController* hosted;
  };

  void add_channel(const mcap::Reader& trace, const mcap::Channel& channel, const HostedController& hosted);
  void sort_words();
  std::size_t word_of(const std::string& channel, const std::string& element) const;
  Result<void> read(Channel& channel, const mcap::Message& message);
  void find_columns(Channel& channel);
  void find_unpaired();
  std::int64_t compare_channel(Channel& channel, std::int64_t tick, const std::vector<std::uint64_t>& row,
                               const OnDifference& differs);
  std::int64_t compare_unmatched(const Channel& channel, const OnDifference& differs) const;

  const ControllerHost& host_;
  const std::vector<OutputField>& fields_;
  RowJudge& judge_;
  std::map<std::pair<std::string, std::string>, std::size_t> words_;  // index of the word by channel and element
  std::vector<std::uint16_t> channels_;
  std::map<std::uint16_t, std::unique_ptr<Channel>> by_id_;
  std::vector<Word> commands_;     // words of numbers, except those of devices
  std::vector<Word> uncommanded_;  // words that are 1 if a device was commanded, of devices without recorded commands
  bool new_columns_ = true;        // columns were found since unpaired_ was made
  std::vector<Word> unpaired_;     // words of commands_ that no message of the tick contains
};

}  // namespace rehearse
