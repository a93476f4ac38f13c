// RecordingSink: writes a run's ticks into a trace.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/messages.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "core/recording/recorder.h"
#include "run.h"

namespace rehearse {

class RecordingSink : public Sink {
 public:
  /// `remarks` gets all events except a controller's own lines and events of a log; null: no remarks are collected.
  /// Recorder and remarks must outlive this.
  explicit RecordingSink(Recorder& recorder, Diagnostics* remarks = nullptr) : recorder_(recorder), remarks_(remarks) {}

  /// Contacts in the ticks before `before` count as contacts from before the run. Contacts are known only after a step:
  /// a run that begins in the middle doesn't record its first known contacts as changes.
  void take_contacts_for_known(std::int64_t before) { known_before_ = before; }

  /// Records checkpoint, state, sensors and contacts. The inputs are kept in case that the process ends in control().
  Result<void> begin_tick(const TickData& now) override;
  /// Records the commands, the hashes and the events.
  Result<void> emit(const TickData& now) override;
  Result<void> record_events(const std::vector<msg::Event>& events);

 protected:
  Recorder& recorder_;

 private:
  Result<void> record_contacts(const TickData& now);

  Diagnostics* remarks_;
  std::int64_t known_before_ = 0;
  std::optional<std::uint64_t> input_hash_;  // of the present tick, once its inputs are known
};

}  // namespace rehearse
