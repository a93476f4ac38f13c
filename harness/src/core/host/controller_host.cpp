#include "controller_host.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/clock.h"
#include "controller_watch.h"
#include "core/guard/cost_counter.h"
#include "core/guard/exception_text.h"
#include "core/guard/opened_files.h"
#include "core/guard/source_line.h"
#include "core/guard/streams.h"
#include "core/guard/supervisor.h"
#include "core/turns/scheduler.h"
#include "debug_hook.h"
#include "odd_command.h"
#include "turn_order_file.h"

namespace rehearse {
namespace {

constexpr std::size_t lines_of_a_failure = 3;  // lines that its message repeats

}  // namespace

void append_remarks(const std::vector<msg::Event>& events, Diagnostics& remarks) {
  for (const msg::Event& event : events) {
    if (event.severity == to_string(Severity::note)) continue;
    const std::string text = event.source + ": " + event.text;
    remarks.push_back(event.severity == to_string(Severity::error) ? error(text) : warning(text));
  }
}

ControllerHost::~ControllerHost() { stop(tick_); }

void ControllerHost::event(Severity severity, const std::string& source, std::string text) {
  msg::Event& added = events_.emplace_back();
  added.tick = tick_;
  added.stamp = msg::Time::from_ns(nanoseconds_of(tick_, scenario_->time_step));
  added.severity = to_string(severity);
  added.source = source;
  added.text = std::move(text);
}

std::vector<msg::Event> ControllerHost::take_events() { return std::exchange(events_, {}); }

/// The last lines that a controller wrote, for the message of its failure; empty if it wrote none.
std::string ControllerHost::last_words(const HostedController& hosted) {
  std::string words;
  for (const std::string& line : hosted.last_lines) words += (words.empty() ? "" : " | ") + text_of_controller(line);
  return words.empty() ? "" : "; it wrote: " + words;
}

/// Reads the messages of a call, after any end of it. If its code was interrupted, the stream may be in any state.
void ControllerHost::collect_messages(HostedController& hosted, CallEnd end) {
  std::vector<std::string> lines;
  const auto collect = [&] { lines = hosted.io->take_messages(); };
  if (end == CallEnd::returned || end == CallEnd::threw)
    collect();
  else
    guarded_call(collect, options_.call_limit);
  for (std::string& line : lines) {
    hosted.last_lines.push_back(line);
    if (hosted.last_lines.size() > lines_of_a_failure) hosted.last_lines.pop_front();
    if (options_.on_message) options_.on_message(hosted.label, line);
    event(Severity::note, hosted.label, std::move(line));
  }
  if (hosted.io->take_enabled_too_late() && !std::exchange(hosted.reported.enabled_too_late, true))
    event(Severity::warning, hosted.label, "enabled an input or output after initialize(): it has no effect");
  for (const std::string& finding : hosted.variables.take_findings()) event(Severity::warning, hosted.label, finding);
}

/// Reports the changes that a call made to the process, each kind once for each controller.
void ControllerHost::tell_trespasses(HostedController& hosted, const char* function, const CallOutcome& outcome) {
  std::vector<Trespass> trespasses = ProcessGuard::instance().put_right();
  if (outcome.changed_float_mode)
    trespasses.push_back(
        {Trespass::Kind::float_mode,
         fmt::format("left another floating-point mode behind ({}); it was set back{}", describe(outcome.float_mode),
                     is_fast_math(outcome.float_mode) ? " (is it built with -ffast-math?)" : "")});
  for (const Trespass& trespass : trespasses)
    if (hosted.reported.trespasses.insert(trespass.kind).second)
      event(Severity::warning, hosted.label, fmt::format("{}() at tick {} {}", function, tick_, trespass.deed));
}

/// The failed thread may belong to a different controller than the called one.
const std::string& ControllerHost::label_of_failed(const HostedController& called, const CallOutcome& outcome) const {
  if (!outcome.by_thread_of || called.library->threads().get() == outcome.by_thread_of) return called.label;
  for (const HostedController& hosted : controllers_)
    if (hosted.library && hosted.library->threads().get() == outcome.by_thread_of) return hosted.label;
  return called.label;
}

bool ControllerHost::call_alone(HostedController& hosted, const char* function, const std::function<void()>& code,
                                HowOften how_often) {
  const PluggedIn plugged_in(hosted.joystick.get());
  const double now = time_of(tick_, scenario_->time_step);
  const DebuggedCall debugged({run_, tick_, now, hosted.label.c_str(), function, hosted.controller.get(),
                               hosted.io.get(), hosted.io_body ? &hosted.io_body->body() : nullptr});
  note_call_begin(hosted.label.c_str(), function, tick_, now, options_.call_limit);
  ProcessGuard::instance().begin(hosted.library->threads(), how_often == HowOften::once);
  TurnScheduler::instance().set_time(static_cast<std::int64_t>(nanoseconds_of(tick_, scenario_->time_step)));
  const CallOutcome outcome = [&] {
    const Watched watched(options_.watch, {hosted.label, hosted.library->file(), function, tick_, now});
    // a variable that is set after the last tick can't be recorded
    const ControllerVariables::Open variables(stopped_ ? nullptr : &hosted.variables);
    hosted.tick.cost = {};
    const auto counted = [&] {
      const CountedCall counting(counts_costs_ ? &hosted.tick.cost : nullptr);
      code();
    };
    const CallOutcome ended = guarded_call(std::ref(counted), options_.call_limit);
    CountedCall::stop();
    return ended;
  }();
  return ends_well(hosted, function, outcome);
}

bool ControllerHost::call(HostedController& hosted, const char* function, const std::function<void()>& code,
                          HowOften how_often) {
  return call_alone(hosted, function, code, how_often) && let_threads_run(hosted, function);
}

/// After a call: the threads of the controller run in turns until all wait. `until`: and until this simulated time
/// [ns].
bool ControllerHost::let_threads_run(HostedController& hosted, const char* function, std::int64_t until) {
  TurnScheduler& turns = TurnScheduler::instance();
  if (turns.count_of(*hosted.library->threads()) == 0) return true;
  const double now = time_of(tick_, scenario_->time_step);
  note_call_begin(hosted.label.c_str(), function, tick_, now, options_.call_limit);
  ProcessGuard::instance().begin(hosted.library->threads(), false);
  const CallOutcome outcome = guarded_call([&] { turns.let_others_run(until); }, options_.call_limit);
  return ends_well(hosted, function, outcome);
}

/// True if the call returned. Else its failure is told.
bool ControllerHost::ends_well(HostedController& hosted, const char* function, const CallOutcome& outcome) {
  take_opened_files(hosted);
  tell_trespasses(hosted, function, outcome);
  tell_threads(hosted);
  collect_messages(hosted, outcome.end);
  note_call_end();
  if (outcome.end == CallEnd::returned) return true;
  if (outcome.by_thread_of) thread_failed_of_ = outcome.by_thread_of;
  const std::string& label = label_of_failed(hosted, outcome);
  const auto line = source_line_of(outcome.place);
  std::string text = fmt::format("{}controller '{}' {} in {}() at tick {} ({} s){}", line ? line->text() : "", label,
                                 outcome.what, function, tick_, time_of(tick_, scenario_->time_step),
                                 &label == &hosted.label ? last_words(hosted) : "");
  event(Severity::error, label, text);
  if (!failure_) {
    failure_ = error(std::move(text));
    failed_by_ = outcome.end;
  }
  hosted.running = false;
  hosted.configured = false;
  if (outcome.end != CallEnd::threw) {
    // Its code was interrupted: none of it may run again, not even its destructor.
    hosted.library->keep_loaded();
    static auto& abandoned = *new std::vector<std::pair<cnoid::SimpleController*, HostJoystick*>>;
    abandoned.emplace_back(hosted.controller.release(), hosted.joystick.release());
  }
  return false;
}

void ControllerHost::refuse(HostedController& hosted, const char* function) {
  hosted.running = false;
  if (hosted.optional)
    return event(Severity::warning, hosted.label,
                 fmt::format("{}() returned false: the run goes on without this controller", function));
  std::string text = fmt::format("controller '{}' refuses to take part: {}() returned false", hosted.label, function);
  std::string hint = "a run goes on without a controller that is `optional: true`";
  for (const auto& [file, content] : hosted.files)
    if (content == missing_file) {
      text += fmt::format("; {} wasn't there", file);
      hint = "if it belongs to shareDirPath(): REHEARSE_CHOREONOID_SHARE names that folder";
    }
  text += last_words(hosted);
  event(Severity::error, hosted.label, text);
  if (!failure_) failure_ = error(std::move(text), std::move(hint));
  refused_ = true;
}

void ControllerHost::take_opened_files(HostedController& hosted) {
  for (OpenedFile& file : take_files_opened()) {
    copy_input(file, input_copies_);
    hosted.files.emplace(std::move(file.name), std::move(file.content));
  }
}

std::vector<ControlTimes> ControllerHost::control_times() const {
  std::vector<ControlTimes> times;
  for (const HostedController& hosted : controllers_) {
    ControlTimes of_controller = hosted.clock.times(hosted.label, scenario_->time_step);
    if (counts_costs_) of_controller.costs = hosted.costs;
    if (of_controller.calls > 0) times.push_back(std::move(of_controller));
  }
  return times;
}

std::map<std::string, std::string> ControllerHost::files_read() const {
  std::map<std::string, std::string> files;
  for (const HostedController& hosted : controllers_) {
    for (const auto& [file, content] : hosted.files) files.emplace(hosted.label + ": " + file, content);
    for (const auto& [name, content] : hosted.library->linked())
      files.emplace(hosted.label + ": " + linked_library_prefix + name, content);
  }
  return files;
}

void ControllerHost::show_joystick(const Observation& seen) {
  if (!scenario_->joystick) return;
  REHEARSE_ASSERT(seen.joystick.has_value(), "a run with a joystick observes it");
  for (HostedController& hosted : controllers_)
    if (hosted.joystick) hosted.joystick->show(*seen.joystick, time_of(tick_, scenario_->time_step));
}

bool ControllerHost::input(std::int64_t tick, const Observation& seen) {
  tick_ = tick;
  if (!pass_infos()) return false;
  const double now = time_of(tick, scenario_->time_step);
  show_joystick(seen);
  for (HostedController& hosted : controllers_) {
    hosted.tick = {};
    hosted.tick.delayed = is_delayed(hosted);
    if (controlled_) hosted.variables.begin_tick();
  }
  controlled_ = true;
  for (HostedController& hosted : controllers_) {
    const BodyObservation& body = seen.bodies[hosted.body];
    const double delivered_at = time_of(tick - 1, scenario_->time_step);
    if (hosted.parent < 0 && hosted.io_body && hosted.io_body->hears(body) &&
        !call(
            hosted, "a slot of sigStateChanged", [&] { hosted.io_body->input_devices(body, delivered_at); },
            HowOften::in_ticks))
      return false;
    hosted.io->set_time(now);
    hosted.tick.has_input = hosted.is_called();
    if (!hosted.is_called()) continue;
    hosted.io->input(body);
    read_backs_.give(static_cast<std::size_t>(&hosted - controllers_.data()), *hosted.io);
  }
  return true;
}

bool ControllerHost::control() {
  bool alive = true;
  for (HostedController& hosted : controllers_) {
    if (!hosted.is_called()) continue;
    const auto control = [&] {
      stop_for_debugger();
      const WatchedControl watched(options_.watch);
      hosted.tick.result = hosted.controller->control();
    };
    const std::uint64_t faults = counts_costs_ ? page_faults_of_thread() : 0;
    hosted.clock.begin();
    alive = alive && call_alone(hosted, "control", control, HowOften::in_ticks);
    hosted.clock.end(tick_);
    if (counts_costs_) hosted.costs.add(tick_, hosted.tick.cost, page_faults_of_thread() - faults);
    alive = alive && let_threads_run(hosted, "control");
    hosted.tick.has_output = alive;
    if (!alive) break;
  }
  // A child may write to a joint that its parent commands: as in Choreonoid, both are read when all have returned.
  for (HostedController& hosted : controllers_)
    if (hosted.tick.has_output) {
      hosted.io->output();
      hosted.tick.delayed = is_delayed(hosted);
    }
  if (!alive) return false;
  for (HostedController& hosted : controllers_)
    if (hosted.parent < 0 && hosted.io_body) take_device_outputs(hosted);
  return true;
}

/// Reads the outputs for devices of this tick; at tick 0 also those of initialize() for other devices.
void ControllerHost::take_device_outputs(HostedController& hosted) {
  std::vector<DeviceOutput>& outputs = hosted.tick.device_outputs;
  outputs = hosted.io_body->take_device_outputs();
  for (DeviceOutput& early : std::exchange(hosted.early_outputs, {})) {
    const auto place = std::lower_bound(outputs.begin(), outputs.end(), early.device,
                                        [](const DeviceOutput& output, int device) { return output.device < device; });
    if (place == outputs.end() || place->device != early.device) outputs.insert(place, std::move(early));
  }
}

/// Copies changes that a controller made in the info() of a device to the other controllers of its robot that have
/// enabled this device.
bool ControllerHost::pass_infos() {
  for (HostedController& hosted : controllers_) {
    if (hosted.parent >= 0 || !hosted.io_body) continue;
    for (const DeviceInfo& changed : hosted.io_body->take_infos()) {
      const std::string& device = hosted.io_body->model().devices[changed.device].name;
      event(Severity::note, hosted.label, fmt::format("info of device '{}': {}", device, text_of(changed.info)));
      for (HostedController& other : controllers_)
        if (other.parent < 0 && &other != &hosted && other.body == hosted.body && other.io_body &&
            !call(
                other, "a slot of sigInfoChanged", [&] { other.io_body->input_info(changed); }, HowOften::in_ticks))
          return false;
    }
  }
  return true;
}

void ControllerHost::output(Timing timing, Command& command) {
  if (timing == Timing::next_step) read_backs_.begin_late_outputs();
  for (std::size_t i = 0; i < controllers_.size(); ++i) {
    const HostedController& hosted = controllers_[i];
    const Timing own = hosted.tick.delayed ? Timing::next_step : Timing::same_step;
    if (own != timing) continue;
    const bool is_lost = hosted.specification->loses(time_of(tick_, scenario_->time_step), scenario_->time_step);
    if (!is_lost) apply(i, timing, command);
  }
}

bool ControllerHost::all_done() const {
  return !controllers_.empty() &&
         std::ranges::none_of(controllers_, [](const auto& hosted) { return hosted.running && hosted.tick.result; });
}

bool ControllerHost::is_delayed(const HostedController& hosted) const {
  return !(hosted.parent >= 0 ? controllers_[hosted.parent] : hosted).io->isNoDelayMode();
}

void ControllerHost::apply_device_output(const HostedController& hosted, const DeviceOutput& output, Command& command) {
  if (output.acted_in_initialize) return;
  const auto is_odd = [](double number) { return !std::isfinite(number); };
  if (std::ranges::any_of(output.values, is_odd)) {
    event(
        Severity::error, hosted.label,
        fmt::format("gave device '{}' a state that isn't finite at tick {}; it was recorded, but the device keeps the "
                    "one before it",
                    scenario_->bodies[hosted.body].model->devices[output.device].name, tick_));
    return;
  }
  command.bodies[hosted.body].devices[output.device] = {true, output.on, output.values};
}

void ControllerHost::apply(std::size_t index, Timing timing, Command& command) {
  HostedController& hosted = controllers_[index];
  BodyCommand& body = command.bodies[hosted.body];
  for (const DeviceOutput& output : hosted.tick.device_outputs) apply_device_output(hosted, output, command);
  if (!hosted.is_called()) return;
  const std::vector<double>& values = hosted.io->output_values();
  for (const IoField& field : hosted.io->outputs().fields) {
    const double* value = values.data() + field.offset;
    const double* end = value + width_of(field.quantity);
    const double* odd = std::ranges::find_if(value, end, [](double number) { return !std::isfinite(number); });
    if (odd != end) {
      if (!hosted.reported.odd_outputs[field.offset])
        event(Severity::error, hosted.label,
              odd_command_text(*odd, field.quantity, scenario_->bodies[hosted.body].model->links[field.link], tick_,
                               time_of(tick_, scenario_->time_step)));
      hosted.reported.odd_outputs[field.offset] = true;
      continue;
    }
    read_backs_.take(index, field, {value, end}, timing);
    switch (field.quantity) {
      case Quantity::q: body.joints[field.joint].q = *value; break;
      case Quantity::dq: body.joints[field.joint].dq = *value; break;
      case Quantity::u: body.joints[field.joint].u = *value; break;
      case Quantity::pose:
        body.given[field.link].place =
            LinkPlace{{value[0], value[1], value[2]}, {value[6], value[3], value[4], value[5]}};
        break;
      case Quantity::twist:
        body.given[field.link].twist = LinkTwist{{value[0], value[1], value[2]}, {value[3], value[4], value[5]}};
        break;
      case Quantity::wrench:
        body.external[field.link].force += Eigen::Vector3d(value[0], value[1], value[2]);
        body.external[field.link].torque += Eigen::Vector3d(value[3], value[4], value[5]);
        break;
      default: break;  // freeze() has reported that they have no effect
    }
  }
}

void ControllerHost::stop(std::int64_t end) {
  if (std::exchange(stopped_, true)) return;
  for (HostedController& hosted : controllers_) hosted.io->set_time(time_of(end, scenario_->time_step));
  for (auto hosted = controllers_.rbegin(); hosted != controllers_.rend(); ++hosted)
    if (hosted->running) call(*hosted, "stop", [&] { hosted->controller->stop(); });
  for (HostedController& hosted : controllers_)
    if (hosted.configured) call(hosted, "unconfigure", [&] { hosted.controller->unconfigure(); });
  for (HostedController& hosted : controllers_)
    if (hosted.controller) call(hosted, "~SimpleController", [&] { hosted.controller.reset(); });
  keep_libraries_of_threads();
  if (restore_streams())
    event(Severity::warning, "process",
          "a controller closed or redirected stdin, stdout or stderr, past the C library; they were opened again");
  if (ControllerVariables::take_strays())
    event(Severity::warning, "rehearse_variable",
          "was called where no controller is called in a tick (while a library is loaded, in stop() or after it, by "
          "another "
          "thread): what it set there isn't recorded");
}

/// The code of a thread that still runs must not be unloaded.
void ControllerHost::keep_libraries_of_threads() {
  constexpr std::int64_t moment = 50'000'000;  // [ns]: a thread that ends at a request may take it
  TurnScheduler& turns = TurnScheduler::instance();
  for (HostedController& hosted : controllers_) {
    if (!hosted.library) continue;  // it couldn't be loaded
    const ThreadCount& threads = hosted.library->threads();
    let_threads_run(hosted, "stop", turns.now() + moment);
    tell_unknown_delays(hosted);
    const std::atomic<int>& running = threads->running;
    for (int i = 0; i < 50 && running > turns.count_of(*threads); ++i) usleep(1000);
    if (running == 0) continue;
    hosted.library->keep_loaded();
    take_late_failure(hosted);
    // A failed thread is suspended, and was reported.
    const int left = running - (thread_failed_of_ == threads.get() ? 1 : 0);
    if (left > 0)
      event(Severity::warning, hosted.label,
            fmt::format("leaves {} running after stop(): {} stays loaded",
                        left == 1 ? "a thread" : fmt::format("{} threads", left),
                        hosted.library->file().filename().string()));
  }
}

/// Reports waits for something outside of the process, and threads that take no turns, once each.
void ControllerHost::tell_threads(HostedController& hosted) {
  find_lines_of_exchanges();
  GuestThreads& threads = *hosted.library->threads();
  for (; hosted.reported.outside < threads.outside.size(); ++hosted.reported.outside) {
    const auto& [words, places] = threads.outside[hosted.reported.outside];
    const auto line = source_line_of(places);
    event(Severity::warning, hosted.label,
          fmt::format("{}a thread waits for {}: when it goes on depends on more than the inputs",
                      line ? line->text() : "", words));
  }
  if (threads.free_because && *threads.free_because)
    event(Severity::warning, hosted.label,
          fmt::format("its threads of {} take no turns, because they wait past the C library: they run as the kernel "
                      "lets them (OMP_NUM_THREADS=1 makes it one thread)",
                      std::exchange(threads.free_because, "")));
}

/// Reports delays that are stated for a thread that there isn't.
void ControllerHost::tell_unknown_delays(const HostedController& hosted) {
  const GuestThreads& threads = *hosted.library->threads();
  for (const auto& [name, delay] : threads.delays)
    if (!threads.met.contains(name))
      event(Severity::warning, hosted.label,
            fmt::format("has no thread '{}', for which `threads` states a delay{}", name,
                        threads.met.empty() ? "" : fmt::format("; it has '{}'", fmt::join(threads.met, "', '"))));
}

/// A thread may fail after the last call.
void ControllerHost::take_late_failure(const HostedController& hosted) {
  if (failure_) return;
  const CallOutcome late = guarded_call([] {}, options_.call_limit);
  if (late.end == CallEnd::returned) return;
  thread_failed_of_ = late.by_thread_of;
  failed_by_ = late.end;
  const std::string& label = label_of_failed(hosted, late);
  failure_ = error(fmt::format("controller '{}' {} before tick {} ({} s)", label, late.what, tick_ + 1,
                               time_of(tick_ + 1, scenario_->time_step)));
  event(Severity::error, label, failure_->message);
}

}  // namespace rehearse
