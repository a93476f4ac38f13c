#include "output_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cnoid/Device>

#include "core/compare/compared_traces.h"
#include "core/compare/divergence_text.h"
#include "core/kinds/channel_name.h"

namespace rehearse {
namespace {

std::string text_of_flag(const OutputField& field, bool actual) {
  if (field.element == "commanded")
    return actual ? "the device is commanded, expected no command" : "the device isn't commanded, expected a command";
  if (field.element.starts_with("running"))
    return actual ? "the controller takes part, but is expected not to"
                  : "the controller doesn't take part as expected";
  return fmt::format("control() of '{}' returned {}, expected {}", field.controller, actual, !actual);
}

}  // namespace

Divergence place_of(const OutputField& field) {
  Divergence place;
  place.channel = field.channel;
  place.element = field.element;
  place.stage = Stage::controller;
  return place;
}

std::optional<Divergence> difference(const OutputField& field, std::uint64_t expected, std::uint64_t actual) {
  if (expected == actual) return std::nullopt;
  Divergence found = place_of(field);
  put_cells(found, field.kind, expected, actual);
  found.unit = field.unit;
  if (field.kind == CellKind::boolean) found.note = text_of_flag(field, actual != 0);
  return found;
}

OutputRecord::OutputRecord(const ControllerHost& host, const Scenario& scenario) : host_(host) {
  for (std::size_t i = 0; i < host.controllers().size(); ++i) {
    const HostedController& hosted = host.controllers()[i];
    const Model& model = *scenario.bodies[hosted.body].model;
    devices_.emplace_back();
    add(hosted, run_topics::tick, fmt::format("running/{}", i), "", CellKind::boolean);
    add(hosted, run_topics::tick, fmt::format("controller_results/{}", i), "", CellKind::boolean);
    has_outputs_.push_back(hosted.running);
    if (hosted.running) add_outputs(hosted, model);
    if (hosted.parent < 0 && hosted.io_body) add_devices(hosted, model);
  }
  row_.resize(fields_.size());
}

void OutputRecord::add(const HostedController& hosted, std::string channel, std::string element, std::string unit,
                       CellKind kind) {
  fields_.push_back({hosted.label, std::move(channel), std::move(element), std::move(unit), kind});
}

void OutputRecord::add_outputs(const HostedController& hosted, const Model& model) {
  for (const IoField& field : hosted.io->outputs().fields) {
    const Link& link = model.links[field.link];
    const ChannelKind kind = channel_kind_of(field.quantity);
    const bool of_joint = field.quantity <= Quantity::u;
    const std::string channel =
        ChannelName::of_controller(hosted.label, ChannelSide::output, kind, of_joint ? "" : link.name).topic();
    if (of_joint) {
      const std::string quantity = name_of(field.quantity);
      const std::string unit(unit_of_joint(quantity, is_linear(link.joint.type)));
      add(hosted, channel, link.joint.name + "/" + quantity, unit, CellKind::floating);
      continue;
    }
    for (const ChannelElement& element : elements_of(kind))
      add(hosted, channel, element.name, std::string(element.unit), CellKind::floating);
  }
}

void OutputRecord::add_devices(const HostedController& hosted, const Model& model) {
  for (std::size_t d = 0; d < model.devices.size(); ++d) {
    DevicePlace& place = devices_.back().emplace_back();
    place.begin = fields_.size();
    place.values =
        static_cast<std::size_t>(std::max(0, hosted.io_body->body().device(static_cast<int>(d))->stateSize()));
    const std::string channel =
        ChannelName::of_controller(hosted.label, ChannelSide::output, ChannelKind::device_state, model.devices[d].name)
            .topic();
    add(hosted, channel, "commanded", "", CellKind::boolean);
    for (std::size_t i = 0; i < place.values; ++i)
      add(hosted, channel, fmt::format("values/{}", i), "", CellKind::floating);
  }
}

const std::vector<std::uint64_t>& OutputRecord::row() {
  std::ranges::fill(row_, 0);
  std::size_t word = 0;
  for (std::size_t i = 0; i < host_.controllers().size(); ++i) {
    const HostedController& hosted = host_.controllers()[i];
    row_[word++] = hosted.running ? 1 : 0;
    row_[word++] = hosted.tick.result ? 1 : 0;
    if (has_outputs_[i])
      for (const double value : hosted.io->output_values()) row_[word++] = std::bit_cast<std::uint64_t>(value);
    for (const DeviceOutput& output : hosted.tick.device_outputs) {
      const DevicePlace& place = devices_[i][static_cast<std::size_t>(output.device)];
      row_[place.begin] = 1;
      for (std::size_t v = 0; v < std::min(place.values, output.values.size()); ++v)
        row_[place.begin + 1 + v] = std::bit_cast<std::uint64_t>(output.values[v]);
    }
    for (const DevicePlace& place : devices_[i]) word = place.begin + 1 + place.values;
  }
  REHEARSE_ASSERT(word == fields_.size(), "a row has a word for each field");
  return row_;
}

}  // namespace rehearse
