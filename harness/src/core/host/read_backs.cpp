#include "read_backs.h"

#include <algorithm>

#include "controller_host.h"

namespace rehearse {
namespace {

/// True for an effort that is measured: its reading isn't the command.
bool is_measured(const ScenarioBody& body, const IoField& field) {
  if (field.quantity != Quantity::u) return false;
  const auto joint = static_cast<std::size_t>(field.joint);
  const bool has_actuator = joint < body.actuators.size() && body.actuators[joint];
  return has_actuator || (joint < body.errors.joints.size() && !body.errors.joints[joint].quantities.empty());
}

bool is_read(const std::vector<HostedController>& controllers, int body, const IoField& field) {
  return std::ranges::any_of(controllers, [&](const HostedController& hosted) {
    const auto reads = [&](const IoField& input) {
      return input.link == field.link && input.quantity == field.quantity;
    };
    return hosted.running && hosted.body == body && std::ranges::any_of(hosted.io->inputs().fields, reads);
  });
}

}  // namespace

std::size_t ReadBacks::place_of(int body, int link, Quantity quantity) const {
  const auto found = std::ranges::find_if(values_, [&](const Value& value) {
    return value.body == body && value.link == link && value.quantity == quantity;
  });
  return static_cast<std::size_t>(found - values_.begin());
}

void ReadBacks::find(const Scenario& scenario, const std::vector<HostedController>& controllers) {
  for (const HostedController& hosted : controllers) {
    bodies_.push_back(hosted.body);
    if (!hosted.running) continue;
    for (const IoField& field : hosted.io->outputs().fields) {
      const bool is_target = field.quantity == Quantity::q || field.quantity == Quantity::dq;
      if (is_target || is_measured(scenario.bodies[static_cast<std::size_t>(hosted.body)], field)) continue;
      if (is_read(controllers, hosted.body, field) &&
          place_of(hosted.body, field.link, field.quantity) == values_.size())
        values_.push_back({hosted.body, field.link, field.quantity});
    }
  }
  for (const HostedController& hosted : controllers) {
    auto& read = read_.emplace_back();
    if (!hosted.running) continue;
    for (const IoField& field : hosted.io->inputs().fields)
      if (const std::size_t place = place_of(hosted.body, field.link, field.quantity); place < values_.size())
        read.emplace_back(field, place);
  }
}

void ReadBacks::begin_late_outputs() {
  for (Value& value : values_) {
    if (value.quantity == Quantity::u) continue;
    value.is_known = value.quantity == Quantity::wrench;  // of a wrench: none, until there is an output
    value.numbers = {};
  }
}

void ReadBacks::clear_wrenches() {
  for (Value& value : values_)
    if (value.quantity == Quantity::wrench) value.numbers = {};
}

void ReadBacks::take(std::size_t controller, const IoField& field, std::span<const double> values, Timing timing) {
  if (values_.empty() || (timing == Timing::same_step && field.quantity != Quantity::u)) return;
  const std::size_t place = place_of(bodies_[controller], field.link, field.quantity);
  if (place == values_.size()) return;
  Value& value = values_[place];
  value.is_known = true;
  const bool adds = field.quantity == Quantity::wrench;
  for (std::size_t i = 0; i < values.size(); ++i) value.numbers[i] = (adds ? value.numbers[i] : 0.0) + values[i];
}

void ReadBacks::give(std::size_t controller, ControllerIo& io) const {
  if (!is_on_ || values_.empty()) return;
  for (const auto& [field, place] : read_[controller])
    if (values_[place].is_known) io.replace_input(field, values_[place].numbers);
}

}  // namespace rehearse
