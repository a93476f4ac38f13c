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
  if (auto taken = sink_->begin_tick(now); !taken) return taken.errors();
  commands_->act(now);
  if (auto emitted = sink_->emit(now); !emitted) return emitted.errors();
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
    const auto going_on = step();
    if (!going_on) return going_on.errors();
    if (!*going_on) return {};
  }
}

Result<void> Run::close() {
  TickData now{tick_, command, true};
  const auto observed = source_->observe(now);
  if (!observed) return observed.errors();
  if (auto taken = sink_->begin_tick(now); !taken) return taken;
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
