// The parameters of a node.
#pragma once

#include <list>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "parameter_files.h"
#include "rclcpp/node.hpp"

namespace rehearse_ros2 {

class NodeParameters : public rclcpp::node_interfaces::NodeParametersInterface {
 public:
  /// `overrides`: of files and command lines; those of the options count more.
  NodeParameters(Overrides overrides, const rclcpp::NodeOptions& options);

  /// Called after changes, outside of callbacks: the new and the changed parameters.
  std::function<void(const std::vector<rclcpp::Parameter>& declared, const std::vector<rclcpp::Parameter>& changed)>
      on_change;

  const rclcpp::ParameterValue& declare_parameter(const std::string& name, const rclcpp::ParameterValue& value,
                                                  const Descriptor& descriptor, bool ignore_override) override;
  const rclcpp::ParameterValue& declare_parameter(const std::string& name, rclcpp::ParameterType type,
                                                  const Descriptor& descriptor, bool ignore_override) override;
  void undeclare_parameter(const std::string& name) override;
  bool has_parameter(const std::string& name) const override { return parameters_.count(name) > 0; }
  std::vector<Result> set_parameters(const std::vector<rclcpp::Parameter>& parameters) override;
  Result set_parameters_atomically(const std::vector<rclcpp::Parameter>& parameters) override;
  std::vector<rclcpp::Parameter> get_parameters(const std::vector<std::string>& names) const override;
  rclcpp::Parameter get_parameter(const std::string& name) const override;
  bool get_parameter(const std::string& name, rclcpp::Parameter& parameter) const override;
  bool get_parameters_by_prefix(const std::string& prefix,
                                std::map<std::string, rclcpp::Parameter>& parameters) const override;
  std::vector<Descriptor> describe_parameters(const std::vector<std::string>& names) const override;
  std::vector<std::uint8_t> get_parameter_types(const std::vector<std::string>& names) const override;
  rcl_interfaces::msg::ListParametersResult list_parameters(const std::vector<std::string>& prefixes,
                                                            std::uint64_t depth) const override;
  rclcpp::node_interfaces::PreSetParametersCallbackHandle::SharedPtr add_pre_set_parameters_callback(
      PreSetParametersCallbackType callback) override;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr add_on_set_parameters_callback(
      OnSetParametersCallbackType callback) override;
  rclcpp::node_interfaces::PostSetParametersCallbackHandle::SharedPtr add_post_set_parameters_callback(
      PostSetParametersCallbackType callback) override;
  void remove_pre_set_parameters_callback(
      const rclcpp::node_interfaces::PreSetParametersCallbackHandle* handle) override;
  void remove_on_set_parameters_callback(const rclcpp::node_interfaces::OnSetParametersCallbackHandle* handle) override;
  void remove_post_set_parameters_callback(
      const rclcpp::node_interfaces::PostSetParametersCallbackHandle* handle) override;
  const Overrides& get_parameter_overrides() const override { return overrides_; }

 private:
  struct Declared {
    rclcpp::ParameterValue value;
    Descriptor descriptor;
  };
  class Changing;
  template <class Handle>
  using Handles = std::list<std::weak_ptr<Handle>>;

  const rclcpp::ParameterValue& declare(const std::string& name, rclcpp::ParameterType type,
                                        const rclcpp::ParameterValue& value, const Descriptor& descriptor,
                                        bool ignore_override);
  /// Whether these values may be set, by the descriptors and then by the callbacks.
  Result judge(const std::vector<rclcpp::Parameter>& parameters, bool is_declaration) const;
  void tell_post(const std::vector<rclcpp::Parameter>& parameters) const;
  const Declared* find(const std::string& name) const;

  mutable std::recursive_mutex mutex_;
  Overrides overrides_;
  bool allow_undeclared_;
  bool is_changing_ = false;
  std::map<std::string, Declared> parameters_;
  Handles<rclcpp::node_interfaces::PreSetParametersCallbackHandle> pre_;
  Handles<rclcpp::node_interfaces::OnSetParametersCallbackHandle> on_;
  Handles<rclcpp::node_interfaces::PostSetParametersCallbackHandle> post_;
};

}  // namespace rehearse_ros2
