// RecordingSink: a run's ticks go into a trace.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/messages.h>

#include <cstdint>
#include <vector>

#include "recording/recorder.h"
#include "run.h"

namespace rehearse {

class RecordingSink : public Sink {
 public:
  /// `remarks` gets what is more than a controller's own line in the events, but for those of a log; null: nobody does.
  /// Both must outlive this.
  explicit RecordingSink(Recorder& recorder, Diagnostics* remarks = nullptr) : recorder_(recorder), remarks_(remarks) {}

  /// What touches in the ticks before this one touched before the run. What touches is known after a step: of a run
  /// that begins in the middle, the first that is known begins nothing.
  void take_contacts_for_known(std::int64_t before) { known_before_ = before; }

  Result<void> emit(const Moment& now) override;
  Result<void> record_events(const std::vector<msg::Event>& events);

 protected:
  /// What was commanded, the hashes and the events.
  Result<void> close_tick(const Moment& now);

  Recorder& recorder_;

 private:
  Result<void> record_contacts(const Moment& now);

  Diagnostics* remarks_;
  std::int64_t known_before_ = 0;
};

}  // namespace rehearse
