// Recorder: writes a run into a trace, tick by tick. harness/TRACE_FORMAT.md says what stands where.
//
// A tick's messages carry the state at its beginning, what the controllers read of it and what they commanded; the
// message on /tick comes last and so closes the tick. Nothing here depends on the machine, the process or the time of
// day.
#pragma once

#include <rehearse/io.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/scenario.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/controller_host.h"
#include "trace/run_facts.h"
#include "trace_output.h"

namespace rehearse {

/// The hashes that stand in /tick.
struct TickHashes {
  std::uint64_t state = 0;
  std::uint64_t input = 0;
  std::uint64_t output = 0;
};

class Recorder {
 public:
  /// Creates the file and writes what is known before the run: attachments (scenario, models, load reports) and the
  /// provenance.
  static Result<std::unique_ptr<Recorder>> create(const std::filesystem::path& file, const Scenario& scenario,
                                                  const mcap::StringMap& provenance);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// More of what the run was made of, before the channels are made.
  Result<void> attach(const std::string& name, const std::string& media_type, const std::string& text);
  Result<void> add_metadata(const std::string& name, const mcap::StringMap& values);
  /// The controllers read this body's joints otherwise than they are, though the scenario gives them no noise. Before
  /// declare().
  void measure_joints(int body);
  /// Makes the channels; the controllers' tables are fixed by now. Null: there are none.
  void declare(const ControllerHost* host);
  /// The state at the beginning of a tick. Of cameras and range sensors: what arrived at this tick. `read`: the same as
  /// controllers read it, which differs where joints have noise.
  Result<void> record_state(std::int64_t tick, const Observation& seen, const Observation& read);
  /// Which links touch after the last step, as World::touching() tells; what has changed since the last call is
  /// written.
  Result<void> record_contacts(std::int64_t tick, const std::vector<LinkPair>& touching);
  /// A run that begins in the middle: these touched before already.
  void begin_with_contacts(const std::vector<LinkPair>& touching);
  /// What the controllers read and wrote in the tick; closes it. `host` null: the state after the last tick.
  Result<void> record_tick(std::int64_t tick, const ControllerHost* host, const TickHashes& hashes);
  // What another recording says, for a run that begins with it.

  /// The bytes of a message, on a topic that is made like the other's if it isn't there yet.
  Result<void> copy(const mcap::Message& message, const mcap::Schema& schema, const std::string& topic);
  /// Instead of the copies of such messages: readings that are other ones here.
  Result<void> record_measured_joints(std::int64_t tick, int body, const std::vector<JointReading>& joints);
  Result<void> record_reading(std::int64_t tick, int body, int device, const DeviceReading& reading);
  Result<void> record_joystick(std::int64_t tick, const JoystickReading& reading);

  Result<void> record_checkpoint(std::int64_t tick, std::span<const std::byte> state);
  Result<void> record_events(const std::vector<msg::Event>& events);
  /// `outcome` tells how the run ended; the trace is complete after it.
  Result<void> close(const RunOutcome& outcome);

  const RecordingSize& size() const;
  /// Of the open file.
  int descriptor() const;

 private:
  struct Impl;
  explicit Recorder(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Names the layout of a checkpoint's bytes: changes with every change of World::save().
inline constexpr const char* checkpoint_format = "rehearse-ode-state-1";

}  // namespace rehearse
