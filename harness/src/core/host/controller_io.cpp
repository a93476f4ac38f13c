#include "controller_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "cnoid_body.h"
#include "usable_outputs.h"

namespace rehearse {
namespace {

using CnoidLink = cnoid::Link;

constexpr int joint_modes = CnoidLink::JointDisplacement | CnoidLink::JointVelocity | CnoidLink::JointEffort;

/// The quantities for a link's state flags, in the order of Quantity. A link without a joint id has no joint
/// quantities.
struct FlagQuantity {
  int input_flag;
  Quantity quantity;
  int output_flags = input_flag;
};
constexpr FlagQuantity flag_quantities[] = {
    {CnoidLink::JointDisplacement, Quantity::q},
    {CnoidLink::JointVelocity, Quantity::dq, CnoidLink::JointVelocity | CnoidLink::DeprecatedJointSurfaceVelocity},
    {CnoidLink::JointAcceleration, Quantity::ddq},
    {CnoidLink::JointEffort, Quantity::u},
    {CnoidLink::LinkPosition, Quantity::pose},
    {CnoidLink::LinkTwist, Quantity::twist},
    {CnoidLink::LinkAcceleration, Quantity::acceleration},
    {CnoidLink::LinkExtWrench, Quantity::wrench},
};

/// The meaning of enableInput(link) in an actuation mode; as in Choreonoid since 2.1.
int default_input(const CnoidLink& link) {
  const int mode = link.actuationMode();
  int flags = CnoidLink::StateNone;
  if ((mode & joint_modes) && link.jointType() != CnoidLink::PseudoContinuousTrackJoint)
    flags |= CnoidLink::JointDisplacement;
  if (mode & CnoidLink::LinkExtWrench) flags |= CnoidLink::LinkPosition;
  return flags;
}

/// A joint's number in the observation and in the controller's link, in the order of Quantity.
struct JointQuantity {
  double JointReading::*observed;
  double& (CnoidLink::*input)();
  double& (CnoidLink::*command)();
};
constexpr JointQuantity joint_quantities[] = {
    {&JointReading::q, &CnoidLink::q, &CnoidLink::q_target},
    {&JointReading::dq, &CnoidLink::dq, &CnoidLink::dq_target},
    {&JointReading::ddq, &CnoidLink::ddq, &CnoidLink::ddq},
    {&JointReading::u, &CnoidLink::u, &CnoidLink::u},
};
const JointQuantity& joint_quantity_of(Quantity quantity) { return joint_quantities[static_cast<int>(quantity)]; }

void put(double* target, const cnoid::Vector3& v) { std::copy(v.data(), v.data() + 3, target); }
cnoid::Vector3 vector(const double* source) { return {source[0], source[1], source[2]}; }

/// Reads one observed quantity of a link as numbers.
void gather(Quantity quantity, const BodyObservation& seen, std::size_t index, double* values) {
  const LinkReading& link = seen.links[index];
  switch (quantity) {
    case Quantity::pose:
      put(values, link.position);
      std::copy(link.rotation.coeffs().data(), link.rotation.coeffs().data() + 4, values + 3);
      break;
    case Quantity::twist:
      put(values, link.velocity);
      put(values + 3, link.angular_velocity);
      break;
    case Quantity::acceleration:
      put(values, link.acceleration);
      put(values + 3, link.angular_acceleration);
      break;
    case Quantity::wrench: {  // each step sets the simulated wrench to zero
      const Wrench wrench = seen.external.empty() ? Wrench() : seen.external[index];
      put(values, wrench.force);
      put(values + 3, wrench.torque);
      break;
    }
    default: break;
  }
}

/// Writes the numbers of one quantity of a link into the controller's link.
void scatter(Quantity quantity, const double* values, CnoidLink& link) {
  switch (quantity) {
    case Quantity::pose:
      link.T().translation() = vector(values);
      link.T().linear() = Eigen::Quaterniond(values[6], values[3], values[4], values[5]).toRotationMatrix();
      break;
    case Quantity::twist:
      link.v() = vector(values);
      link.w() = vector(values + 3);
      break;
    case Quantity::acceleration:
      link.dv() = vector(values);
      link.dw() = vector(values + 3);
      break;
    case Quantity::wrench: std::copy(values, values + 6, link.F_ext().data()); break;
    default: break;
  }
}

/// Reads one commanded quantity of the controller's link as numbers.
void gather_command(Quantity quantity, const CnoidLink& link, double* values) {
  switch (quantity) {
    case Quantity::pose: {
      const Eigen::Quaterniond rotation(Eigen::Matrix3d(link.R()));
      put(values, link.p());
      std::copy(rotation.coeffs().data(), rotation.coeffs().data() + 4, values + 3);
      break;
    }
    case Quantity::twist:
      put(values, link.v());
      put(values + 3, link.w());
      break;
    case Quantity::acceleration:
      put(values, link.dv());
      put(values + 3, link.dw());
      break;
    case Quantity::wrench: std::copy(link.F_ext().data(), link.F_ext().data() + 6, values); break;
    default: break;
  }
}

}  // namespace

ControllerIo::ControllerIo(std::string name, std::string run_options, std::string own_options, double time_step)
    : name_(std::move(name)),
      run_options_(std::move(run_options)),
      own_options_(std::move(own_options)),
      time_step_(time_step) {}

void ControllerIo::attach(IoBody& body) {
  io_body_ = &body;
  body_ = &body.body();
  configuring_ = false;
  frozen_ = false;
  input_flags_.assign(body_->numLinks(), 0);
  output_on_.assign(body_->numLinks(), false);
  output_modes_.assign(body_->numLinks(), 0);
}

const cnoid::Link& ControllerIo::checked(const cnoid::Link* link, const char* function) const {
  if (!link) throw std::invalid_argument(fmt::format("{}: the link is null", function));
  if (!io_body_) throw std::invalid_argument(fmt::format("{} is for initialize(), not for configure()", function));
  if (link->index() < 0)
    throw std::invalid_argument(
        fmt::format("{}: the link is a dummy that fills a hole in the joint ids; it belongs to no robot", function));
  if (link->index() >= body_->numLinks())
    throw std::invalid_argument(fmt::format("{}: link '{}' belongs to another body", function, link->name()));
  return *link;
}

void ControllerIo::enableIO(CnoidLink* link) {
  enableInput(link);
  enableOutput(link);
}

void ControllerIo::enableInput(CnoidLink* link) { enableInput(link, default_input(checked(link, "enableInput"))); }

void ControllerIo::enableInput(CnoidLink* link, int flags) {
  const CnoidLink& known = checked(link, "enableInput");
  if (note_if_too_late()) return;
  input_flags_[known.index()] |= flags;
  link->mergeSensingMode(static_cast<short>(flags));
}

void ControllerIo::enableInput(cnoid::Device* device) {
  if (!device) throw std::invalid_argument("enableInput: the device is null");
  if (!io_body_) throw std::invalid_argument("enableInput is for initialize(), not for configure()");
  if (device->body() != body_)
    throw std::invalid_argument(fmt::format("enableInput: device '{}' belongs to another body", device->name()));
  if (note_if_too_late()) return;
  if (std::ranges::find(input_devices_, device->index()) == input_devices_.end())
    input_devices_.push_back(device->index());
  io_body_->enable(*device);
}

void ControllerIo::enableOutput(CnoidLink* link) {
  const CnoidLink& known = checked(link, "enableOutput");
  if (!note_if_too_late()) output_on_[known.index()] = true;
}

void ControllerIo::enableOutput(CnoidLink* link, int flags) {
  checked(link, "enableOutput");
  if (note_if_too_late()) return;
  link->setActuationMode(static_cast<short>(flags));
  output_on_[link->index()] = true;
}

void ControllerIo::setJointInput(int flags) {
  for (CnoidLink* joint : body_->joints())
    if (joint->isValid()) enableInput(joint, flags);
}

void ControllerIo::setJointOutput(int flags) {
  for (CnoidLink* joint : body_->joints())
    if (joint->isValid()) enableOutput(joint, flags);
}

std::vector<std::string> ControllerIo::freeze() {
  std::vector<std::string> findings;
  frozen_ = true;
  for (int i = 0; i < body_->numLinks(); ++i) {
    const CnoidLink& link = *body_->link(i);
    if (output_on_[i]) {
      output_modes_[i] = link.actuationMode();
      for (std::string& finding : useless_outputs(io_body_->description(), i, output_modes_[i]))
        findings.push_back(std::move(finding));
    }
    for (const FlagQuantity& known : flag_quantities) {
      const bool of_joint = known.quantity <= Quantity::u;
      const int joint = io_body_->model().links[i].joint.id;
      if (input_flags_[i] & known.input_flag) {
        if (of_joint && joint < 0)
          findings.push_back(fmt::format("link '{}' has no joint to read", link.name()));
        else
          inputs_.add(i, joint, known.quantity);
      }
      if ((output_modes_[i] & known.output_flags) && !(of_joint && joint < 0)) outputs_.add(i, joint, known.quantity);
    }
    if (input_flags_[i] & CnoidLink::LinkContactState) {
      contact_links_.push_back(i);
      if (io_body_->model().links[i].collisions.empty())
        findings.push_back(
            fmt::format("link '{}' has no collision shapes: its contact points stay empty", link.name()));
    }
  }
  input_contacts_.resize(contact_links_.size());
  input_values_.assign(inputs_.size, 0.0);
  output_values_.assign(outputs_.size, 0.0);
  find_joint_numbers();
  return findings;
}

bool ControllerIo::commands_joint(int joint) const {
  return std::ranges::any_of(
      outputs_.fields, [joint](const IoField& field) { return field.quantity <= Quantity::u && field.joint == joint; });
}

/// Most inputs and outputs are single numbers of joints: their places are found once.
void ControllerIo::find_joint_numbers() {
  for (const IoField& field : inputs_.fields) {
    if (field.quantity > Quantity::u) continue;
    const JointQuantity& quantity = joint_quantity_of(field.quantity);
    CnoidLink& link = *body_->link(field.link);
    joint_inputs_.push_back({field.joint, quantity.observed, &input_values_[field.offset], &(link.*quantity.input)()});
  }
  for (const IoField& field : outputs_.fields) {
    if (field.quantity > Quantity::u) continue;
    CnoidLink& link = *body_->link(field.link);
    joint_outputs_.emplace_back(&(link.*joint_quantity_of(field.quantity).command)(), &output_values_[field.offset]);
  }
  const auto is_of_joint = [](const IoField& field) { return field.quantity <= Quantity::u; };
  std::ranges::remove_copy_if(inputs_.fields, std::back_inserter(link_inputs_), is_of_joint);
  std::ranges::remove_copy_if(outputs_.fields, std::back_inserter(link_outputs_), is_of_joint);
}

void ControllerIo::input(const BodyObservation& seen) {
  for (const JointInput& input : joint_inputs_)
    *input.value = *input.of_link = seen.joints[input.joint].*input.observed;
  for (const IoField& field : link_inputs_) {
    double* values = input_values_.data() + field.offset;
    gather(field.quantity, seen, static_cast<std::size_t>(field.link), values);
    scatter(field.quantity, values, *body_->link(field.link));
  }
  for (std::size_t i = 0; i < contact_links_.size(); ++i) {
    const int link = contact_links_[i];
    if (seen.contacts.empty())
      input_contacts_[i].clear();
    else
      input_contacts_[i] = seen.contacts[link];
    std::vector<CnoidLink::ContactPoint>& points = body_->link(link)->contactPoints();
    points.clear();
    for (const ContactReading& contact : input_contacts_[i])
      points.emplace_back(contact.position, contact.normal, contact.force, contact.velocity, contact.depth);
  }
}

void ControllerIo::replace_input(const IoField& field, std::span<const double> numbers) {
  double* values = input_values_.data() + field.offset;
  std::copy_n(numbers.begin(), width_of(field.quantity), values);
  CnoidLink& link = *body_->link(field.link);
  if (field.quantity <= Quantity::u)
    (link.*joint_quantity_of(field.quantity).input)() = *values;
  else
    scatter(field.quantity, values, link);
}

void ControllerIo::output() {
  for (const auto& [of_link, value] : joint_outputs_) *value = *of_link;
  for (const IoField& field : link_outputs_)
    gather_command(field.quantity, *body_->link(field.link), output_values_.data() + field.offset);
}

std::vector<std::string> ControllerIo::take_messages() {
  std::vector<std::string> lines;
  if (messages_.tellp() <= 0) return lines;
  std::istringstream text(message_buffer_.str());
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  message_buffer_.str({});
  return lines;
}

}  // namespace rehearse
