#include <rehearse/faults.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <utility>

#include "yaml/yaml_tree.h"

namespace rehearse {
namespace {

std::string part_of(const char* kind, std::string_view name) { return fmt::format("{}: {}", kind, yaml_text(name)); }

std::string offset_text(std::string_view quantity, const std::string& by) {
  return fmt::format("offset, quantity: {}, by: {}", yaml_text(quantity), by);
}

}  // namespace

Faults& Faults::add(const std::string& part, const std::string& fault, FaultTime when) {
  std::string entry = fmt::format("{{{}, fault: {}, from: {}", part, fault, when.from);
  if (!std::isinf(when.until)) entry += fmt::format(", until: {}", when.until);
  entries_.push_back(entry + '}');
  return *this;
}

Faults::OfReadings Faults::sensor(std::string_view name) { return {*this, part_of("sensor", name)}; }
Faults::OfReadings Faults::encoder(std::string_view joint) { return {*this, part_of("encoder", joint)}; }
Faults::OfActuator Faults::actuator(std::string_view joint) { return {*this, part_of("actuator", joint)}; }

Faults& Faults::OfReadings::stuck(FaultTime when) const { return faults_.add(part_, "stuck", when); }
Faults& Faults::OfReadings::lost(FaultTime when) const { return faults_.add(part_, "lost", when); }
Faults& Faults::OfReadings::delayed(double by, FaultTime when) const {
  return faults_.add(part_, fmt::format("delayed, by: {}", by), when);
}
Faults& Faults::OfReadings::offset(std::string_view quantity, double by, FaultTime when) const {
  return faults_.add(part_, offset_text(quantity, fmt::format("{}", by)), when);
}
Faults& Faults::OfReadings::offset(std::string_view quantity, const std::array<double, 3>& by, FaultTime when) const {
  return faults_.add(part_, offset_text(quantity, fmt::format("[{}]", fmt::join(by, ", "))), when);
}

Faults& Faults::OfActuator::dead(FaultTime when) const { return faults_.add(part_, "dead", when); }
Faults& Faults::OfActuator::weak(double effort, FaultTime when) const {
  return faults_.add(part_, fmt::format("weak, effort: {}", effort), when);
}
Faults& Faults::OfActuator::reversed(FaultTime when) const { return faults_.add(part_, "reversed", when); }

}  // namespace rehearse
