#include "replayed_outputs.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <tuple>

#include "base/clock.h"
#include "core/kinds/channel_name.h"
#include "core/replay/replay_recording.h"
#include "core/trace/run_facts.h"

namespace rehearse {
namespace {

/// A difference as stored in the file.
struct StoredDifference {
  std::uint64_t place = 0;
  std::int64_t tick = 0;
  double expected = 0.0;
  double actual = 0.0;
};

/// A new temporary file, which is removed with this object.
class ScratchFile {
 public:
  ScratchFile() {
    std::error_code failed;
    std::string name = (std::filesystem::temp_directory_path(failed) / "rehearse-step-XXXXXX").string();
    if (const int descriptor = failed ? -1 : mkstemp(name.data()); descriptor >= 0) {
      ::close(descriptor);
      path_ = name;
    }
  }
  ~ScratchFile() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove(path_, ignored);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The events that a channel has at that log time.
std::vector<msg::Event> events_at(MessageFinder* finder, std::uint16_t channel, std::uint64_t time) {
  std::vector<msg::Event> all;
  if (!finder) return all;
  for (const MessageFinder::Found& found : finder->at(channel, time)) {
    CdrReader reader(found.data);
    msg::Event event;
    if (msg::decode(reader, event)) all.push_back(std::move(event));
  }
  return all;
}

}  // namespace

std::optional<std::uint64_t> nearest_message(MessageFinder& finder, std::uint16_t channel, std::uint64_t time,
                                             Direction direction) {
  if (direction == Direction::backwards && time == 0) return std::nullopt;
  const auto found =
      direction == Direction::forwards ? finder.next(channel, time + 1) : finder.latest(channel, time - 1);
  return found ? std::optional(found->time) : std::nullopt;
}

/// Writes the outputs of a replay into the file.
class ReplayedOutputs::Writing {
 public:
  Writing(ReplayedOutputs& outputs, mcap::Writer& writer, double time_step)
      : outputs_(outputs), writer_(writer), time_step_(time_step) {
    outputs.differences_ = writer.add_channel(0, "/differences", "");
    outputs.events_ = writer.add_channel(0, run_topics::events, "cdr");
    outputs.threads_ = writer.add_channel(0, "/threads", "cdr");
  }

  void add(const Divergence& found) {
    if (!pending_.empty() && pending_.front().tick != found.tick) flush();
    pending_.push_back({place_of(found), found.tick, found.expected, found.actual});
  }
  void add(const msg::Event& event) { write(outputs_.events_, event.tick, event); }
  void add_threads(std::int64_t tick, const std::vector<std::string>& sentences) {
    for (const std::string& sentence : sentences) {
      msg::Event event;
      event.tick = tick;
      event.text = sentence;
      write(outputs_.threads_, tick, event);
    }
  }
  void add_variable(std::int64_t tick, const std::string& series, double value) {
    const auto [entry, is_new] = variables_.try_emplace(series, std::uint16_t{0});
    if (is_new) {
      const auto schema = writer_.add_schema(msg::Float64::type_name, "ros2msg", msg::schema_text<msg::Float64>());
      entry->second = writer_.add_channel(schema, "/" + series, "cdr");
    }
    write(entry->second, tick, msg::Float64{value});
  }
  void flush() {
    if (pending_.empty()) return;
    const std::uint64_t time = nanoseconds_of(pending_.front().tick, time_step_);
    keep(writer_.write(outputs_.differences_, time, time, std::as_bytes(std::span(pending_))));
    pending_.clear();
  }
  const Diagnostics& problems() const { return problems_; }

 private:
  template <class T>
  void write(std::uint16_t channel, std::int64_t tick, const T& message) {
    cdr_.reset();
    msg::encode(message, cdr_);
    const std::uint64_t time = nanoseconds_of(tick, time_step_);
    keep(writer_.write(channel, time, time, cdr_.bytes()));
  }
  std::uint64_t place_of(const Divergence& found) {
    const auto [entry, is_new] =
        known_.try_emplace({found.channel, found.element, found.note}, outputs_.places_.size());
    if (is_new) outputs_.places_.push_back({found.channel, found.element, found.unit, found.note, found.stage});
    return entry->second;
  }
  void keep(const Result<void>& written) {
    if (!written && problems_.empty()) problems_ = written.errors();
  }

  ReplayedOutputs& outputs_;
  mcap::Writer& writer_;
  const double time_step_;
  CdrWriter cdr_;
  std::vector<StoredDifference> pending_;
  std::map<std::tuple<std::string, std::string, std::string>, std::uint64_t> known_;
  std::map<std::string, std::uint16_t> variables_;  // channels by series
  Diagnostics problems_;
};

std::unique_ptr<ReplayedOutputs> ReplayedOutputs::make(mcap::Reader& trace, const Scenario& scenario,
                                                       const SteppingOptions& options, std::optional<double> until) {
  auto made = std::make_unique<ReplayedOutputs>();
  made->time_step_ = scenario.time_step;
  const bool has_controllers =
      std::ranges::any_of(scenario.bodies, [](const ScenarioBody& body) { return !body.controllers.empty(); });
  if (!has_controllers || !options.replay) return made;
  const ScratchFile scratch;
  auto writer = mcap::Writer::create(scratch.path());
  if (!writer) {
    made->remarks_ = writer.errors();
    return made;
  }
  Writing writing(*made, **writer, scenario.time_step);
  ReplayOptions replaying;
  static_cast<HostOptions&>(replaying) = options;
  replaying.until = until;
  replaying.progress = options.progress;
  replaying.on_difference = replaying.on_word = [&writing](const Divergence& found) { writing.add(found); };
  replaying.on_variable = [&writing](std::int64_t tick, const std::string& series, double value) {
    writing.add_variable(tick, series, value);
  };
  replaying.on_threads = [&writing](std::int64_t tick, const std::vector<std::string>& sentences) {
    writing.add_threads(tick, sentences);
  };
  replaying.on_event = [&writing](const msg::Event& event) { writing.add(event); };
  const Result<ReplayReport> report = replay_recording(trace, scenario, replaying, Damage::tolerate);
  writing.flush();
  if (!report) {
    append_as_warnings(report.errors(), made->remarks_);
    made->remarks_.push_back(warning("the controllers can't be replayed: all shown values are recorded ones"));
    return made;
  }
  // A flight states no library: its controller was a robot's loop.
  if (!report->other_controllers.empty() && !RunFacts::of(trace).is_of_flight)
    made->remarks_.push_back(
        warning(fmt::format("the library of {} isn't the one that was recorded: commands may differ for that",
                            fmt::join(report->other_controllers, ", "))));
  for (const Diagnostic& remark : report->remarks) made->remarks_.push_back(remark);
  made->failure_ = report->failure;
  // The tick in which a controller failed is incomplete.
  const std::int64_t reached = report->ticks - 1;
  if (reached >= 0) made->last_tick_ = reached;
  const auto closed = (*writer)->close();
  auto finder = writing.problems().empty() && closed
                    ? MessageFinder::open(scratch.path())
                    : Result<std::unique_ptr<MessageFinder>>(closed ? writing.problems() : closed.errors());
  if (finder) {
    made->finder_ = std::move(*finder);
  } else {
    made->last_tick_.reset();
    made->remarks_.insert(made->remarks_.end(), finder.errors().begin(), finder.errors().end());
  }
  return made;
}

std::vector<Divergence> ReplayedOutputs::differences(std::uint64_t time) const {
  std::vector<Divergence> all;
  if (!finder_) return all;
  for (const MessageFinder::Found& found : finder_->at(differences_, time)) {
    std::vector<StoredDifference> stored(found.data.size() / sizeof(StoredDifference));
    if (!stored.empty()) std::memcpy(stored.data(), found.data.data(), stored.size() * sizeof(StoredDifference));
    for (const StoredDifference& difference : stored) {
      const Place& place = places_[difference.place];
      Divergence divergence;
      divergence.tick = difference.tick;
      divergence.time = time_of(difference.tick, time_step_);
      divergence.channel = place.channel;
      divergence.element = place.element;
      divergence.note = place.note;
      divergence.stage = place.stage;
      put_numbers(divergence, difference.expected, difference.actual, place.unit);
      all.push_back(std::move(divergence));
    }
  }
  return all;
}

std::vector<msg::Event> ReplayedOutputs::events(std::uint64_t time) const {
  return events_at(finder_.get(), events_, time);
}

std::vector<std::string> ReplayedOutputs::threads(std::uint64_t time) const {
  std::vector<std::string> all;
  for (msg::Event& event : events_at(finder_.get(), threads_, time)) all.push_back(std::move(event.text));
  return all;
}

bool ReplayedOutputs::differs_at(std::uint64_t time) const {
  return finder_ && finder_->latest(differences_, time, time).has_value();
}

std::optional<std::uint64_t> ReplayedOutputs::difference_beside(std::uint64_t time, Direction direction) const {
  return finder_ ? nearest_message(*finder_, differences_, time, direction) : std::nullopt;
}

std::optional<std::uint64_t> ReplayedOutputs::event_beside(std::uint64_t time, Direction direction) const {
  return finder_ ? nearest_message(*finder_, events_, time, direction) : std::nullopt;
}

}  // namespace rehearse
