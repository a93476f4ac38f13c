#include "flight_writer.h"

#include <fmt/format.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/tap.h>
#include <rehearse/tap_ring.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include "core/kinds/channel_name.h"
#include "core/recording/device_recorder.h"
#include "core/recording/recorded_sources.h"
#include "core/recording/side_recorder.h"
#include "core/recording/trace_output.h"
#include "core/trace/run_facts.h"
#include "loop_tick.h"

namespace rehearse {
namespace {

constexpr const char *loop_topic = "/flight/loop", *images_topic = "/flight/images";
constexpr std::size_t most_variables = 1000;

constexpr std::pair<int, std::vector<double> msg::JointState::*> quantities[] = {
    {REHEARSE_TAP_Q, &msg::JointState::position},
    {REHEARSE_TAP_DQ, &msg::JointState::velocity},
    {REHEARSE_TAP_U, &msg::JointState::effort}};

/// The joints of all series of a kind as one message.
class JointSide {
 public:
  JointSide() = default;
  JointSide(const TapDefinitions& definitions, TapSeries::Kind kind) {
    std::vector<JointElement> places;
    for (const TapSeries& series : definitions.series) {
      begins_.push_back(places.size());
      if (series.kind != kind) continue;
      for (const auto& [bit, array] : quantities) {
        if (!(series.quantities & bit)) continue;
        for (const std::string& name : series.names) places.push_back({array, index_of(name)});
      }
    }
    has_numbers_ = !places.empty();
    if (has_numbers_) message = joint_message(names_, places);
  }

  bool has_numbers() const { return has_numbers_; }
  const std::vector<std::string>& names() const { return names_; }
  void set(std::size_t series, std::span<const double> numbers) { message.set(numbers, begins_[series]); }

  FixedMessage message;

 private:
  std::size_t index_of(const std::string& name) {
    const auto [known, is_new] = indices_.try_emplace(name, names_.size());
    if (is_new) names_.push_back(name);
    return known->second;
  }

  std::vector<std::string> names_;
  std::map<std::string, std::size_t> indices_;
  std::vector<std::size_t> begins_;  // number of a series' first number, by series
  bool has_numbers_ = false;
};

/// The state of all joints of the model, as far as the loop reads it.
class BodyJoints {
 public:
  BodyJoints() = default;
  BodyJoints(const FlightPlan& plan) {
    const Model& model = *plan.scenario.bodies[0].model;
    std::vector<std::string> names;
    for (const int link : model.joints) names.push_back(model.links[link].joint.name);
    int all = 0;
    for (const TapSeries& series : plan.definitions.series)
      if (series.kind == TapSeries::Kind::joints) all |= series.quantities;
    std::vector<JointElement> places;
    std::map<std::pair<int, std::string>, std::size_t> numbers;
    for (const auto& [bit, array] : quantities)
      for (std::size_t i = 0; (all & bit) && i < names.size(); ++i) {
        numbers[{bit, names[i]}] = places.size();
        places.push_back({array, i});
      }
    for (const TapSeries& series : plan.definitions.series) {
      std::vector<std::size_t>& slots = slots_.emplace_back();
      if (series.kind != TapSeries::Kind::joints) continue;
      for (const auto& [bit, array] : quantities)
        for (std::size_t i = 0; (series.quantities & bit) && i < series.names.size(); ++i) {
          const auto known = numbers.find({bit, series.names[i]});
          slots.push_back(known == numbers.end() ? none : known->second);
        }
    }
    has_numbers_ = !places.empty();
    if (!has_numbers_) return;
    message = joint_message(names, places);
    for (std::size_t i = 0; i < places.size(); ++i) message.set(i, std::numeric_limits<double>::quiet_NaN());
  }

  bool has_numbers() const { return has_numbers_; }
  void set(std::size_t series, std::span<const double> numbers) {
    for (std::size_t i = 0; i < numbers.size(); ++i)
      if (slots_[series][i] != none) message.set(slots_[series][i], numbers[i]);
  }

  FixedMessage message;

 private:
  static constexpr std::size_t none = ~std::size_t{0};
  std::vector<std::vector<std::size_t>> slots_;  // numbers of the message, by series and number
  bool has_numbers_ = false;
};

}  // namespace

struct FlightWriter::Impl : TraceOutput {
  explicit Impl(const FlightPlan& of) : TraceOutput(of.time_step), plan(of) {}

  const FlightPlan& plan;
  JointSide inputs, commands;
  BodyJoints state;
  std::uint16_t inputs_channel = 0, commands_channel = 0, state_channel = 0, loop_channel = 0, tick_channel = 0,
                event_channel = 0;
  std::optional<std::uint16_t> images_channel;         // from the first picture on
  std::vector<DeviceRecorder> devices;                 // of FlightPlan::devices
  std::map<std::size_t, std::uint16_t> other_devices;  // channels of series whose device has no kind
  std::vector<const TapEntry*> of_series;              // the last entry of the tick, by series
  std::map<std::string, std::uint16_t, std::less<>> variable_channels;
  DeviceReading reading;
  msg::LoopTick loop;
  msg::Tick tick_message;

  Result<void> write_sources();
  void declare();
  std::uint16_t joints(const ChannelName& name, const std::vector<std::string>& names, mcap::StringMap metadata = {});
  Result<void> write_inputs(std::int64_t tick);
  Result<void> write_device(std::int64_t tick, std::size_t series);
  Result<void> write_image(std::int64_t tick, const TapEntry& entry);
  Result<void> write_words(const TapTick& tick);
};

Result<void> FlightWriter::Impl::write_sources() {
  if (plan.has_model) {
    for (const SourceFile& source : sources_of(plan.scenario))
      REHEARSE_TRY(writer->add_attachment(source.name, source.media_type, std::as_bytes(std::span(source.text))));
  }
  REHEARSE_TRY(writer->add_metadata(records::provenance, plan.provenance));
  return writer->add_metadata(records::flight, plan.flight);
}

/// Adds a channel of joints, with the units of those that the model has.
std::uint16_t FlightWriter::Impl::joints(const ChannelName& name, const std::vector<std::string>& names,
                                         mcap::StringMap metadata) {
  const Model& model = *plan.scenario.bodies[0].model;
  std::vector<int> ids;
  for (const std::string& joint : names)
    if (const int link = model.find_joint(joint); link >= 0) ids.push_back(model.links[link].joint.id);
  metadata.merge(joint_metadata(name.kind, model, ids));
  return channel<msg::JointState>(name, std::move(metadata));
}

void FlightWriter::Impl::declare() {
  const ScenarioBody& body = plan.scenario.bodies[0];
  inputs = JointSide(plan.definitions, TapSeries::Kind::joints);
  commands = JointSide(plan.definitions, TapSeries::Kind::commands);
  state = BodyJoints(plan);
  if (state.has_numbers()) {
    std::vector<std::string> names;
    for (const int link : body.model->joints) names.push_back(body.model->links[link].joint.name);
    state_channel = joints(ChannelName::of_body(body.name, ChannelKind::joints), names);
  }
  for (const Device& device : plan.devices) devices.emplace_back(*this, plan.scenario, body, device);
  for (std::size_t i = 0; i < plan.definitions.series.size(); ++i) {
    const TapSeries& series = plan.definitions.series[i];
    if (!series.is_of_joints() && !plan.device_of[i])
      other_devices[i] =
          channel<msg::DeviceState>(ChannelName::of_owner(body.name, series.device, ChannelKind::device_state));
  }
  const auto of_side = [&](ChannelSide side) {
    return ChannelName::of_controller(plan.label, side, ChannelKind::joints);
  };
  if (inputs.has_numbers()) inputs_channel = joints(of_side(ChannelSide::input), inputs.names());
  if (commands.has_numbers())
    commands_channel = joints(of_side(ChannelSide::output), commands.names(), {{"delay", "false"}});
  event_channel = channel<msg::Event>(ChannelName::of_run(ChannelKind::events));
  loop_channel =
      writer->add_channel(writer->add_schema(msg::LoopTick::type_name, "ros2msg", msg::schema_text<msg::LoopTick>()),
                          loop_topic, "cdr", {{"unit:loop_time", "ns"}});
  tick_channel = channel<msg::Tick>(ChannelName::of_run(ChannelKind::tick));
  of_series.resize(plan.definitions.series.size());
}

Result<void> FlightWriter::Impl::write_device(std::int64_t tick, std::size_t series) {
  const std::span<const double> numbers = of_series[series]->numbers;
  if (const auto device = plan.device_of[series]) {
    reading.fresh = true;
    reading.measured_at = time_of(tick, time_step);
    reading.values.assign(numbers.begin(), numbers.end());
    return devices[*device].write(*this, tick, reading);
  }
  msg::DeviceState message;
  message.header = {stamp(tick), plan.scenario.bodies[0].name + "/" + plan.definitions.series[series].device};
  message.values.assign(numbers.begin(), numbers.end());
  return write(other_devices.at(series), tick, message);
}

/// The values of the devices and of the joints, in the order of a recording.
Result<void> FlightWriter::Impl::write_inputs(std::int64_t tick) {
  bool has_inputs = false;
  loop.absent.clear();
  for (std::size_t i = 0; i < of_series.size(); ++i) {
    const TapSeries& series = plan.definitions.series[i];
    const bool has_values = of_series[i] && of_series[i]->kind == tap_values;
    if (!has_values && series.kind != TapSeries::Kind::commands)
      loop.absent += (loop.absent.empty() ? "" : ", ") + (series.device.empty() ? "joints" : series.device);
    if (!has_values || series.kind != TapSeries::Kind::joints) continue;
    inputs.set(i, of_series[i]->numbers);
    if (state.has_numbers()) state.set(i, of_series[i]->numbers);
    has_inputs = true;
  }
  if (state.has_numbers()) REHEARSE_TRY(write(state_channel, tick, state.message));
  for (std::size_t i = 0; i < of_series.size(); ++i) {
    const bool has_values = of_series[i] && of_series[i]->kind == tap_values;
    if (has_values && !plan.definitions.series[i].is_of_joints()) REHEARSE_TRY(write_device(tick, i));
  }
  return has_inputs ? write(inputs_channel, tick, inputs.message) : Result<void>();
}

Result<void> FlightWriter::Impl::write_image(std::int64_t tick, const TapEntry& entry) {
  if (!images_channel)
    images_channel = writer->add_channel(
        writer->add_schema(msg::ImageReference::type_name, "ros2msg", msg::schema_text<msg::ImageReference>()),
        images_topic, "cdr");
  return write(*images_channel, tick,
               msg::ImageReference{stamp(tick), tick, std::string(entry.device), std::string(entry.text)});
}

/// Variables, lines, marks and names of pictures.
Result<void> FlightWriter::Impl::write_words(const TapTick& tick) {
  std::map<std::string_view, double> variables;  // of several values of a tick the last one counts
  for (const TapEntry& entry : tick.entries) {
    if (entry.kind == tap_variable) variables[entry.text] = entry.numbers[0];
    if (entry.kind == tap_image) REHEARSE_TRY(write_image(tick.tick, entry));
    if (entry.kind != tap_text && entry.kind != tap_mark) continue;
    const bool is_mark = entry.kind == tap_mark;
    const std::string text = is_mark ? fmt::format("mark: {}", entry.text) : std::string(entry.text);
    REHEARSE_TRY(write(event_channel, tick.tick,
                       msg::Event{stamp(tick.tick), tick.tick, "note", is_mark ? "log" : plan.label, text}));
  }
  for (const auto& [name, value] : variables) {
    auto known = variable_channels.find(name);
    if (known == variable_channels.end()) {
      if (variable_channels.size() == most_variables) continue;
      const std::uint16_t id = channel<msg::Float64>(ChannelName::of_variable(plan.label, std::string(name)));
      known = variable_channels.emplace(name, id).first;
      if (variable_channels.size() == most_variables)
        REHEARSE_TRY(write(event_channel, tick.tick,
                           msg::Event{stamp(tick.tick), tick.tick, "warning", "log",
                                      fmt::format("the loop uses {} variables or more: only the first {} are recorded",
                                                  most_variables, most_variables)}));
    }
    REHEARSE_TRY(write(known->second, tick.tick, msg::Float64{value}));
  }
  return {};
}

FlightWriter::FlightWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FlightWriter::~FlightWriter() = default;
std::int64_t FlightWriter::ticks() const { return impl_->size.ticks; }

Result<std::unique_ptr<FlightWriter>> FlightWriter::create(const std::filesystem::path& file, const FlightPlan& plan) {
  auto impl = std::make_unique<Impl>(plan);
  impl->writer = REHEARSE_TRY(mcap::Writer::create(file));
  REHEARSE_TRY(impl->write_sources());
  impl->declare();
  return std::unique_ptr<FlightWriter>(new FlightWriter(std::move(impl)));
}

Result<void> FlightWriter::write(const TapTick& tick, std::uint64_t dropped) {
  Impl& impl = *impl_;
  std::ranges::fill(impl.of_series, nullptr);
  for (const TapEntry& entry : tick.entries)
    if (entry.kind == tap_values || entry.kind == tap_absent) impl.of_series[entry.series] = &entry;
  REHEARSE_TRY(impl.write_inputs(tick.tick));
  bool has_commands = false;
  for (std::size_t i = 0; i < impl.of_series.size(); ++i) {
    if (impl.plan.definitions.series[i].kind != TapSeries::Kind::commands || !impl.of_series[i] ||
        impl.of_series[i]->kind != tap_values)
      continue;
    impl.commands.set(i, impl.of_series[i]->numbers);
    has_commands = true;
  }
  if (has_commands) REHEARSE_TRY(impl.write(impl.commands_channel, tick.tick, impl.commands.message));
  REHEARSE_TRY(impl.write_words(tick));
  impl.loop.stamp = impl.stamp(tick.tick);
  impl.loop.tick = tick.tick;
  impl.loop.loop_time = tick.loop_time;
  impl.loop.dropped = dropped;
  REHEARSE_TRY(impl.write(impl.loop_channel, tick.tick, impl.loop));
  impl.tick_message.stamp = impl.stamp(tick.tick);
  impl.tick_message.tick = tick.tick;
  impl.tick_message.controller_results.assign(1, true);
  ++impl.size.ticks;
  return impl.write(impl.tick_channel, tick.tick, impl.tick_message);
}

Result<void> FlightWriter::write_event(std::int64_t tick, const std::string& severity, const std::string& text) {
  return impl_->write(impl_->event_channel, tick, msg::Event{impl_->stamp(tick), tick, severity, "log", text});
}

Result<void> FlightWriter::sync() {
  REHEARSE_TRY(impl_->writer->flush());
  if (::fsync(impl_->writer->descriptor()) == 0 || errno == EINVAL || errno == ENOSYS) return {};
  return error(fmt::format("the disk didn't take the recording: {}", std::strerror(errno)));
}

std::uint64_t FlightWriter::size() const {
  struct stat found {};
  return ::fstat(impl_->writer->descriptor(), &found) == 0 ? static_cast<std::uint64_t>(found.st_size) : 0;
}

Result<void> FlightWriter::close(std::optional<std::int64_t> ticks) {
  mcap::StringMap read;
  for (const TapSeries& series : impl_->plan.definitions.series)
    if (!series.is_of_joints()) read[series.body + "/" + series.device] = impl_->plan.label;
  REHEARSE_TRY(impl_->writer->add_metadata(records::devices_read, read));
  if (ticks) REHEARSE_TRY(impl_->writer->add_metadata(records::outcome, RunOutcome{.ticks = ticks}.metadata()));
  REHEARSE_TRY(sync());
  return impl_->writer->close();
}

}  // namespace rehearse
