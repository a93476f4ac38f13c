#include "log_sink.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/clock.h"

namespace rehearse {

/// True if the command of this tick or a following one may depend on a message that is late or missing in the log.
bool LogSink::is_irregular(std::int64_t tick, bool has_command) const {
  const LogTicks& ticks = log_.ticks();
  if (ticks.is_nominal()) return false;
  return !ticks.has_message(tick) || ticks.is_irregular(tick) || log_.may_miss_input() || lacks_command(has_command);
}

/// True if the tick's command is missing or late; on the nominal grid commands may come less often.
bool LogSink::lacks_command(bool has_command) const {
  return !has_command && !log_.ticks().is_nominal() && log_.commands()->come_each_tick();
}

/// True if an input of the tick may be missing in the log, or belong to a neighbouring tick.
bool LogSink::misses_input(std::int64_t tick) const {
  const LogTicks& ticks = log_.ticks();
  const double usual = log_.ticks_are_inputs() ? 0.5 : LogTicks::usual_distance;
  const bool is_off = !ticks.is_nominal() && (!ticks.has_message(tick) || ticks.is_irregular(tick, usual));
  return is_off || log_.may_miss_input() || log_.doubts_inputs();
}

void LogSink::note_joystick(const TickData& now) {
  constexpr std::size_t most_moves = 1000;
  const JoystickReading& seen = *now.seen->joystick;
  if (seen == joystick_) return;
  JoystickMove move{time_of(now.tick, map_.time_step), {}, {}};
  for (std::size_t i = 0; i < seen.axes.size(); ++i)
    if (seen.axes[i] != joystick_.axes[i]) move.axes.emplace_back(joystick_axes[i], seen.axes[i]);
  for (std::size_t i = 0; i < seen.buttons.size(); ++i)
    if (seen.buttons[i] != joystick_.buttons[i]) move.buttons.emplace_back(joystick_buttons[i], seen.buttons[i]);
  joystick_ = seen;
  if (report_.begin.joystick.size() < most_moves) {
    report_.begin.joystick.push_back(std::move(move));
  } else {
    ++report_.begin.moves_left_out;
  }
}

void LogSink::compare(const TickData& now) {
  if (!judge_)
    judge_ = log_.commands()->make_judge(*now.host, scenario_.time_step,
                                         [this](Divergence&& found) { differences_.push_back(std::move(found)); });
  waiting_.push_back(compare_tick(now));
  judge_->end_tick(now.tick);
  take_judged();
}

LogSink::Judged LogSink::compare_tick(const TickData& now) {
  LogCommands& log = *log_.commands();
  if (options_.commands && now.tick == 0) options_.commands->begin(log_.ticks().time(0), log.columns());
  const CommandedJoints* logged = log.of_tick(now.tick);
  Judged tick{now.tick, is_irregular(now.tick, logged != nullptr), misses_input(now.tick), false};
  if (options_.commands && tick.misses_input) options_.commands->interrupt(log_.ticks().time(now.tick));
  tick.is_told = std::exchange(is_told_, false);
  knows_state_ &= !tick.misses_input;
  tick.may_be_of_another = std::exchange(lacked_command_, lacks_command(logged != nullptr)) || log_.doubts_commands();
  if (!log.covers(now.tick)) return tick;
  const bool has_command = logged && log_.ticks().has_message(now.tick);
  if (log_.ticks().time(now.tick) < compared_from_) {
    if (has_command) LogCommands::pass_over(now.tick, *logged, *now.host, *judge_);
    return tick;
  }
  if (!has_command) {
    ++(log_.ticks().has_message(now.tick) ? report_.ticks_without_command : report_.ticks_without_message);
    timing_.add({});
    return tick;
  }
  std::vector<CommandPair> pairs = log.compare(now.tick, *logged, *now.host, *judge_);
  if (options_.commands) options_.commands->add(log_.ticks().time(now.tick), pairs);
  if (certainty_) {
    std::vector<double> commands;
    for (const CommandPair& pair : pairs) {
      commands.push_back(pair.actual);
      tick.off.push_back(pair.logged ? pair.actual - *pair.logged : 0.0);
    }
    tick.moves = commands != last_commands_;
    last_commands_ = std::move(commands);
  }
  tick.compared = std::ranges::count_if(pairs, [](const CommandPair& pair) { return pair.logged.has_value(); });
  timing_.add(std::move(pairs));
  return tick;
}

double LogSink::log_time(std::int64_t tick) const { return seconds_of(log_.ticks().time(tick) - log_.ticks().time(0)); }

/// Takes the ticks whose differences are known.
void LogSink::take_judged() {
  for (; !waiting_.empty() && waiting_.front().tick < judge_->judged_until(); waiting_.pop_front()) {
    Judged& tick = waiting_.front();
    for (; !differences_.empty() && differences_.front().tick == tick.tick; differences_.pop_front())
      tick.differences.push_back(std::move(differences_.front()));
    if (certainty_) count_if_certain(tick);
    if (tick.is_irregular && agreed_) doubt_ = ticks_of_doubt;
    if (tick.compared > 0) judge(std::move(tick));
  }
}

void LogSink::count_if_certain(const Judged& tick) {
  const auto beyond = std::ranges::find_if(tick.differences, &Divergence::is_beyond);
  const bool agrees = beyond == tick.differences.end();
  const bool says_nothing = tick.may_be_of_another && !agrees;
  if (tick.is_told) certainty_->know(tick.tick);
  const bool is_known =
      certainty_->take(tick.tick, tick.misses_input, agrees || says_nothing, tick.moves && !says_nothing);
  const bool is_certain = is_known && !says_nothing;
  LogStretches& certain = *report_.certain;
  if (!is_certain && !agrees && !certain.first_uncertain) certain.first_uncertain = tick.tick;
  if (!is_certain && certain.first_uncertain) rest_.add(log_time(tick.tick), tick.off);
  if (!is_certain || tick.compared == 0) return;
  ++certain.compared;
  certain.values += tick.compared;
  certain.different += agrees ? 0 : 1;
  if (!agrees && !certain.beyond) certain.beyond_at = log_time(tick.tick);
  for (const Divergence& found : tick.differences) certain.add(found);
}

void LogSink::judge(Judged tick) {
  // After a difference within tolerance no equal bits are expected.
  const bool agrees = std::ranges::none_of(
      tick.differences, [this](const Divergence& found) { return !report_.first || found.is_beyond(); });
  if (agrees) {
    report_.ticks_in_doubt += static_cast<std::int64_t>(in_doubt_.size());
    in_doubt_.clear();
    doubt_ = std::max(0, doubt_ - 1);
  } else if (doubt_ > 0) {
    doubt_ = ticks_of_doubt;
    in_doubt_.push_back(std::move(tick));
    if (in_doubt_.size() > longest_doubt) end_doubt();
    return;
  }
  agreed_ = agrees;
  report(std::move(tick));
}

void LogSink::report(Judged tick) {
  report_.values += tick.compared;
  ++report_.ticks_compared;
  report_.ticks_different += tick.differences.empty() ? 0 : 1;
  if (std::ranges::any_of(tick.differences, &Divergence::is_beyond) && ++report_.ticks_beyond == 1)
    report_.beyond_at = log_time(tick.tick);
  for (Divergence& found : tick.differences) {
    if (options_.on_difference) options_.on_difference(found);
    report_.add(std::move(found));
  }
}

void LogSink::end_doubt() {
  if (in_doubt_.empty()) return;
  report_.remarks.push_back(
      at(map_.tick->place,
         warning(fmt::format("the commands differ from tick {} on, after a message that is missing or late",
                             in_doubt_[0].differences[0].tick),
                 "a controller with a state then differs, even if it is the robot's")));
  for (Judged& tick : in_doubt_) report(std::move(tick));
  in_doubt_.clear();
  doubt_ = 0;
  agreed_ = false;
}

void LogSink::finish() {
  if (judge_) judge_->finish();
  take_judged();
  if (report_.ticks_compared == 0) end_doubt();
  report_.ticks_in_doubt += static_cast<std::int64_t>(in_doubt_.size());
  if (report_.beyond) report_.timing = timing_.explanation();
  if (report_.certain && log_.commands()) report_.certain->rest = rest_.report(log_.commands()->columns());
}

}  // namespace rehearse
