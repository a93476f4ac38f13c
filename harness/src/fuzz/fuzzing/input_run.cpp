#include "input_run.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <utility>

#include "base/clock.h"
#include "base/hashing.h"
#include "core/guard/float_mode.h"
#include "core/guard/process_guard.h"
#include "core/host/controller_host.h"
#include "core/kinds/channel_name.h"
#include "core/recording/provenance.h"
#include "core/recording/recorder.h"
#include "core/run/hosted_commands.h"
#include "core/run/recording_sink.h"
#include "core/run/run.h"
#include "core/trace/run_facts.h"

namespace rehearse {
namespace {

/// Fills memory that is allocated during its lifetime, so that code that reads it before it writes it computes with
/// extreme numbers in one run and with zeros in another one, and not with what an earlier run left there.
class FilledMemory {
 public:
  explicit FilledMemory(MemoryFill fill) {
    // glibc fills with the complement of this byte: 0x7F7F... is 1.4e306 as a double
    ::mallopt(M_PERTURB, fill == MemoryFill::large_numbers ? 0x80 : 0xFF);
  }
  ~FilledMemory() { ::mallopt(M_PERTURB, 0); }
  FilledMemory(const FilledMemory&) = delete;
  FilledMemory& operator=(const FilledMemory&) = delete;
};

// As in fuzz_points.cpp, which a controller contains that is built with FUZZ.
struct PointsSite {
  std::uint32_t place, seen;
  double a, b, distance;
};
struct Points {
  std::uint32_t version, edges, sites;
  const std::uint8_t* counts;
  const PointsSite* comparisons;
};

// Kinds of states.
constexpr std::uint32_t edge_state = 1u << 28, variable_state = 2u << 28, change_state = 3u << 28,
                        output_state = 4u << 28;

/// A class of counts: 1, 2, 3, 4 to 7, 8 to 15, 16 to 31, 32 to 127, more.
std::uint32_t class_of(std::uint8_t count) {
  constexpr std::array<std::uint8_t, 8> least{1, 2, 3, 4, 8, 16, 32, 128};
  return static_cast<std::uint32_t>(std::ranges::upper_bound(least, count) - least.begin());
}

/// A class of numbers: a small integer by itself, else sign and power of two.
std::uint32_t class_of(double number) {
  if (std::isnan(number)) return 0;
  if (number == std::floor(number) && std::abs(number) <= 64.0) return static_cast<std::uint32_t>(number + 65.0);
  const int power = std::isinf(number) ? 400 : std::clamp(std::ilogb(number), -30, 400);
  return 200u + 2u * static_cast<std::uint32_t>(power + 30) + (number < 0.0 ? 1u : 0u);
}

void read_points(const ControllerHost& host, InputOutcome& outcome) {
  for (const HostedController& hosted : host.controllers()) {
    void* library = ::dlopen(hosted.library->file().c_str(), RTLD_NOW | RTLD_NOLOAD);
    if (!library) continue;
    const auto* points = static_cast<const Points*>(::dlsym(library, "rehearse_fuzz_points"));
    if (points && points->version == 1) {
      for (std::uint32_t i = 0; i < points->edges; ++i)
        if (points->counts[i] > 0) {
          outcome.states.push_back(edge_state | (i << 4) | class_of(points->counts[i]));
          ++outcome.points;
        }
      for (std::uint32_t i = 0; i < points->sites; ++i)
        if (const PointsSite& site = points->comparisons[i]; site.place != 0)
          outcome.comparisons.push_back({site.place, site.seen, site.a, site.b, site.distance});
    }
    ::dlclose(library);
  }
}

bool is_joint_quantity(Quantity quantity) { return quantity <= Quantity::u; }

std::string output_name(const Model& model, const IoField& field) {
  const Link& link = model.links[static_cast<std::size_t>(field.link)];
  return fmt::format("{}/{}", field.joint >= 0 ? link.joint.name : link.name, name_of(field.quantity));
}

std::string unit_of(const Joint& joint, Quantity quantity) {
  return std::string(unit_of_joint(name_of(quantity), is_linear(joint.type)));
}

class InputRun final : public ObservationSource, public Sink {
 public:
  InputRun(RunParts& parts, const Inputs& inputs) : parts_(parts), inputs_(inputs) {}

  InputOutcome go(const std::filesystem::path& recording);
  /// After go(): the names that a table of its numbers has.
  std::vector<NamedSeries> series() const;

  Result<bool> observe(TickData& now) override;
  Result<void> begin_tick(const TickData& now) override;
  Result<void> emit(const TickData& now) override;
  Result<bool> advance(TickData&, Commander&) override { return true; }  // nothing moves by itself

 private:
  struct Output {
    IoField field;
    int number = 0;
    std::optional<std::size_t> series;  // in the table
    double peak = 0.0, last = 0.0;
  };
  Result<void> begin(const std::filesystem::path& recording);
  Result<void> finish();
  void find_outputs();
  void read_outputs();
  void read_variables();
  void note(InputEnd end, std::string sentence, std::string reason);
  void note_failure();
  void judge();
  const Model& model() const { return parts_.setup.model(); }
  const Joint& joint_of(const IoField& field) const {
    return model().links[static_cast<std::size_t>(field.link)].joint;
  }
  double limit_of(const Output& output) const;
  void check(Output& output, double value);

  RunParts& parts_;
  const Inputs& inputs_;
  Scenario recorded_;  // the scenario with the length of this run
  std::unique_ptr<ControllerHost> host_;
  std::unique_ptr<Recorder> recorder_;
  std::optional<ProtectedDescriptor> descriptor_;
  std::optional<RecordingSink> sink_;
  Observation seen_;
  Command command_;              // of the first tick
  std::vector<double> efforts_;  // commanded last, by joint id
  std::vector<Output> outputs_;
  std::vector<double> variables_;  // the last values
  std::vector<std::optional<std::size_t>> variable_series_;
  std::set<std::uint32_t> states_;
  std::int64_t tick_ = 0;
  InputOutcome outcome_;
};

void InputRun::note(InputEnd end, std::string sentence, std::string reason) {
  if (!outcome_.passed()) return;
  outcome_.end = end;
  outcome_.sentence = std::move(sentence);
  outcome_.reason = std::move(reason);
  outcome_.tick = tick_;
}

Result<void> InputRun::begin(const std::filesystem::path& recording) {
  HostOptions options;
  options.call_limit = parts_.setup.plan.call_limit;
  options.counts_costs = parts_.setup.plan.realtime;
  recorded_ = parts_.setup.scenario;
  if (!recording.empty())
    recorded_ = REHEARSE_TRY(scenario_of(parts_.setup.plan, parts_.setup.body(), inputs_.ticks()));
  host_ = REHEARSE_TRY(ControllerHost::create(recorded_, options));
  if (!recording.empty()) {
    recorder_ = REHEARSE_TRY(Recorder::create(recording, recorded_, provenance(recorded_, host_.get(), "", "")));
    descriptor_.emplace(recorder_->descriptor(), "the recording");
    sink_.emplace(*recorder_);
  }
  seen_ = initial_observation(recorded_);
  efforts_.resize(seen_.bodies[0].joints.size());
  command_ = host_->initialize(seen_);
  if (recorder_) recorder_->declare(host_.get());
  host_->start();
  if (sink_) REHEARSE_TRY(sink_->record_events(host_->take_events()));
  return {};
}

void InputRun::find_outputs() {
  const auto& table = parts_.table.series();
  for (const HostedController& hosted : host_->controllers()) {
    for (const IoField& field : hosted.io->outputs().fields) {
      if (!is_joint_quantity(field.quantity) || field.joint < 0) continue;
      Output& output = outputs_.emplace_back();
      output.field = field;
      output.number = static_cast<int>(outputs_.size()) - 1;
      const std::string name = fmt::format("{}/output/{}", hosted.label, output_name(model(), field));
      const auto found = std::ranges::find(table, name, &NamedSeries::name);
      if (found != table.end()) output.series = static_cast<std::size_t>(found - table.begin());
    }
  }
}

Result<bool> InputRun::observe(TickData& now) {
  BodyObservation& body = seen_.bodies[0];
  const int row = static_cast<int>(std::min<std::int64_t>(now.tick, inputs_.ticks() - 1));
  for (std::size_t id = 0; id < efforts_.size(); ++id) body.joints[id].u = efforts_[id];
  const FuzzSetup& setup = parts_.setup;
  for (std::size_t i = 0; i < setup.columns.size(); ++i) {
    const InputColumn& column = setup.columns[i];
    if (column.joint < 0) continue;
    JointReading& joint = body.joints[static_cast<std::size_t>(column.joint)];
    double& to = column.quantity == FuzzRange::Quantity::q     ? joint.q
                 : column.quantity == FuzzRange::Quantity::dq  ? joint.dq
                 : column.quantity == FuzzRange::Quantity::ddq ? joint.ddq
                                                               : joint.u;
    to = inputs_.at(row, i);
  }
  for (std::size_t index = 0; index < setup.values_of_devices.size(); ++index) {
    const std::size_t count = setup.values_of_devices[index];
    if (count == 0) continue;
    DeviceReading& reading = body.devices[index];
    const double* values =
        inputs_.values.data() + static_cast<std::size_t>(row) * inputs_.columns + setup.first_of_devices[index];
    if (std::holds_alternative<RangeSensor>(model().devices[index].kind))
      reading.ranges = std::make_shared<const std::vector<float>>(values, values + count);
    else
      reading.values.assign(values, values + count);
    reading.measured_at = time_of(now.tick, recorded_.time_step);
    reading.fresh = true;
  }
  now.seen = now.read = &seen_;
  return true;
}

Result<void> InputRun::begin_tick(const TickData& now) {
  tick_ = now.tick;
  parts_.table.add_tick();
  const BodyObservation& body = seen_.bodies[0];
  for (std::size_t id = 0; id < body.joints.size(); ++id) {  // the first series of the table
    parts_.table.set(3 * id, body.joints[id].q);
    parts_.table.set(3 * id + 1, body.joints[id].dq);
    parts_.table.set(3 * id + 2, body.joints[id].u);
  }
  return sink_ ? sink_->begin_tick(now) : Result<void>();
}

double InputRun::limit_of(const Output& output) const {
  const Joint& joint = joint_of(output.field);
  if (output.field.quantity == Quantity::u) return joint.effort;
  if (output.field.quantity == Quantity::dq) return joint.velocity;
  return unlimited;
}

void InputRun::check(Output& output, double value) {
  const std::string name = output_name(model(), output.field);
  if (!std::isfinite(value)) {
    note(InputEnd::not_finite, fmt::format("{} is {} at tick {}", name, value, tick_), name + " isn't finite");
    return;
  }
  if (!parts_.setup.plan.limits) return;
  constexpr double rounding = 1e-9;
  const Joint& joint = joint_of(output.field);
  const double most = limit_of(output);
  const std::string unit = unit_of(joint, output.field.quantity);
  if (std::abs(value) > most * (1.0 + rounding))
    note(InputEnd::beyond_limit,
         fmt::format("{} is {:.6g} {} at tick {}, beyond its limit of {:.6g} {}", name, value, unit, tick_, most, unit),
         name + " is beyond its limit");
  if (output.field.quantity == Quantity::q && (value < joint.lower - rounding || value > joint.upper + rounding))
    note(InputEnd::beyond_limit,
         fmt::format("{} is {:.6g} {} at tick {}, beyond its limits from {:.6g} to {:.6g} {}", name, value, unit, tick_,
                     joint.lower, joint.upper, unit),
         name + " is beyond its limits");
}

void InputRun::read_outputs() {
  std::size_t next = 0;
  for (const HostedController& hosted : host_->controllers()) {
    for (const IoField& field : hosted.io->outputs().fields) {
      if (!is_joint_quantity(field.quantity) || field.joint < 0) continue;
      Output& output = outputs_[next++];
      const double value = hosted.io->output_values()[static_cast<std::size_t>(field.offset)];
      check(output, value);
      if (std::isfinite(value)) output.peak = std::max(output.peak, std::abs(value));
      output.last = value;
      if (output.series) parts_.table.set(*output.series, value);
      if (field.quantity == Quantity::u && std::isfinite(value))
        efforts_[static_cast<std::size_t>(field.joint)] = value;
      states_.insert(output_state | (static_cast<std::uint32_t>(output.number % 256) << 16) |
                     class_of(value) / (std::abs(value) > 64.0 || value != std::floor(value) ? 4 : 1));
    }
  }
}

void InputRun::read_variables() {
  std::size_t next = 0;
  for (const HostedController& hosted : host_->controllers()) {
    for (const ControllerVariables::Variable& variable : hosted.variables.all()) {
      const std::size_t number = next++;
      if (number >= variables_.size()) {
        variables_.push_back(std::numeric_limits<double>::quiet_NaN());
        const std::string name = fmt::format("{}/variable/{}", hosted.label, variable.name);
        const auto found = std::ranges::find(parts_.table.series(), name, &NamedSeries::name);
        variable_series_.push_back(found == parts_.table.series().end() ? std::nullopt
                                                                        : std::optional(static_cast<std::size_t>(
                                                                              found - parts_.table.series().begin())));
      }
      if (variable_series_[number]) parts_.table.set(*variable_series_[number], variable.value);
      if (number >= 256) continue;
      const std::uint32_t place = static_cast<std::uint32_t>(number) << 16;
      states_.insert(variable_state | place | class_of(variable.value));
      const std::uint32_t before = class_of(variables_[number]), after = class_of(variable.value);
      if (before != after && before > 0 && before < 160 && after < 160)  // from one small integer to another
        states_.insert(change_state | place | (before << 8) | after);
      variables_[number] = variable.value;
    }
  }
}

Result<void> InputRun::emit(const TickData& now) {
  if (!now.is_closing) {
    if (now.alive) read_outputs();
    read_variables();
    const std::uint64_t hash = host_->output_hash();
    outcome_.hash = hash_bytes(&hash, sizeof hash, outcome_.hash);
  }
  if (sink_) return sink_->emit(now);
  host_->take_events();
  return {};
}

void InputRun::note_failure() {
  if (!host_->failure()) return;
  const std::string& sentence = host_->failure()->message;
  outcome_.end = InputEnd::passed;  // what it did before it failed is less
  InputEnd end = InputEnd::crashed;
  switch (host_->failed_by()) {
    case CallEnd::threw: end = InputEnd::threw; break;
    case CallEnd::hung: end = InputEnd::hung; break;
    case CallEnd::exited: end = InputEnd::ended_process; break;
    case CallEnd::returned:
    case CallEnd::crashed: break;
  }
  note(end, sentence, without_numbers_in(sentence));
}

void InputRun::judge() {
  if (!parts_.claims) return;
  for (std::size_t claim = 0; claim < parts_.claims->count(); ++claim) {
    ClaimResult result = parts_.claims->judge(claim);
    outcome_.margins.push_back(result.margin.value_or(std::numeric_limits<double>::infinity()));
    if (result.holds) continue;
    tick_ = result.tick;
    note(InputEnd::violated, std::move(result.sentence), parts_.claims->text_of(claim));
  }
}

Result<void> InputRun::finish() {
  host_->stop(tick_ + 1);
  if (!sink_) return {};
  REHEARSE_TRY(sink_->record_events(host_->take_events()));
  descriptor_.reset();
  if (const auto files = host_->files_read(); !files.empty())
    REHEARSE_TRY(recorder_->add_metadata(records::files, files));
  for (const auto& [name, text] : host_->input_copies())
    REHEARSE_TRY(recorder_->attach(name, "application/octet-stream", text));
  RunOutcome outcome{.ticks = recorder_->size().ticks, .complete = !host_->failure()};
  if (host_->failure()) outcome.failure = host_->failure()->message;
  outcome.checkpoints = "none";
  return recorder_->close(outcome);
}

InputOutcome InputRun::go(const std::filesystem::path& recording) {
  const StandardFloatMode float_mode;
  parts_.table.clear();
  const auto unable = [&](const std::string& why) {
    outcome_ = InputOutcome{};
    outcome_.end = InputEnd::unable;
    outcome_.sentence = why;
    return outcome_;
  };
  if (const auto begun = begin(recording); !begun) return unable(to_string(begun.errors()));
  if (host_->failure()) return unable(host_->failure()->message);
  if (host_->any_refused()) {
    std::string why = "the controller refused to take part";
    for (const msg::Event& event : host_->take_events()) why += "\n" + event.source + ": " + event.text;
    return unable(why);
  }
  find_outputs();
  // a recording has the events of commands that aren't finite, as a replay of it
  HostedCommands commands(*host_, sink_ ? HostedCommands::Written::at_once : HostedCommands::Written::never);
  Run run(recorded_.time_step, *this, commands, *this, 0, inputs_.ticks());
  run.command = std::move(command_);
  if (const auto gone = run.go(); !gone) return unable(to_string(gone.errors()));
  if (!host_->failure()) {
    const std::int64_t last = tick_;
    if (const auto closed = run.close(); !closed) return unable(to_string(closed.errors()));
    judge();
    tick_ = last;
  }
  if (const auto finished = finish(); !finished) return unable(to_string(finished.errors()));
  note_failure();
  if (outcome_.passed() && parts_.setup.plan.realtime)
    for (const ControlTimes& control : host_->control_times())
      if (control.costs && !control.costs->is_realtime_safe())
        note(InputEnd::not_realtime, realtime_sentence(control), "control() isn't real-time safe");
  outcome_.states.assign(states_.begin(), states_.end());
  read_points(*host_, outcome_);
  std::ranges::sort(outcome_.states);
  for (const Output& output : outputs_) outcome_.peaks.push_back(output.peak);
  return outcome_;
}

std::vector<NamedSeries> InputRun::series() const {
  std::vector<NamedSeries> all = parts_.table.series();
  if (!host_) return all;
  for (const HostedController& hosted : host_->controllers()) {
    for (const IoField& field : hosted.io->outputs().fields)
      if (is_joint_quantity(field.quantity) && field.joint >= 0)
        all.push_back({fmt::format("{}/output/{}", hosted.label, output_name(model(), field)),
                       unit_of(joint_of(field), field.quantity)});
    for (const ControllerVariables::Variable& variable : hosted.variables.all())
      all.push_back({fmt::format("{}/variable/{}", hosted.label, variable.name), ""});
  }
  return all;
}

/// The series that every run has: the inputs of all joints.
std::vector<NamedSeries> series_of_joints(const FuzzSetup& setup) {
  std::vector<NamedSeries> all;
  const std::string& body = setup.scenario.bodies[0].name;
  for (const int link : setup.model().joints) {
    const Joint& joint = setup.model().links[static_cast<std::size_t>(link)].joint;
    for (const Quantity quantity : {Quantity::q, Quantity::dq, Quantity::u})
      all.push_back({fmt::format("{}/{}/{}", body, joint.name, name_of(quantity)), unit_of(joint, quantity)});
  }
  return all;
}

}  // namespace

const char* to_string(InputEnd end) {
  switch (end) {
    case InputEnd::passed: return "passed";
    case InputEnd::not_finite: return "not finite";
    case InputEnd::beyond_limit: return "beyond a limit";
    case InputEnd::violated: return "violated";
    case InputEnd::threw: return "threw";
    case InputEnd::crashed: return "crashed";
    case InputEnd::hung: return "hung";
    case InputEnd::ended_process: return "ended the process";
    case InputEnd::took_memory: return "took too much memory";
    case InputEnd::not_repeated: return "not repeated";
    case InputEnd::not_realtime: return "not real-time safe";
    case InputEnd::unable: break;
  }
  return "unable to run";
}

std::string without_numbers_in(const std::string& sentence) {
  std::string text;
  for (const char letter : sentence)
    if (std::isdigit(static_cast<unsigned char>(letter)) == 0)
      text += letter;
    else if (text.empty() || text.back() != '#')
      text += '#';
  return text;
}

InputOutcome run_inputs(RunParts& parts, const Inputs& inputs, MemoryFill fill,
                        const std::filesystem::path& recording) {
  const FilledMemory filled(fill);
  return InputRun(parts, inputs).go(recording);
}

Result<std::vector<NamedSeries>> series_of_run(const FuzzSetup& setup, const Inputs& inputs) {
  RunParts parts{setup, RunTable(series_of_joints(setup), setup.plan.time_step), std::nullopt};
  InputRun run(parts, inputs);
  const InputOutcome outcome = run.go({});
  if (outcome.end == InputEnd::unable) return error(outcome.sentence);
  return run.series();
}

}  // namespace rehearse
