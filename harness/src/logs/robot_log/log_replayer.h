// LogReplayer: one pass of the replay of a log, by a map. Internal.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>
#include <rehearse/model.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/guard/process_guard.h"
#include "core/host/controller_host.h"
#include "core/recording/recorder.h"
#include "core/run/hosted_commands.h"
#include "core/run/run.h"
#include "log_clocks.h"
#include "log_memory.h"
#include "log_observations.h"
#include "log_replay.h"
#include "log_sink.h"
#include "log_survey.h"
#include "log_tick_plan.h"
#include "log_ticks.h"
#include "logs/map/log_map.h"

namespace rehearse {

/// The result of one pass over a log, before its messages are fed.
struct SurveyedLog {
  std::shared_ptr<LogTimes> times;
  LogSurvey survey;
};

class LogReplayer {
 public:
  LogReplayer(mcap::Reader& log, const LogMap& map, std::shared_ptr<const Model> model,
              const std::filesystem::path& trace, const LogReplayOptions& options)
      : log_(log), map_(map), model_(std::move(model)), trace_(trace), options_(options) {}

  /// Surveys the log, and runs the controllers in a process that has run none if this one has own processes.
  /// `known`: of a replay by a map with the same topics, clocks and topic of ticks; null: the log is surveyed.
  Result<LogReplayReport> run(const std::vector<LogTopic>& topics, std::string log_hash,
                              const SurveyedLog* known = nullptr);
  /// Before run(): the survey is kept. It needs 8 bytes for each tick.
  void keep_survey() { keeps_survey_ = true; }
  /// After run(): the survey that was kept.
  SurveyedLog take_survey() { return {times_, std::move(survey_)}; }
  /// After run().
  const LogSurvey& survey() const { return survey_; }
  const std::vector<MappedSource>& sources() const { return sources_; }

 private:
  /// The result, and the commands that the options ask for.
  using Fed = std::pair<LogReplayReport, CommandRecord>;

  /// Runs the controllers.
  Result<Fed> feed();
  void convert_span();
  Result<void> find_span();
  std::int64_t first_tick_with(std::int64_t message) const;
  std::int64_t ticks_before(std::int64_t end, double all) const;
  Result<void> check_interval() const;
  Result<void> make_ticks(std::int64_t start, std::int64_t end);
  bool on_message(const mcap::Message& message);
  Result<void> run_ticks_before(std::int64_t time);
  Result<void> begin();
  Result<void> host_controller();
  Result<void> check_state();
  Result<void> take_state();
  Result<void> start_again(std::map<std::string, double> state);
  Result<Scenario> make_scenario(const BodyObservation& seen, std::vector<ToleranceRule> tolerances = {});
  Result<void> state_tolerances();
  mcap::StringMap provenance_of_log() const;
  void report_topics();
  void warn_of(const LogUnreadable& found, const LogSource& source);
  void report_ticks();
  void count_without_inputs();
  Result<void> finish();
  Result<void> close_file();

  /// Fewer commands after the last tick are those of a recorder that ended.
  static constexpr double ticks_of_an_end = 20.0;

  mcap::Reader& log_;
  const LogMap& map_;
  std::shared_ptr<const Model> model_;
  const std::filesystem::path& trace_;
  const LogReplayOptions& options_;
  LogSpan span_;                                 // of the options, on the clock of the ticks
  std::map<std::string, double*> state_places_;  // of the numbers that the controller takes back
  std::vector<MappedSource> sources_;
  std::shared_ptr<LogTimes> times_;
  bool keeps_survey_ = false;
  LogSurvey survey_;
  std::optional<TickPlan> plan_;  // none: the nominal grid
  std::optional<LogTicks> log_ticks_;
  std::int64_t ticks_ = 0;  // number of ticks to run
  std::optional<LogObservations> observations_;
  BodyObservation first_seen_;  // root and joints at the first tick; NaN for joints without a source
  std::optional<Scenario> scenario_;
  std::unique_ptr<ControllerHost> host_;
  std::unique_ptr<Recorder> recorder_;
  std::optional<ProtectedDescriptor> descriptor_;  // the recorder's
  std::optional<HostedCommands> commands_;
  std::optional<LogSink> sink_;
  std::optional<Run> run_;  // none before the first tick
  bool over_ = false;
  Diagnostics errors_;
  LogReplayReport report_;
};

}  // namespace rehearse
