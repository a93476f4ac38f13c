// Entities: what an executor can call. All queues of the process are guarded by one lock, and a change wakes everybody
// who waits, so the order in which threads go on is that of their waiting.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

#include "rclcpp/context.hpp"
#include "rclcpp/macros.hpp"

namespace rehearse_ros2 {

inline constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

/// The steady time at the end of a timeout that begins now [ns]; negative: never.
std::int64_t deadline_after(std::chrono::nanoseconds timeout);

/// The lock of the bus, and the way to wait for a change.
class Bus {
 public:
  static Bus& instance();
  std::recursive_mutex mutex;
  /// Something may be ready now.
  void notify();
  /// Waits for a change after `seen`, or until this steady time [ns]. False: the time came first.
  bool wait(std::uint64_t seen, std::int64_t deadline);
  /// Waits until it is true; negative: without limit. False: the time or the default context ended first.
  bool wait_for(std::chrono::nanoseconds timeout, const std::function<bool()>& is_true);
  /// The number of changes so far.
  std::uint64_t changes() const { return changes_; }
  /// Numbers of requests, goals and publications: 1, 2, ...
  std::int64_t next_number() { return ++numbers_; }
  /// A run begins: they are the same in each.
  void begin_numbers() { numbers_ = 0; }

 private:
  std::mutex waiting_;
  std::condition_variable changed_;
  std::atomic<std::uint64_t> changes_{0};
  std::atomic<std::int64_t> numbers_{0};
};

using BusLock = std::lock_guard<std::recursive_mutex>;

/// In the order in which an executor calls what is ready.
enum class EntityKind { timer, subscription, service, client, waitable };
inline constexpr int kinds_of_entities = 5;

class Entity {
 public:
  virtual ~Entity() = default;
  /// At this steady time [ns].
  virtual bool rehearse_ready(std::int64_t now) = 0;
  /// The steady time at which it gets ready by itself [ns].
  virtual std::int64_t rehearse_due(std::int64_t) { return never; }
  /// Takes one piece of work, and does it. Called without the lock.
  virtual void rehearse_execute() = 0;
  /// True: it was so before. For wait sets, which own their members.
  bool exchange_in_use_by_wait_set_state(const void*, bool in_use) { return in_use_.exchange(in_use); }

 private:
  std::atomic<bool> in_use_{false};
};

}  // namespace rehearse_ros2

namespace rclcpp {

enum class CallbackGroupType { MutuallyExclusive, Reentrant };

class CallbackGroup {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(CallbackGroup)
  explicit CallbackGroup(CallbackGroupType type, bool with_node = true) : type_(type), with_node_(with_node) {}
  CallbackGroup(CallbackGroupType type, Context::WeakPtr, bool with_node = true) : CallbackGroup(type, with_node) {}
  const CallbackGroupType& type() const { return type_; }
  std::atomic_bool& can_be_taken_from() { return can_be_taken_from_; }
  std::atomic_bool& get_associated_with_executor_atomic() { return has_executor_; }
  bool automatically_add_to_executor_with_node() const { return with_node_; }
  std::size_t size() const;

  using Entities = std::vector<std::weak_ptr<rehearse_ros2::Entity>>;
  /// Under the lock of the bus: those that are there, in the order of their creation.
  std::vector<std::shared_ptr<rehearse_ros2::Entity>> rehearse_entities(rehearse_ros2::EntityKind kind);
  void rehearse_add(rehearse_ros2::EntityKind kind, const std::shared_ptr<rehearse_ros2::Entity>& entity);
  void rehearse_remove(rehearse_ros2::EntityKind kind, const std::shared_ptr<rehearse_ros2::Entity>& entity);

 private:
  CallbackGroupType type_;
  bool with_node_;
  std::atomic_bool can_be_taken_from_{true};
  std::atomic_bool has_executor_{false};
  Entities entities_[rehearse_ros2::kinds_of_entities];
};

/// Base of what isn't one of the other kinds, such as actions.
class Waitable : public rehearse_ros2::Entity {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Waitable)
};

class GuardCondition {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(GuardCondition)
  explicit GuardCondition(Context::SharedPtr context = get_global_default_context()) : context_(std::move(context)) {}
  Context::SharedPtr get_context() const { return context_; }
  void trigger();
  /// True if it was triggered since the last call.
  bool rehearse_take() { return triggered_.exchange(false); }

 private:
  Context::SharedPtr context_;
  std::atomic<bool> triggered_{false};
};

}  // namespace rclcpp
