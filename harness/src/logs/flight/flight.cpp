#include "flight.h"

#include <fmt/format.h>
#include <rehearse/model.h>
#include <rehearse/tap.h>
#include <rehearse/tap_ring.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <thread>
#include <utility>

#include "base/text.h"
#include "base/write_hint.h"
#include "flight_writer.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds rest{2}, between_looks{100};
constexpr std::chrono::seconds between_syncs{1};
constexpr int most_ticks_at_once = 10'000;  // then the recorder looks at the clock, signals and the disk

/// FILE with a text behind its stem.
fs::path with_suffix(const fs::path& file, const std::string& suffix) {
  return file.parent_path() / (file.stem().string() + suffix + file.extension().string());
}

/// The first of FILE, FILE-2, FILE-3, ... that doesn't exist; of parts, of which FILE_0 doesn't.
fs::path next_free(const fs::path& file, bool in_parts) {
  const auto is_free = [&](const fs::path& name) {
    std::error_code ignored;
    return !fs::exists(fs::symlink_status(in_parts ? with_suffix(name, "_0") : name, ignored));
  };
  fs::path free = file;
  for (int number = 2; !is_free(free); ++number) free = with_suffix(file, fmt::format("-{}", number));
  return free;
}

/// The reason of the last mark of a tick; nullopt: it has none.
std::optional<std::string> mark_in(const TapTick& tick) {
  for (auto entry = tick.entries.rbegin(); entry != tick.entries.rend(); ++entry)
    if (entry->kind == tap_mark) return std::string(entry->text);
  return std::nullopt;
}

/// Ticks that don't follow each other.
class Gaps {
 public:
  /// The number of ticks that are missing before this one.
  std::int64_t before(std::int64_t tick) {
    const std::int64_t expected = std::exchange(next_, tick + 1);
    return expected == none ? 0 : tick - expected;
  }

 private:
  static constexpr std::int64_t none = std::numeric_limits<std::int64_t>::min();
  std::int64_t next_ = none;
};

/// Finds commands beyond the efforts of the model.
class EffortWatch {
 public:
  explicit EffortWatch(const FlightPlan& plan) : plan_(plan) {
    const Model& model = *plan.scenario.bodies[0].model;
    for (const TapSeries& series : plan.definitions.series) {
      std::vector<double>& limits = limits_.emplace_back();
      if (series.kind != TapSeries::Kind::commands || !(series.quantities & REHEARSE_TAP_U)) continue;
      for (const std::string& name : series.names) {
        const int link = model.find_joint(name);
        const double effort = link < 0 ? 0.0 : model.links[link].joint.effort;
        limits.push_back(effort > 0.0 ? effort : std::numeric_limits<double>::infinity());
      }
    }
  }

  /// "KNEE is commanded 120 N m, and its model allows 100"; empty: all are within their limits.
  std::string finding(const TapTick& tick) const {
    for (const TapEntry& entry : tick.entries) {
      if (entry.kind != tap_values || limits_[entry.series].empty()) continue;
      const std::vector<double>& limits = limits_[entry.series];
      const auto efforts = entry.numbers.last(limits.size());  // u comes after q and dq
      for (std::size_t i = 0; i < limits.size(); ++i)
        if (!(std::abs(efforts[i]) <= limits[i]))
          return fmt::format("the effort {:g} of joint {} is beyond the model's {:g}", efforts[i],
                             plan_.definitions.series[entry.series].names[i], limits[i]);
    }
    return {};
  }

 private:
  const FlightPlan& plan_;
  std::vector<std::vector<double>> limits_;  // by series and joint; empty: no efforts
};

class Recording {
 public:
  Recording(TapRing& ring, const std::string& name, const FlightOptions& options)
      : ring_(ring), name_(name), options_(options) {}

  Result<FlightReport> record();
  Result<FlightReport> save();

 private:
  void tell(const std::string& sentence) const {
    if (options_.tell) options_.tell(sentence);
  }
  Result<bool> wait_for_ticks();
  Result<void> begin_file();
  Result<void> write(const TapTick& tick);
  Result<bool> take_some();
  Result<void> take_rest();
  Result<bool> sync();
  Result<void> end_file(bool is_last);
  Result<void> drain();
  Result<void> watch();
  Result<void> keep(const std::string& reason);
  Result<void> write_span(std::int64_t first, std::int64_t last);
  bool stops() const { return options_.stops && options_.stops(); }
  std::int64_t ticks_of_black_box() const {
    return std::max<std::int64_t>(1, std::llround(options_.seconds.value_or(ring_.seconds()) / ring_.time_step()));
  }

  TapRing& ring_;
  const std::string& name_;
  const FlightOptions& options_;
  std::unique_ptr<FlightPlan> plan_;
  std::unique_ptr<FlightWriter> writer_;
  fs::path base_;  // of the files
  TapTick tick_;
  Gaps gaps_;
  std::int64_t last_ = 0;  // the newest tick in the files
  FlightReport report_;
};

/// False: the loop ended without a tick, or the recording stops.
Result<bool> Recording::wait_for_ticks() {
  while (!ring_.has_ticks()) {
    if (stops()) {
      report_.end = FlightEnd::stopped;
      return false;
    }
    if (!ring_.has_loop() && !ring_.has_ticks()) {
      report_.end = ring_.is_closed() ? FlightEnd::closed : FlightEnd::loop_ended;
      return false;
    }
    std::this_thread::sleep_for(rest);
  }
  return true;
}

Result<void> Recording::begin_file() {
  const bool in_parts = options_.part_size > 0 && !options_.is_black_box;
  if (!in_parts || report_.files.empty()) base_ = next_free(options_.output, in_parts);
  // Named as the files of rosbag2 are: a folder of them is read as one recording.
  const fs::path file = in_parts ? with_suffix(base_, fmt::format("_{}", report_.files.size())) : base_;
  auto writer = FlightWriter::create(file, *plan_);
  if (!writer) {
    Diagnostic found = writer.errors()[0];
    if (found.file.empty()) found.file = file.string();
    return found;
  }
  writer_ = *std::move(writer);
  report_.files.push_back(file);
  tell(fmt::format("recording into {}", file.string()));
  return {};
}

Result<void> Recording::write(const TapTick& tick) {
  if (!writer_) REHEARSE_TRY(begin_file());
  if (const std::int64_t missing = gaps_.before(tick.tick); missing != 0) {
    report_.missing += std::max<std::int64_t>(0, missing);
    const std::string text =
        missing > 0 ? fmt::format("{} before this one are missing: they were overwritten before they were recorded",
                                  count_text(missing, "tick"))
                    : std::string("the loop counts its ticks backwards");
    REHEARSE_TRY(writer_->write_event(tick.tick, "warning", text));
  }
  last_ = tick.tick;
  ++report_.ticks;
  return writer_->write(tick, ring_.dropped());
}

/// Takes ticks that are there. True: there were some.
Result<bool> Recording::take_some() {
  for (int i = 0; i < most_ticks_at_once; ++i) {
    switch (ring_.take(plan_->definitions, tick_)) {
      case TapRing::Got::nothing: return i > 0;
      case TapRing::Got::tick: REHEARSE_TRY(write(tick_)); break;
      case TapRing::Got::overtaken: break;
      case TapRing::Got::damaged: ++report_.damaged;
    }
  }
  return true;
}

/// Takes all ticks that are there now. A loop that goes on may write more.
Result<void> Recording::take_rest() {
  for (const std::uint64_t end = ring_.end(); ring_.place() < end;)
    if (!REHEARSE_TRY(take_some())) break;
  return {};
}

/// Writes to the disk. False: the disk is full.
Result<bool> Recording::sync() {
  if (!writer_) return true;
  REHEARSE_TRY(writer_->sync());
  ring_.state_saved();
  if (options_.part_size > 0 && writer_->size() > options_.part_size) REHEARSE_TRY(end_file(false));
  std::error_code failed;
  const fs::path folder = fs::absolute(report_.files.back(), failed).parent_path();
  const fs::space_info space = fs::space(folder, failed);
  return failed || space.available >= options_.keep_free;
}

Result<void> Recording::end_file(bool is_last) {
  if (!writer_) return {};
  auto closed = writer_->close(is_last ? std::optional(last_ + 1) : std::nullopt);
  writer_.reset();
  if (closed) ring_.state_saved();
  return closed;
}

/// Records everything.
Result<void> Recording::drain() {
  Clock::time_point synced = Clock::now(), looked = synced;
  for (;;) {
    const bool is_stopped = stops();
    bool has_loop = true;
    if (const auto now = Clock::now(); now - looked >= between_looks) {
      looked = now;
      has_loop = ring_.has_loop();
    }
    if (is_stopped || !has_loop) {  // after the look nothing follows the loop's end
      REHEARSE_TRY(take_rest());
      report_.end = is_stopped ? FlightEnd::stopped : ring_.is_closed() ? FlightEnd::closed : FlightEnd::loop_ended;
      return end_file(true);
    }
    const bool has_taken = REHEARSE_TRY(take_some());
    if (const auto now = Clock::now(); now - synced >= between_syncs) {
      synced = now;
      const bool has_room = REHEARSE_TRY(sync());
      if (!has_room) {
        report_.end = FlightEnd::disk_full;
        return end_file(true);
      }
    }
    if (!has_taken) std::this_thread::sleep_for(rest);
  }
}

/// Writes the ticks of the ring from `first` to `last` into a file of their own.
Result<void> Recording::write_span(std::int64_t first, std::int64_t last) {
  plan_ = REHEARSE_TRY(FlightPlan::of(ring_, name_, last + 1));
  gaps_ = {};
  ring_.begin_with_oldest();
  for (;;) {
    const TapRing::Got got = ring_.take(plan_->definitions, tick_);
    if (got == TapRing::Got::nothing) break;
    if (got == TapRing::Got::damaged) ++report_.damaged;
    if (got == TapRing::Got::tick && tick_.tick >= first && tick_.tick <= last) REHEARSE_TRY(write(tick_));
    if (got == TapRing::Got::tick && tick_.tick >= last) break;
  }
  return end_file(true);
}

/// Keeps the seconds before the newest tick.
Result<void> Recording::keep(const std::string& reason) {
  const std::int64_t newest = tick_.tick;
  tell(reason);
  return write_span(newest - ticks_of_black_box() + 1, newest);
}

/// Waits for what a black box is kept for.
Result<void> Recording::watch() {
  ring_.take_all();
  const EffortWatch efforts(*plan_);
  const std::unique_ptr<FlightPlan> watched = std::move(plan_);  // keep() makes one for each file
  std::int64_t kept = -ticks_of_black_box();                     // the last tick in a file because of an effort
  bool has_ticks = false;
  for (;;) {
    const bool is_stopped = stops(), has_loop = ring_.has_loop();
    std::string reason;
    bool has_taken = false;
    for (const std::uint64_t end = ring_.end(); reason.empty() && ring_.place() < end;) {
      const TapRing::Got got = ring_.take(watched->definitions, tick_);
      if (got == TapRing::Got::nothing) break;
      report_.damaged += got == TapRing::Got::damaged ? 1 : 0;
      if (got != TapRing::Got::tick) continue;
      has_ticks = has_taken = true;
      if (const auto mark = mark_in(tick_)) {
        reason = fmt::format("the loop set a mark: {}", *mark);
      } else if (tick_.tick - kept >= ticks_of_black_box()) {
        reason = efforts.finding(tick_);
        if (!reason.empty()) kept = tick_.tick;
      }
    }
    const bool is_whole = reason.empty();  // all ticks up to the look at the loop are taken
    if (options_.keeps_now && options_.keeps_now()) reason = "a signal asks for the last seconds";
    if (is_whole && !has_loop && !ring_.is_closed()) reason = "the loop's process ended without closing its tap";
    if (has_ticks && !reason.empty()) REHEARSE_TRY(keep(reason));
    if (is_whole && (is_stopped || !has_loop)) {
      report_.end = is_stopped ? FlightEnd::stopped : ring_.is_closed() ? FlightEnd::closed : FlightEnd::loop_ended;
      return {};
    }
    if (!has_taken) std::this_thread::sleep_for(rest);
  }
}

Result<FlightReport> Recording::record() {
  const bool has_ticks = REHEARSE_TRY(wait_for_ticks());
  if (has_ticks) {
    plan_ = REHEARSE_TRY(FlightPlan::of(ring_, name_, std::nullopt));
    report_.remarks = plan_->remarks;
    const auto done = options_.is_black_box ? watch() : drain();
    if (!done) {
      static_cast<void>(end_file(true));  // it reports the same error
      return done.errors();
    }
  }
  report_.dropped = ring_.dropped();
  report_.refused = ring_.refused();
  return report_;
}

Result<FlightReport> Recording::save() {
  if (!ring_.has_ticks()) return error(fmt::format("the ring of '{}' has no ticks", name_));
  plan_ = REHEARSE_TRY(FlightPlan::of(ring_, name_, std::nullopt));
  report_.remarks = plan_->remarks;
  bool has_tick = false;
  std::int64_t newest = 0;
  for (TapRing::Got got; (got = ring_.take(plan_->definitions, tick_)) != TapRing::Got::nothing;) {
    if (got != TapRing::Got::tick) continue;
    has_tick = true;
    newest = tick_.tick;
  }
  if (!has_tick) return error(fmt::format("the ring of '{}' is damaged: no tick can be read", name_));
  const std::int64_t first = options_.seconds ? newest - ticks_of_black_box() + 1 : 0;
  REHEARSE_TRY(write_span(first, newest));
  report_.dropped = ring_.dropped();
  report_.refused = ring_.refused();
  report_.end = ring_.has_loop() ? FlightEnd::stopped : FlightEnd::loop_ended;
  return report_;
}

}  // namespace

Result<FlightReport> record_flight(TapRing& ring, const std::string& name, const FlightOptions& options) {
  return Recording(ring, name, options).record();
}

Result<FlightReport> save_ring(TapRing& ring, const std::string& name, const FlightOptions& options) {
  return Recording(ring, name, options).save();
}

}  // namespace rehearse
