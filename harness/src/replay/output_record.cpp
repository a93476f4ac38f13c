#include "output_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cnoid/Device>

#include "recording/topic_segment.h"

namespace rehearse {
namespace {

struct LinkQuantity {
  const char* channel;
  std::vector<std::pair<const char*, const char*>> elements;  // with their units
};

const LinkQuantity& words_of(Quantity quantity) {
  static const LinkQuantity pose{"pose",
                                 {{"position/x", "m"},
                                  {"position/y", "m"},
                                  {"position/z", "m"},
                                  {"orientation/x", ""},
                                  {"orientation/y", ""},
                                  {"orientation/z", ""},
                                  {"orientation/w", ""}}};
  static const LinkQuantity twist{"twist",
                                  {{"linear/x", "m/s"},
                                   {"linear/y", "m/s"},
                                   {"linear/z", "m/s"},
                                   {"angular/x", "rad/s"},
                                   {"angular/y", "rad/s"},
                                   {"angular/z", "rad/s"}}};
  static const LinkQuantity acceleration{"accel",
                                         {{"linear_acceleration/x", "m/s²"},
                                          {"linear_acceleration/y", "m/s²"},
                                          {"linear_acceleration/z", "m/s²"},
                                          {"angular_acceleration/x", "rad/s²"},
                                          {"angular_acceleration/y", "rad/s²"},
                                          {"angular_acceleration/z", "rad/s²"}}};
  static const LinkQuantity wrench{"wrench",
                                   {{"force/x", "N"},
                                    {"force/y", "N"},
                                    {"force/z", "N"},
                                    {"torque/x", "N·m"},
                                    {"torque/y", "N·m"},
                                    {"torque/z", "N·m"}}};
  switch (quantity) {
    case Quantity::pose: return pose;
    case Quantity::twist: return twist;
    case Quantity::acceleration: return acceleration;
    default: return wrench;
  }
}

std::string joint_unit(const Joint& joint, Quantity quantity) {
  const std::string length = is_linear(joint.type) ? "m" : "rad";
  switch (quantity) {
    case Quantity::q: return length;
    case Quantity::dq: return length + "/s";
    case Quantity::ddq: return length + "/s²";
    default: return is_linear(joint.type) ? "N" : "N·m";
  }
}

}  // namespace

OutputRecord::OutputRecord(const ControllerHost& host, const Scenario& scenario) : host_(host) {
  for (std::size_t i = 0; i < host.controllers().size(); ++i) {
    const HostedController& hosted = host.controllers()[i];
    const Model& model = *scenario.bodies[hosted.body].model;
    devices_.emplace_back();
    add(hosted, "/tick", fmt::format("running/{}", i), "", OutputField::Kind::flag);
    add(hosted, "/tick", fmt::format("controller_results/{}", i), "", OutputField::Kind::flag);
    has_outputs_.push_back(hosted.running);
    if (hosted.running) add_outputs(hosted, model);
    if (hosted.parent < 0 && hosted.io_body) add_devices(hosted, model);
  }
  row_.resize(fields_.size());
}

void OutputRecord::add(const HostedController& hosted, std::string channel, std::string element, std::string unit,
                       OutputField::Kind kind) {
  fields_.push_back({hosted.label, std::move(channel), std::move(element), std::move(unit), kind});
}

void OutputRecord::add_outputs(const HostedController& hosted, const Model& model) {
  const std::string prefix = "/" + hosted.label + "/output/";
  for (const IoField& field : hosted.io->outputs().fields) {
    const Link& link = model.links[field.link];
    if (field.quantity <= Quantity::u) {
      const bool acceleration = field.quantity == Quantity::ddq;
      add(hosted, prefix + (acceleration ? "joint_accelerations" : "joints"),
          link.joint.name + "/" + name_of(field.quantity), joint_unit(link.joint, field.quantity),
          OutputField::Kind::number);
      continue;
    }
    const LinkQuantity& words = words_of(field.quantity);
    for (const auto& [element, unit] : words.elements)
      add(hosted, prefix + topic_segment(link.name) + "/" + words.channel, element, unit, OutputField::Kind::number);
  }
}

void OutputRecord::add_devices(const HostedController& hosted, const Model& model) {
  for (std::size_t d = 0; d < model.devices.size(); ++d) {
    DevicePlace& place = devices_.back().emplace_back();
    place.begin = fields_.size();
    place.values =
        static_cast<std::size_t>(std::max(0, hosted.io_body->body().device(static_cast<int>(d))->stateSize()));
    const std::string channel = "/" + hosted.label + "/output/" + topic_segment(model.devices[d].name) + "/state";
    add(hosted, channel, "told", "", OutputField::Kind::flag);
    for (std::size_t i = 0; i < place.values; ++i)
      add(hosted, channel, fmt::format("values/{}", i), "", OutputField::Kind::number);
  }
}

const std::vector<std::uint64_t>& OutputRecord::row() {
  std::fill(row_.begin(), row_.end(), 0);
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
