#include <fmt/format.h>
#include <rehearse/scenario.h>
#include <rehearse/session.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "base/text.h"
#include "branch_source.h"
#include "closed_loop.h"
#include "core/guard/float_mode.h"
#include "core/recording/provenance.h"
#include "core/replay/chunk_copy.h"
#include "core/replay/copying_sink.h"
#include "core/replay/recording_source.h"
#include "core/replay/replay_comparison.h"
#include "core/replay/replay_recording.h"
#include "core/scenario/branch_origin.h"
#include "core/trace/run_facts.h"
#include "led_world.h"
#include "recorded_checkpoints.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

class Branch {
 public:
  Branch(const BranchPoint& from, fs::path trace, const BranchOptions& options)
      : from_(from), file_(from.trace.string()), trace_(std::move(trace)), options_(options) {}

  Result<BranchSummary> make();

 private:
  Result<void> open();
  Result<void> find_moment();
  Result<void> set_end();
  Result<void> add_pushes();
  Result<std::vector<std::string>> altered_before() const;
  std::optional<BranchSummary> go_on_as_recorded();
  Result<void> replay_before(const std::vector<std::string>& altered);
  Result<void> create(ClosedLoop& loop);
  Result<void> lead_world(ClosedLoop& loop);
  Result<void> choose_checkpoint();
  Result<void> repeat_source(ClosedLoop& loop);
  Result<void> copy_source(ClosedLoop& loop);
  Result<BranchSummary> go_on();

  const BranchPoint& from_;
  const std::string file_;
  const fs::path trace_;
  const BranchOptions& options_;
  std::optional<BranchSource> source_;
  Scenario* scenario_ = nullptr;  // the source's, with the branch's own end and pushes
  BranchOrigin origin_;
  std::optional<RecordedCheckpoints> checkpoints_;
  std::int64_t checkpoint_ = 0;  // tick at which the world begins
  Command moved_;                // the commands that moved the world before the moment
  BranchSummary summary_;
  bool repeats_ = false;  // the controllers are assumed to repeat the recording before the moment
};

Result<void> Branch::open() {
  auto source = REHEARSE_TRY(BranchSource::open(from_.trace, options_.scenario));
  source_.emplace(std::move(source));
  scenario_ = &source_->scenario;
  return {};
}

Result<void> Branch::find_moment() {
  const double step = scenario_->time_step;
  const double wanted = from_.tick ? static_cast<double>(*from_.tick) : std::round(*from_.time / step);
  if (!(wanted <= static_cast<double>(source_->whole_ticks)))
    return error_in(file_,
                    fmt::format("its last whole tick is {} ({:g} s){}, before {}", source_->whole_ticks - 1,
                                time_of(source_->whole_ticks - 1, step),
                                source_->recording.damage().empty() ? "" : ", where it is cut or damaged",
                                from_.tick ? fmt::format("tick {}", *from_.tick) : fmt::format("{:g} s", *from_.time)),
                    fmt::format("branch from @tick:{} at the latest", source_->whole_ticks));
  origin_.tick = static_cast<std::int64_t>(wanted);
  origin_.time = time_of(origin_.tick, step);
  return {};
}

Result<void> Branch::set_end() {
  if (options_.until) scenario_->duration = *options_.until;
  if (options_.duration) scenario_->duration = origin_.time + *options_.duration;
  const bool too_long = !(scenario_->duration <= Scenario::max_duration);
  if (!too_long && scenario_->ticks() > origin_.tick) return {};
  return error_in(file_,
                  too_long ? fmt::format("a run to {:g} s is too long", scenario_->duration)
                           : fmt::format("there is nothing to simulate: the branch begins at {:g} s and ends at {:g} s",
                                         origin_.time, scenario_->duration),
                  too_long ? fmt::format("expected at most {:g} s", Scenario::max_duration)
                           : "state the end, --until S, or the length, --duration S");
}

Result<void> Branch::add_pushes() {
  Diagnostics findings;
  for (const std::string& text : options_.push) {
    const auto push = parse_push(text, *scenario_);
    if (!push) {
      findings.insert(findings.end(), push.errors().begin(), push.errors().end());
    } else if (push->from < origin_.time) {
      findings.push_back(
          error(fmt::format("the push '{}' begins at {:g} s, before the moment {:g} s: the time before it "
                            "is recorded already",
                            text, push->from, origin_.time)));
    } else {
      scenario_->pushes.push_back(*push);
    }
  }
  if (!findings.empty()) return findings;
  origin_.push = source_->origin ? source_->origin->push : std::vector<std::string>();
  origin_.push.insert(origin_.push.end(), options_.push.begin(), options_.push.end());
  return {};
}

Result<void> Branch::choose_checkpoint() {
  checkpoints_.emplace(checkpoints_before(source_->recording, *scenario_, origin_.tick));
  const auto objection = REHEARSE_TRY(checkpoints_->objection());
  checkpoint_ = objection.empty() ? latest_checkpoint(*checkpoints_, *scenario_, origin_.tick) : 0;
  origin_.checkpoint = checkpoint_ > 0 ? fmt::format("tick {}", checkpoint_) : "none, from the start";
  summary_.world = checkpoint_ > 0
                       ? fmt::format(
                             "the world was set to the checkpoint of tick {} and led to tick {} by the recorded "
                             "commands",
                             checkpoint_, origin_.tick)
                       : fmt::format("the world was led from the start to tick {} by the recorded commands{}",
                                     origin_.tick, objection.empty() ? "" : ": " + objection);
  return {};
}

/// The alterations of inputs that begin before the moment.
Result<std::vector<std::string>> Branch::altered_before() const {
  std::vector<std::string> before;
  for (const std::string& text : options_.set) {
    const auto altered = REHEARSE_TRY(AlteredInputs::parse({text}, *scenario_));
    if (altered.begins() < origin_.tick) before.push_back(text);
  }
  return before;
}

/// Replays the controllers before the moment, and compares with the recorded outputs.
Result<void> Branch::replay_before(const std::vector<std::string>& altered) {
  ReplayOptions replaying;
  static_cast<HostOptions&>(replaying) = options_;
  replaying.on_message = nullptr;  // the lines come again
  replaying.until = origin_.time;
  replaying.set = altered;
  summary_.before = REHEARSE_TRY(replay_recording(*source_->reader, *scenario_, replaying));
  if (!summary_.before.failure) return {};
  return error_in(file_, "before the moment, " + summary_.before.failure->message);
}

Result<void> Branch::create(ClosedLoop& loop) {
  loop.altered = REHEARSE_TRY(AlteredInputs::parse(options_.set, *scenario_));
  REHEARSE_TRY(loop.create(trace_, options_));
  origin_.set = options_.set;
  const RunFacts source = RunFacts::of(source_->recording);
  for (const auto& [fact, library] : controller_facts(*loop.host))
    if (source.stated(fact) != library) origin_.controllers.push_back(fact.substr(fact.find('.') + 1) + " " + library);
  if (repeats_ && !origin_.controllers.empty()) return error("the controllers aren't the recorded ones");
  if (!summary_.before.equal() || !summary_.before.same_controllers)
    origin_.acted_until = origin_.tick;
  else if (source_->origin && source_->origin->acted_until)
    origin_.acted_until = std::min(*source_->origin->acted_until, origin_.tick);
  REHEARSE_TRY(loop.recorder->add_metadata(records::branch, origin_.metadata()));
  if (const mcap::StringMap* written = source_->recording.find_metadata(records::initial_commands))
    REHEARSE_TRY(loop.recorder->add_metadata(records::initial_commands, *written));
  for (std::size_t body = 0; body < scenario_->bodies.size(); ++body)
    if (loop.altered.alters_joints(static_cast<int>(body))) loop.recorder->measure_joints(static_cast<int>(body));
  loop.initialize();
  REHEARSE_TRY(loop.altered.check_read_by(*loop.host));
  loop.start();
  return {};
}

/// Moves the world to its state at the moment, with all pending captures.
Result<void> Branch::lead_world(ClosedLoop& loop) {
  auto led = REHEARSE_TRY(rehearse::lead_world(*scenario_, source_->recording, *checkpoints_, checkpoint_, origin_.tick,
                                               *loop.plant, *loop.world, *loop.recorder));
  moved_ = std::move(led.command);
  const auto recorded = source_->state_hash(origin_.tick);
  if (!recorded || loop.plant->world().state_hash() == *recorded) return {};
  summary_.run.remarks.push_back(
      warning(fmt::format("led by the recorded commands, the world at tick {} isn't the recorded one, bit for bit",
                          origin_.tick),
              "another version or another arithmetic recorded it, or it doesn't repeat itself: run rehearse check"));
  return {};
}

/// Copies the source up to the moment as it is stored, and replays its inputs into the controllers. Fails if they don't
/// repeat everything that they did in the source.
Result<void> Branch::repeat_source(ClosedLoop& loop) {
  mcap::Reader& reader = *source_->reader;
  const std::uint64_t moment = nanoseconds_of(origin_.tick, scenario_->time_step);
  ChunkCopy copy(reader, *loop.recorder, moment);
  if (!copy.is_possible()) return in_recording(reader, error("its chunks can't be copied"));
  ReplayOptions replaying;
  static_cast<HostOptions&>(replaying) = options_;
  RecordingSource inputs(*scenario_, reader, *loop.host, loop.altered);
  ReplayReport& before = summary_.before;
  before.controllers = static_cast<int>(loop.host->controllers().size());
  const std::vector<ToleranceRule> none;  // a difference of one bit suffices
  ReplayComparison comparison(replaying, none, *scenario_, reader, *loop.host, inputs, {}, before);
  std::vector<std::uint16_t> channels = inputs.channels();
  for (const auto& more : {comparison.channels(), copy.picture_channels()})
    channels.insert(channels.end(), more.begin(), more.end());
  const auto take = [&](const mcap::Message& message) {
    auto copied = copy.take(message);
    return copied ? comparison.take(message) : copied;
  };
  comparison.take_events();
  loop.run->change(inputs, comparison, origin_.tick);
  REHEARSE_TRY(inputs.drive(*loop.run, take, channels, moment));
  comparison.end_lines();
  REHEARSE_TRY(comparison.finish());
  if (loop.run->tick() < origin_.tick || !comparison.repeats_all() || !before.equal() || before.words.different > 0)
    return error("the controllers don't repeat the recording");
  REHEARSE_TRY(copy.finish());
  summary_.copied_chunks = static_cast<std::int64_t>(copy.chunks());
  return {};
}

/// Copies the observations of the source up to the moment, and records what the controllers do with them.
Result<void> Branch::copy_source(ClosedLoop& loop) {
  RecordingSource inputs(*scenario_, *source_->reader, *loop.host, loop.altered);
  CopyingSink copy(*scenario_, *source_->reader, *loop.host, *loop.recorder, loop.altered);
  copy.keep_acted(origin_.acted_until, source_->origin ? source_->origin->acted_until : std::nullopt);
  loop.run->change(inputs, copy, origin_.tick);
  REHEARSE_TRY(copy.copy(inputs, *loop.run, origin_.tick));
  if (loop.host->failure()) return error_in(file_, "before the moment, " + loop.host->failure()->message);
  return {};
}

Result<BranchSummary> Branch::make() {
  REHEARSE_TRY(open());
  std::error_code ignored;
  if (fs::equivalent(from_.trace, trace_, ignored))
    return error_in(trace_.string(), "that is the recording to branch from", "name another file for the branch");
  REHEARSE_TRY(find_moment());
  REHEARSE_TRY(set_end());
  REHEARSE_TRY(add_pushes());
  REHEARSE_TRY(choose_checkpoint());
  origin_.source = REHEARSE_TRY(name_and_hash(from_.trace));
  const auto altered = REHEARSE_TRY(altered_before());
  if (altered.empty())
    if (auto run = go_on_as_recorded()) return *std::move(run);
  REHEARSE_TRY(replay_before(altered));

  auto run = go_on();
  if (run) return run;
  fs::remove(trace_, ignored);
  return run.errors();
}

/// Assumes that the controllers repeat the recording before the moment, as they do unless they were changed. None: they
/// don't, or the recording can't be copied as it is stored. Then a replay has to find the differences first, because
/// the branch states them before its messages.
std::optional<BranchSummary> Branch::go_on_as_recorded() {
  const BranchOrigin origin = origin_;
  const BranchSummary summary = summary_;
  repeats_ = true;
  summary_.before.same_controllers = true;
  if (auto run = go_on()) return *std::move(run);
  repeats_ = false;
  origin_ = origin;
  summary_ = summary;
  std::error_code ignored;
  fs::remove(trace_, ignored);
  return std::nullopt;
}

/// Runs the branch itself; its source was checked, or is assumed to be repeated.
Result<BranchSummary> Branch::go_on() {
  ClosedLoop loop(*scenario_);
  REHEARSE_TRY(create(loop));
  REHEARSE_TRY(lead_world(loop));
  REHEARSE_TRY(repeats_ ? repeat_source(loop) : copy_source(loop));
  auto run =
      REHEARSE_TRY(loop.go_on(std::move(moved_), source_->checkpoint_interval(*checkpoints_), options_.progress));
  run.remarks.insert(run.remarks.begin(), summary_.run.remarks.begin(), summary_.run.remarks.end());
  for (Diagnostic& remark : loop.altered.unused()) run.remarks.push_back(std::move(remark));
  summary_.run = std::move(run);
  summary_.tick = origin_.tick;
  summary_.time = origin_.time;
  return std::move(summary_);
}

}  // namespace

Result<BranchPoint> BranchPoint::parse(const std::string& text) {
  const std::size_t at = text.rfind('@');
  if (at == std::string::npos || at == 0)
    return error_at({text, text.size(), 1}, "that names no moment: expected TRACE@3.2s or TRACE@tick:640");
  BranchPoint point;
  point.trace = text.substr(0, at);
  const std::string moment = text.substr(at + 1);
  const bool is_tick = moment.starts_with("tick:");
  const bool has_form = is_tick || moment.ends_with('s');
  const std::string_view digits = is_tick ? std::string_view(moment).substr(5)
                                          : std::string_view(moment).substr(0, moment.empty() ? 0 : moment.size() - 1);
  constexpr double most = 1e15;
  const auto number = number_in<double>(digits);
  if (!has_form || !number || !(*number >= 0.0 && *number <= most) || (is_tick && *number != std::floor(*number)))
    return error_at({text, at + 1, moment.size()}, fmt::format("'{}' is no moment: expected 3.2s or tick:640", moment));
  if (is_tick)
    point.tick = static_cast<std::int64_t>(*number);
  else
    point.time = *number;
  return point;
}

Result<BranchSummary> record_branch(const BranchPoint& from, const fs::path& trace, const BranchOptions& options) {
  const StandardFloatMode float_mode;
  return Branch(from, trace, options).make();
}

}  // namespace rehearse
