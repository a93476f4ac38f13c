// ControllerIo: the IO object of one controller. It stores which quantities were enabled, and copies their values
// between the observation, the controller's body and the flat arrays of io_layout.h.
//
// Copying follows Choreonoid's SimpleControllerItem: only enabled quantities are copied. All other quantities in the
// controller's body keep the last value written to them, and no forward kinematics is computed.
#pragma once

#include <rehearse/io.h>
#include <cnoid/SimpleController>

#include <cstdint>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/guard/cost_counter.h"
#include "io_body.h"
#include "io_layout.h"

namespace rehearse {

/// The buffer behind os(): its own allocations are the host's.
class MessageBuffer final : public std::stringbuf {
 public:
  MessageBuffer() : std::stringbuf(std::ios_base::out) {}

 protected:
  int_type overflow(int_type letter) override {
    if (!traits_type::eq_int_type(letter, traits_type::eof())) count_message_bytes(1);
    const HostCode own;
    return std::stringbuf::overflow(letter);
  }
  std::streamsize xsputn(const char* text, std::streamsize size) override {
    count_message_bytes(static_cast<std::uint64_t>(size));
    const HostCode own;
    return std::stringbuf::xsputn(text, size);
  }
};

class ControllerIo final : public cnoid::SimulationSimpleControllerIO {
 public:
  ControllerIo(std::string name, std::string run_options, std::string own_options, double time_step);

  // The interface for the controller.
  std::string controllerName() const override { return name_; }
  cnoid::Body* body() override { return body_; }
  /// In configure() the controller's own options; from initialize() on the options of the run precede them.
  std::string optionString() const override {
    return configuring_ ? own_options_ : getIntegratedOptionString(run_options_, own_options_);
  }
  std::ostream& os() const override { return messages_; }
  double timeStep() const override { return configuring_ ? 0.0 : time_step_; }
  double currentTime() const override { return time_; }
  bool isNoDelayMode() const override { return no_delay_; }
  bool setNoDelayMode(bool on) override { return no_delay_ = on; }
  bool isImmediateMode() const override { return no_delay_; }
  void setImmediateMode(bool on) override { no_delay_ = on; }
  void enableIO(cnoid::Link* link) override;
  void enableInput(cnoid::Link* link) override;
  void enableInput(cnoid::Link* link, int flags) override;
  void enableInput(cnoid::Device* device) override;
  void enableOutput(cnoid::Link* link) override;
  void enableOutput(cnoid::Link* link, int flags) override;
  void setJointInput(int flags) override;
  void setJointOutput(int flags) override;
  void setLinkInput(cnoid::Link* link, int flags) override { enableInput(link, flags); }
  void setLinkOutput(cnoid::Link* link, int flags) override { enableOutput(link, flags); }

  // The interface for the host.
  /// Sets the body for configure(); ended by attach().
  void show_body(cnoid::Body& body) {
    body_ = &body;
    configuring_ = true;
  }
  /// Sets the body for the run; called before initialize().
  void attach(IoBody& body);
  /// Called after initialize(): the tables are fixed. Returns a sentence for each requested quantity that doesn't
  /// exist.
  std::vector<std::string> freeze();
  void set_time(double seconds) { time_ = seconds; }
  /// The lines written to os() since the last call.
  std::vector<std::string> take_messages();
  /// True if it requested an input or output after initialize() since the last call: such a request has no effect.
  bool take_enabled_too_late() { return std::exchange(enabled_too_late_, false); }

  const IoLayout& inputs() const { return inputs_; }
  const IoLayout& outputs() const { return outputs_; }
  /// The link's actuation mode at the end of initialize(), StateFlags, for a field of outputs().
  int mode_of(int link) const { return output_modes_[link]; }
  /// True if outputs() has a field of that joint.
  bool commands_joint(int joint) const;
  const std::vector<int>& input_devices() const { return input_devices_; }
  /// The links whose contact points are input, ascending.
  const std::vector<int>& contact_links() const { return contact_links_; }

  /// Observation -> input_values(), input_contacts() -> the controller's body.
  void input(const BodyObservation& seen);
  /// Other numbers for a field of inputs() -> input_values() -> the controller's body; after input().
  void replace_input(const IoField& field, std::span<const double> numbers);
  /// The controller's body -> output_values().
  void output();
  const std::vector<double>& input_values() const { return input_values_; }
  /// The contacts passed for the contact_links(), in their order.
  const std::vector<std::vector<ContactReading>>& input_contacts() const { return input_contacts_; }
  const std::vector<double>& output_values() const { return output_values_; }

 private:
  /// A number of a joint that the controller reads.
  struct JointInput {
    int joint;  // id
    double JointReading::*observed;
    double* value;    // in input_values()
    double* of_link;  // in the controller's body
  };
  const cnoid::Link& checked(const cnoid::Link* link, const char* function) const;
  /// True after initialize(): a request has no effect, and take_enabled_too_late() reports it.
  bool note_if_too_late() {
    enabled_too_late_ |= frozen_;
    return frozen_;
  }
  void find_joint_numbers();

  std::string name_;
  std::string run_options_;
  std::string own_options_;
  double time_step_;
  double time_ = 0.0;
  bool no_delay_ = false;
  bool configuring_ = false;
  bool frozen_ = false;
  bool enabled_too_late_ = false;
  cnoid::Body* body_ = nullptr;
  IoBody* io_body_ = nullptr;
  MessageBuffer message_buffer_;
  mutable std::ostream messages_{&message_buffer_};
  std::vector<int> input_flags_;    // by link index
  std::vector<bool> output_on_;     // by link index
  std::vector<int> output_modes_;   // by link index
  std::vector<int> input_devices_;  // device indices, in the order they were enabled
  std::vector<int> contact_links_;
  std::vector<std::vector<ContactReading>> input_contacts_;
  IoLayout inputs_;
  IoLayout outputs_;
  std::vector<double> input_values_;
  std::vector<double> output_values_;
  std::vector<JointInput> joint_inputs_;
  std::vector<std::pair<const double*, double*>> joint_outputs_;  // in the controller's body, in output_values()
  std::vector<IoField> link_inputs_, link_outputs_;               // the other fields
};

}  // namespace rehearse
