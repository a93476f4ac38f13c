#include "run.h"

#include "core/guard/interruption.h"

#include <algorithm>
#include <utility>

namespace rehearse {

Result<bool> Run::step() {
  if (tick_ >= end_ || interruption_ || broke_down_ || commands_->failed()) return false;
  TickData now{tick_, command};
  const auto observed = source_->observe(now);
  if (!observed || !*observed) return observed;
  if ((interruption_ = interrupted_at(tick_, time_step_))) return false;

  commands_->prepare(now);
  REHEARSE_TRY(sink_->begin_tick(now));
  commands_->act(now);
  REHEARSE_TRY(sink_->emit(now));
  if (!now.alive) return false;
  const auto advanced = source_->advance(now, *commands_);
  if (!advanced) return advanced;

  broke_down_ = !*advanced;
  const std::int64_t done = ++tick_ - begin_;
  if (progress_ && done % std::max<std::int64_t>(1, all_ / 100) == 0) progress_(done, all_);
  return true;
}

Result<void> Run::go() {
  for (;;) {
    const auto going_on = REHEARSE_TRY(step());
    if (!going_on) return {};
  }
}

Result<void> Run::close() {
  TickData now{tick_, command, true};
  REHEARSE_TRY(source_->observe(now));
  REHEARSE_TRY(sink_->begin_tick(now));
  return sink_->emit(now);
}

void Run::change(ObservationSource& source, Sink& sink, std::int64_t end) {
  source_ = &source;
  sink_ = &sink;
  end_ = end;
}

void Run::report_progress(Progress report, std::int64_t all) {
  progress_ = std::move(report);
  begin_ = tick_;
  all_ = all;
}

}  // namespace rehearse
