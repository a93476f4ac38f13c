// Tasks that state how a node is; the updater publishes what they say on /diagnostics, once a period.
#pragma once

#include <functional>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <utility>
#include <vector>

#include "diagnostic_updater/diagnostic_status_wrapper.hpp"

namespace diagnostic_updater {

using TaskFunction = std::function<void(DiagnosticStatusWrapper&)>;

class DiagnosticTask {
 public:
  explicit DiagnosticTask(const std::string& name) : name_(name) {}
  virtual ~DiagnosticTask() = default;
  const std::string& getName() { return name_; }
  virtual void run(DiagnosticStatusWrapper& status) = 0;

 private:
  std::string name_;
};

class FunctionDiagnosticTask : public DiagnosticTask {
 public:
  FunctionDiagnosticTask(const std::string& name, TaskFunction function)
      : DiagnosticTask(name), function_(std::move(function)) {}
  void run(DiagnosticStatusWrapper& status) override { function_(status); }

 private:
  TaskFunction function_;
};

class CompositeDiagnosticTask : public DiagnosticTask {
 public:
  using DiagnosticTask::DiagnosticTask;
  void addTask(DiagnosticTask* task) { tasks_.push_back(task); }
  void run(DiagnosticStatusWrapper& status) override {
    DiagnosticStatusWrapper all;
    all.summary(status);
    for (DiagnosticTask* task : tasks_) {
      status.summary(all);
      task->run(status);
      all.mergeSummary(status);
    }
    status.summary(all);
  }

 private:
  std::vector<DiagnosticTask*> tasks_;
};

class Updater {
 public:
  /// `period` [s]
  template <class NodeType>
  explicit Updater(NodeType node, double period = 1.0)
      : clock_(node->get_node_clock_interface()->get_clock()),
        timers_(node->get_node_timers_interface()),
        name_(node->get_node_base_interface()->get_name()),
        publisher_(rclcpp::create_publisher<diagnostic_msgs::msg::DiagnosticArray>(node->get_node_topics_interface(),
                                                                                   "/diagnostics", rclcpp::QoS(1))) {
    setPeriod(period);
  }
  void setHardwareID(const std::string& id) { hardware_ = id; }
  void add(const std::string& name, TaskFunction function) { tasks_.push_back({name, std::move(function)}); }
  void add(DiagnosticTask& task) {
    add(task.getName(), [&task](DiagnosticStatusWrapper& status) { task.run(status); });
  }
  template <class Object>
  void add(const std::string& name, Object* object, void (Object::*function)(DiagnosticStatusWrapper&)) {
    add(name, [object, function](DiagnosticStatusWrapper& status) { (object->*function)(status); });
  }
  /// False: there is none of that name.
  bool removeByName(const std::string& name) {
    for (auto task = tasks_.begin(); task != tasks_.end(); ++task) {
      if (task->first != name) continue;
      tasks_.erase(task);
      return true;
    }
    return false;
  }
  void setPeriod(double period) { setPeriod(rclcpp::Duration::from_seconds(period)); }
  void setPeriod(rclcpp::Duration period) {
    period_ = period;
    timer_ = rclcpp::create_timer(
        clock_, period.to_chrono<std::chrono::nanoseconds>(), [this] { force_update(); }, nullptr, nullptr,
        timers_.get());
  }
  rclcpp::Duration getPeriod() const { return period_; }
  void force_update() {
    std::vector<DiagnosticStatusWrapper> all;
    for (const auto& [name, function] : tasks_) {
      DiagnosticStatusWrapper status;
      status.summary(DiagnosticStatusWrapper::ERROR, "No message was set");
      status.hardware_id = hardware_;
      function(status);
      status.name = name_ + ": " + name;
      all.push_back(status);
    }
    publish(all);
  }
  void broadcast(unsigned char level, const std::string& text) {
    std::vector<DiagnosticStatusWrapper> all;
    for (const auto& task : tasks_) {
      DiagnosticStatusWrapper status;
      status.summary(level, text);
      status.name = name_ + ": " + task.first;
      all.push_back(status);
    }
    publish(all);
  }

 private:
  void publish(const std::vector<DiagnosticStatusWrapper>& all) {
    diagnostic_msgs::msg::DiagnosticArray message;
    message.header.stamp = clock_->now();
    message.status.assign(all.begin(), all.end());
    publisher_->publish(message);
  }

  rclcpp::Clock::SharedPtr clock_;
  rclcpp::node_interfaces::NodeTimersInterface::SharedPtr timers_;
  std::string name_, hardware_;
  std::vector<std::pair<std::string, TaskFunction>> tasks_;
  rclcpp::Publisher<diagnostic_msgs::msg::DiagnosticArray>::SharedPtr publisher_;
  rclcpp::Duration period_{1, 0};
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace diagnostic_updater
