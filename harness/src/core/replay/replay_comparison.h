// ReplayComparison: compares the outputs of controllers in a replay with the recorded outputs, tick by tick.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/replay.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/compare/row_judge.h"
#include "core/compare/series_scale.h"
#include "core/host/controller_host.h"
#include "core/recording/initial_commands.h"
#include "core/run/run.h"
#include "output_record.h"
#include "recorded_delays.h"
#include "recorded_outputs.h"
#include "recorded_results.h"
#include "recorded_words.h"
#include "recording_source.h"
#include "variable_history.h"

namespace rehearse {

class ReplayComparison final : public Sink {
 public:
  /// The controllers must have started. Differences are added to the report. All references must outlive this.
  /// `scales`: the scales of the recorded commands, for the rules.
  ReplayComparison(const ReplayOptions& options, const std::vector<ToleranceRule>& rules, const Scenario& scenario,
                   mcap::Reader& recording, ControllerHost& host, const RecordingSource& source, SeriesScales scales,
                   ReplayReport& report);

  /// The channels that are compared.
  const std::vector<std::uint16_t>& channels() const { return channels_; }
  /// Compares what initialize() wrote into the command of the first step, if it acts in the first step.
  void compare_initial(const Command& command);
  /// Takes a message of the tick that is emitted next; ignores messages of channels that aren't compared.
  Result<void> take(const mcap::Message& message);
  Result<void> emit(const TickData& now) override;
  /// Takes the host's events since the last call.
  void take_events();
  /// Compares the last lines: no line follows in the recording or in the replay.
  void end_lines();
  /// After the last tick: judges the commands whose values may come early or late. Fails if the rest of the recording,
  /// as far as it matters, can't be read.
  Result<void> finish();
  /// True if hashes and events of all ticks so far are the recorded hashes and events.
  bool repeats_all() const { return !report_.first_other_hash && words_.same_events(); }

 private:
  bool is_compared(std::int64_t tick) const;
  void compare(const TickData& now, const std::vector<std::uint64_t>& row);
  TraceChannel channel_of_initial(const InitialNumber& number) const;
  void compare_inputs(const TickData& now);
  void end_where_inputs_are_lost(std::int64_t tick);
  void compare_variables(std::int64_t tick);
  void report_outputs(std::int64_t tick, const std::vector<std::uint64_t>& row);
  void differs(Divergence&& found);
  bool is_allowed(const Divergence& found) const;
  void report(Divergence&& found);
  void word_differs(Divergence&& found, std::int64_t tick);
  std::optional<std::size_t> judged_variable(const std::string& topic);

  const ReplayOptions& options_;
  const std::vector<ToleranceRule>& rules_;
  const Scenario& scenario_;
  mcap::Reader& recording_;
  ControllerHost& host_;
  const RecordingSource& source_;
  ReplayReport& report_;
  RecordedWords words_;
  OutputRecord record_;
  RowJudge judge_;
  RecordedOutputs outputs_;
  RecordedResults results_;
  RecordedDelays delays_;
  std::vector<std::uint16_t> channels_;
  enum class Reader { none, words, outputs, delays };
  std::vector<Reader> reader_of_;       // by channel id
  const std::uint64_t from_;            // [ns]
  std::optional<bool> reads_the_same_;  // controllers read the recorded set of inputs; decided at the first tick
  std::map<std::string, std::optional<std::size_t>> variables_;  // numbers in the judge by topic; none: not judged
  VariableHistory history_;
  bool is_recovered_ = false;         // a part of the recording is lost: channels may end before the ticks
  bool inputs_are_lost_ = false;      // from the present tick on: nothing is compared any more
  std::int64_t last_tick_ = -1;       // that was compared
  std::int64_t last_different_ = -1;  // tick
};

}  // namespace rehearse
