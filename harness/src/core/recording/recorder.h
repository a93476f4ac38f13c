// Recorder: writes a run into a trace, tick by tick. harness/TRACE_FORMAT.md describes the contents.
//
// A tick's messages contain the state at its beginning, the controllers' inputs and their commands; the message on
// /tick comes last and so closes the tick. The Recorder itself uses nothing that depends on the machine, the process or
// the time of day.
#pragma once

#include <rehearse/io.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/scenario.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/host/controller_host.h"
#include "core/trace/run_facts.h"
#include "trace_output.h"
#include "true_reading.h"

namespace rehearse {

/// The hashes in /tick.
struct TickHashes {
  std::uint64_t state = 0;
  std::uint64_t input = 0;
  std::uint64_t output = 0;
};

class Recorder {
 public:
  /// The metadata of the channels, by topic, that declare() would add to a recording.
  static std::map<std::string, mcap::StringMap> channels_of(const Scenario& scenario, const ControllerHost& host);
  /// Creates the file and writes the data known before the run: attachments (scenario, models, load reports) and the
  /// provenance.
  static Result<std::unique_ptr<Recorder>> create(const std::filesystem::path& file, const Scenario& scenario,
                                                  const mcap::StringMap& provenance);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Attaches further inputs of the run, before the channels are added.
  Result<void> attach(const std::string& name, const std::string& media_type, const std::string& text);
  Result<void> add_metadata(const std::string& name, const mcap::StringMap& values);
  /// States that the controllers' readings of this body's joints differ from the truth, although the scenario gives
  /// them no noise. Must be called before declare().
  void measure_joints(int body);
  /// Adds the channels; the controllers' tables must be fixed. Null: there are no controllers.
  void declare(const ControllerHost* host);
  /// Records the state at the beginning of a tick; for cameras and range sensors the captures that arrived at this
  /// tick. `read`: the observation for controllers, which differs where joints have noise.
  Result<void> record_state(std::int64_t tick, const Observation& seen, const Observation& read);
  /// Records the true values of sensors whose readings have errors.
  Result<void> record_truths(std::int64_t tick, const std::vector<TrueReading>& truths);
  /// Records the changes of contacts since the last call. `touching`: the contacts after the last step, from
  /// World::touching().
  Result<void> record_contacts(std::int64_t tick, const std::vector<LinkPair>& touching);
  /// Sets the existing contacts of a run that begins in the middle.
  void begin_with_contacts(const std::vector<LinkPair>& touching);
  /// Records the inputs and outputs of the controllers in the tick, and closes it. `host` null: the state after the
  /// last tick.
  Result<void> record_tick(std::int64_t tick, const ControllerHost* host, const TickHashes& hashes);
  /// Records the inputs of the controllers before they are called, and the end of the tick for the case that the
  /// process ends before record_tick(): the supervisor then closes the tick. Without a supervisor it has no effect.
  Result<void> record_inputs(std::int64_t tick, const ControllerHost& host, const TickHashes& hashes);

  Result<void> record_checkpoint(std::int64_t tick, std::span<const std::byte> state);
  Result<void> record_events(const std::vector<msg::Event>& events);
  /// Writes the `outcome`, the end of the run; the trace is complete afterwards.
  Result<void> close(const RunOutcome& outcome);
  /// True if close() failed because something else has changed the file.
  bool is_changed_by_others() const;

  const RecordingSize& size() const;
  /// Descriptor of the open file.
  int descriptor() const;

 private:
  friend class CopiedRecording;
  struct Impl;
  explicit Recorder(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// The name of the layout of a checkpoint's bytes: it changes with every change of World::save().
inline constexpr const char* checkpoint_format = "rehearse-ode-state-1";

}  // namespace rehearse
