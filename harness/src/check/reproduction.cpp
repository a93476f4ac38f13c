#include <fmt/format.h>
#include <rehearse/check.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "compare/compare_parts.h"
#include "model/clock.h"
#include "replay/plant_level.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// What a run without controllers doesn't say of a tick.
bool is_said_by_controllers(const TraceChannel& channel, std::string_view element) {
  return channel.type == msg::Tick::type_name && element != "tick" && element != "state_hash";
}

/// A channel of a part of a run beside the same channel of the whole.
class ChannelInWhole {
 public:
  ChannelInWhole(const Trace& whole, const Trace& part, const TraceChannel& channel, const TickClock& clock)
      : whole_(whole), part_(part), channel_(channel), clock_(clock), other_(whole.find_channel(channel.topic)) {}

  Result<std::optional<Divergence>> first_difference() const;

 private:
  Divergence place(std::size_t message) const;
  std::size_t counterpart(std::size_t message) const;
  std::optional<Divergence> compare_row(std::size_t message, std::size_t other) const;
  Result<std::optional<Divergence>> compare_payload(std::size_t message, std::size_t other) const;

  const Trace& whole_;
  const Trace& part_;
  const TraceChannel& channel_;
  const TickClock& clock_;
  const TraceChannel* other_;
};

Divergence ChannelInWhole::place(std::size_t message) const {
  Divergence found;
  found.tick = clock_.tick_at(channel_.times[message]);
  found.time = static_cast<double>(channel_.times[message]) * 1e-9;
  found.channel = channel_.topic;
  found.stage = stage_of(channel_.topic);
  return found;
}

/// Of several messages of one time, that of the same number.
std::size_t ChannelInWhole::counterpart(std::size_t message) const {
  const auto first_at = [](const TraceChannel& channel, std::uint64_t time) {
    return std::lower_bound(channel.times.begin(), channel.times.end(), time) - channel.times.begin();
  };
  const std::uint64_t time = channel_.times[message];
  return static_cast<std::size_t>(first_at(*other_, time)) + message -
         static_cast<std::size_t>(first_at(channel_, time));
}

std::optional<Divergence> ChannelInWhole::compare_row(std::size_t message, std::size_t other) const {
  for (std::size_t column = 0; column < channel_.columns.size(); ++column) {
    const std::string& element = channel_.columns[column].element;
    if (is_said_by_controllers(channel_, element)) continue;
    const std::size_t there = column_of(*other_, element);
    const bool is_there = there < other_->columns.size();
    if (is_there && channel_.bits(message, column) == other_->bits(other, there)) continue;
    Divergence found = place(message);
    found.element = element;
    found.stage = stage_of(channel_.topic, element);
    if (!is_there) {
      found.note = "the recording hasn't it";
    } else if (element.ends_with("_hash")) {
      found.note = "is another hash";
    } else {
      put_numbers(found, other_->number(other, there), channel_.number(message, column),
                  unit_of(other_->metadata, element));
    }
    return found;
  }
  return std::nullopt;
}

Result<std::optional<Divergence>> ChannelInWhole::compare_payload(std::size_t message, std::size_t other) const {
  const auto here = part_.payload(channel_, message);
  if (!here) return here.errors();
  const auto there = whole_.payload(*other_, other);
  if (!there) return there.errors();
  if (*here == *there) return std::optional<Divergence>();
  Divergence found = place(message);
  found.note = is_picture(channel_) ? "is another picture" : "is another message";
  return std::optional(found);
}

Result<std::optional<Divergence>> ChannelInWhole::first_difference() const {
  for (std::size_t message = 0; message < channel_.messages(); ++message) {
    const std::size_t other = other_ ? counterpart(message) : 0;
    if (!other_ || other >= other_->messages() || other_->times[other] != channel_.times[message]) {
      Divergence found = place(message);
      found.note = "the recording says nothing then";
      return std::optional(found);
    }
    if (channel_.columns.empty()) {
      auto found = compare_payload(message, other);
      if (!found || *found) return found;
    } else if (auto found = compare_row(message, other)) {
      return found;
    }
  }
  return std::optional<Divergence>();
}

/// Ticks from which and until which the simulation is run again.
std::vector<std::pair<std::int64_t, std::int64_t>> sample_spans(const Trace& recording, double time_step, int wanted) {
  std::vector<std::int64_t> ends;  // checkpoints, and the end of the recording
  const auto tick_of = [&](std::uint64_t time) {
    return static_cast<std::int64_t>(std::llround(static_cast<double>(time) * 1e-9 / time_step));
  };
  if (const TraceChannel* checkpoints = recording.find_channel(run_topics::checkpoint))
    for (const std::uint64_t time : checkpoints->times) ends.push_back(tick_of(time));
  const TickClock clock(recording);
  if (!clock.empty() && (ends.empty() || ends.back() < tick_of(clock.last_time())))
    ends.push_back(tick_of(clock.last_time()));
  std::vector<std::pair<std::int64_t, std::int64_t>> spans;
  const std::int64_t all = std::ssize(ends) - 1, some = std::min<std::int64_t>(all, wanted);
  std::set<std::int64_t> chosen;
  for (std::int64_t i = 0; i < some; ++i) chosen.insert(some == 1 ? 0 : i * (all - 1) / (some - 1));
  for (const std::int64_t number : chosen) spans.emplace_back(ends[number], ends[number + 1]);
  return spans;
}

/// One recording on trial.
struct Trial {
  const Scenario& scenario;
  const Trace& recording;
  const fs::path& scratch;
  const ReproductionOptions& options;
  const Simulation& simulation;
  Reproduction result;

  Result<void> replay_controllers();
  Result<void> simulate_spans();
  Result<std::string> simulate(std::int64_t from, std::optional<std::int64_t> until);
  std::string text() const;
};

Result<void> Trial::replay_controllers() {
  ReplayOptions replaying;
  static_cast<HostOptions&>(replaying) = options;
  const auto replayed = replay(recording.file(), replaying);
  if (!replayed) return replayed.errors();
  result.replayed = replayed->ticks;
  result.failure = replayed->failure;
  result.first = replayed->first;
  return {};
}

/// Returns why no checkpoint could be used; empty if they could.
Result<std::string> Trial::simulate(std::int64_t from, std::optional<std::int64_t> until) {
  PlantOptions running;
  running.from = from;
  running.until = until;
  running.resync = false;
  if (auto made = make_folder_of(scratch); !made) return made.errors();
  const auto run = simulation.run_plant(scenario, recording, scratch, running);
  if (!run) return run.errors();
  result.simulated += run->ticks;
  ++result.spans;
  result.failure = run->failure;
  const auto part = Trace::load(scratch);
  if (!part) return part.errors();
  auto found = first_not_in(recording, *part);
  if (!found) return found.errors();
  result.first = *std::move(found);
  return run->from_the_start;
}

Result<void> Trial::simulate_spans() {
  const auto spans = sample_spans(recording, scenario.time_step, options.spans);
  bool whole = spans.empty();
  for (std::size_t i = 0; i < spans.size() && !whole && result.reproduced(); ++i) {
    if (options.progress) options.progress(static_cast<std::int64_t>(i), std::ssize(spans));
    const auto [from, until] = spans[i];
    const auto from_the_start = simulate(from, until);
    if (!from_the_start) return from_the_start.errors();
    whole = !from_the_start->empty();
  }
  if (whole && result.reproduced()) {
    result.spans = 0;
    if (auto done = simulate(0, std::nullopt); !done) return done.errors();
  }
  std::error_code ignored;
  fs::remove(scratch, ignored);
  return {};
}

std::string Trial::text() const {
  if (result.failure) return "the recording doesn't repeat itself: " + result.failure->message;
  if (result.first && (result.first->stage == Stage::controller || result.first->stage == Stage::inputs))
    return fmt::format(
        "the recording doesn't repeat itself: fed with its inputs, the controller differs at {}; `rehearse audit` "
        "tells "
        "what it depends on",
        to_string(*result.first));
  if (result.first)
    return fmt::format("the recording doesn't repeat itself: under its commands, the world differs at {}",
                       to_string(*result.first));
  return fmt::format(
      "the recording repeats itself, bit for bit: the commands of {} ticks on its inputs, and {} ticks of simulation "
      "in {} "
      "{}",
      result.replayed, result.simulated, result.spans, result.spans == 1 ? "span" : "spans from its checkpoints");
}

}  // namespace

Result<std::optional<Divergence>> first_not_in(const Trace& whole, const Trace& part) {
  const TickClock clock(whole);
  std::optional<Divergence> first;
  for (const TraceChannel& channel : part.channels()) {
    auto found = ChannelInWhole(whole, part, channel, clock).first_difference();
    if (!found) return found;
    if (*found && (!first || comes_before(**found, *first))) first = *std::move(found);
  }
  return first;
}

Result<Reproduction> reproduce(const Scenario& scenario, const Trace& recording, const fs::path& scratch,
                               const ReproductionOptions& options, const Simulation& simulation) {
  Trial trial{scenario, recording, scratch, options, simulation, {}};
  if (auto done = trial.replay_controllers(); !done) return done.errors();
  if (trial.result.reproduced())
    if (auto done = trial.simulate_spans(); !done) return done.errors();
  trial.result.verdict = trial.text();
  return std::move(trial.result);
}

}  // namespace rehearse
