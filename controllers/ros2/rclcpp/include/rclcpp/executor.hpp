// Executors: they call what is ready, in the order of rclcpp's single-threaded executor, and of one kind in the order
// of creation.
#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <ostream>
#include <utility>
#include <vector>

#include "rclcpp/node.hpp"

namespace rclcpp {

enum class FutureReturnCode { SUCCESS, INTERRUPTED, TIMEOUT };
std::string to_string(const FutureReturnCode& code);
std::ostream& operator<<(std::ostream& out, const FutureReturnCode& code);

struct ExecutorOptions {
  Context::SharedPtr context = get_global_default_context();
  std::size_t max_conditions = 0;
};

class Executor {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Executor)
  using Base = node_interfaces::NodeBaseInterface;
  explicit Executor(const ExecutorOptions& options = ExecutorOptions()) : context_(options.context) {}
  virtual ~Executor();
  RCLCPP_DISABLE_COPY(Executor)

  /// Until the context is shut down, or cancel() is called. Throws std::runtime_error if it spins already.
  virtual void spin();
  virtual void add_callback_group(CallbackGroup::SharedPtr group, Base::SharedPtr node, bool notify = true);
  virtual void remove_callback_group(CallbackGroup::SharedPtr group, bool notify = true);
  virtual std::vector<CallbackGroup::WeakPtr> get_all_callback_groups();
  virtual void add_node(Base::SharedPtr node, bool notify = true);
  template <class NodeType>
  auto add_node(std::shared_ptr<NodeType> node, bool notify = true)
      -> decltype(node->get_node_base_interface(), void()) {
    add_node(Base::SharedPtr(node->get_node_base_interface()), notify);
  }
  virtual void remove_node(Base::SharedPtr node, bool notify = true);
  template <class NodeType>
  auto remove_node(std::shared_ptr<NodeType> node, bool notify = true)
      -> decltype(node->get_node_base_interface(), void()) {
    remove_node(Base::SharedPtr(node->get_node_base_interface()), notify);
  }
  /// What is ready now, one message a subscription; `most`: it begins nothing after this time, 0: without limit.
  virtual void spin_some(std::chrono::nanoseconds most = std::chrono::nanoseconds(0)) { spin_ready(most, false); }
  /// Until nothing is ready.
  virtual void spin_all(std::chrono::nanoseconds most);
  /// One thing, for which it waits; negative: without limit.
  virtual void spin_once(std::chrono::nanoseconds timeout = std::chrono::nanoseconds(-1)) { spin_one(timeout); }
  template <class NodeType, class Count = std::int64_t, class Period = std::milli>
  void spin_node_once(std::shared_ptr<NodeType> node,
                      std::chrono::duration<Count, Period> timeout = std::chrono::duration<Count, Period>(-1)) {
    const Membership member(*this, node->get_node_base_interface());
    spin_once(std::chrono::duration_cast<std::chrono::nanoseconds>(timeout));
  }
  template <class NodeType>
  void spin_node_some(std::shared_ptr<NodeType> node) {
    const Membership member(*this, base_of(node));
    spin_some();
  }
  template <class NodeType>
  void spin_node_all(std::shared_ptr<NodeType> node, std::chrono::nanoseconds most) {
    const Membership member(*this, base_of(node));
    spin_all(most);
  }
  template <class FutureType, class Count = std::int64_t, class Period = std::milli>
  FutureReturnCode spin_until_future_complete(const FutureType& future, std::chrono::duration<Count, Period> timeout =
                                                                            std::chrono::duration<Count, Period>(-1)) {
    const auto nanoseconds = std::chrono::duration_cast<std::chrono::nanoseconds>(timeout);
    return spin_until([&] { return future.wait_for(std::chrono::seconds(0)) == std::future_status::ready; },
                      nanoseconds);
  }
  template <class NodeType, class FutureType, class Count = std::int64_t, class Period = std::milli>
  FutureReturnCode spin_node_until_future_complete(
      std::shared_ptr<NodeType> node, const FutureType& future,
      std::chrono::duration<Count, Period> timeout = std::chrono::duration<Count, Period>(-1)) {
    const Membership member(*this, base_of(node));
    return spin_until_future_complete(future, timeout);
  }
  void cancel();
  bool is_spinning() { return spinning_; }

  /// True: it called something. Never waits.
  bool rehearse_spin_one() { return spin_one(std::chrono::nanoseconds(0)); }

 protected:
  struct Work {
    std::shared_ptr<rehearse_ros2::Entity> entity;
    CallbackGroup::SharedPtr group;
  };
  template <class NodeType>
  static Base::SharedPtr base_of(const std::shared_ptr<NodeType>& node) {
    return node_interfaces::get_node_base_interface(node);
  }
  /// A node belongs to the executor during its lifetime.
  class Membership {
   public:
    Membership(Executor& executor, Base::SharedPtr node) : executor_(executor), node_(std::move(node)) {
      executor_.add_node(node_, false);
    }
    ~Membership() { executor_.remove_node(node_, false); }
    Membership(const Membership&) = delete;
    Membership& operator=(const Membership&) = delete;

   private:
    Executor& executor_;
    Base::SharedPtr node_;
  };
  /// Sets spinning_ during its lifetime; throws std::runtime_error if it is set.
  class Spinning;
  std::vector<CallbackGroup::SharedPtr> groups();
  /// What is ready at a steady time [ns]; `due` is set to the next time at which something gets ready by itself.
  std::vector<Work> ready_work(std::int64_t now, std::int64_t* due, bool only_first);
  bool execute(const Work& work);
  void spin_ready(std::chrono::nanoseconds most, bool again);
  bool spin_one(std::chrono::nanoseconds timeout);
  bool execute_one(std::int64_t deadline);
  FutureReturnCode spin_until(const std::function<bool()>& is_done, std::chrono::nanoseconds timeout);

  Context::SharedPtr context_;
  std::vector<Base::WeakPtr> nodes_;
  std::vector<CallbackGroup::WeakPtr> groups_;
  std::atomic<bool> spinning_{false};
};

namespace executors {

class SingleThreadedExecutor : public Executor {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(SingleThreadedExecutor)
  using Executor::Executor;
};
class StaticSingleThreadedExecutor : public Executor {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(StaticSingleThreadedExecutor)
  using Executor::Executor;
};
/// It spins in one thread: the one that calls spin().
class MultiThreadedExecutor : public Executor {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(MultiThreadedExecutor)
  explicit MultiThreadedExecutor(const ExecutorOptions& options = ExecutorOptions(), std::size_t threads = 0,
                                 bool yield_before_execute = false,
                                 std::chrono::nanoseconds timeout = std::chrono::nanoseconds(-1))
      : Executor(options), threads_(threads == 0 ? 2 : threads) {
    (void)yield_before_execute;
    (void)timeout;
  }
  std::size_t get_number_of_threads() { return threads_; }

 private:
  std::size_t threads_;
};

template <class NodeType, class FutureType, class Count = std::int64_t, class Period = std::milli>
FutureReturnCode spin_node_until_future_complete(
    Executor& executor, std::shared_ptr<NodeType> node, const FutureType& future,
    std::chrono::duration<Count, Period> timeout = std::chrono::duration<Count, Period>(-1)) {
  return executor.spin_node_until_future_complete(node, future, timeout);
}

}  // namespace executors
using executors::SingleThreadedExecutor;

template <class NodeType>
void spin(std::shared_ptr<NodeType> node) {
  SingleThreadedExecutor executor;
  executor.add_node(node_interfaces::get_node_base_interface(node));
  executor.spin();
}
template <class NodeType>
void spin_some(std::shared_ptr<NodeType> node) {
  SingleThreadedExecutor().spin_node_some(node);
}
template <class NodeType>
void spin_all(std::shared_ptr<NodeType> node, std::chrono::nanoseconds most) {
  SingleThreadedExecutor().spin_node_all(node, most);
}
template <class NodeType, class FutureType, class Count = std::int64_t, class Period = std::milli>
FutureReturnCode spin_until_future_complete(
    std::shared_ptr<NodeType> node, const FutureType& future,
    std::chrono::duration<Count, Period> timeout = std::chrono::duration<Count, Period>(-1)) {
  return SingleThreadedExecutor().spin_node_until_future_complete(node, future, timeout);
}

}  // namespace rclcpp
