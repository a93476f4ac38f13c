#include "rclcpp/executor.hpp"

#include <algorithm>
#include <stdexcept>

#include "rclcpp/wait_set.hpp"

namespace rclcpp {
namespace {

using rehearse_ros2::Bus;
using rehearse_ros2::BusLock;
using rehearse_ros2::deadline_after;
using rehearse_ros2::EntityKind;

std::int64_t steady_now() { return rehearse_ros2::read_clock(RCL_STEADY_TIME); }

}  // namespace

std::string to_string(const FutureReturnCode& code) {
  switch (code) {
    case FutureReturnCode::SUCCESS: return "SUCCESS (0)";
    case FutureReturnCode::INTERRUPTED: return "INTERRUPTED (1)";
    default: return "TIMEOUT (2)";
  }
}
std::ostream& operator<<(std::ostream& out, const FutureReturnCode& code) { return out << to_string(code); }

class Executor::Spinning {
 public:
  Spinning(Executor& executor, const char* function) : executor_(executor) {
    if (executor_.spinning_.exchange(true))
      throw std::runtime_error(std::string(function) + "() called while already spinning");
  }
  ~Spinning() { executor_.spinning_ = false; }
  Spinning(const Spinning&) = delete;
  Spinning& operator=(const Spinning&) = delete;

 private:
  Executor& executor_;
};

Executor::~Executor() {
  for (const auto& known : nodes_)
    if (const auto node = known.lock()) node->get_associated_with_executor_atomic() = false;
  for (const auto& known : groups_)
    if (const auto group = known.lock()) group->get_associated_with_executor_atomic() = false;
}

void Executor::add_node(Base::SharedPtr node, bool) {
  if (node->get_associated_with_executor_atomic().exchange(true))
    throw std::runtime_error("Node '" + std::string(node->get_fully_qualified_name()) +
                             "' has already been added to an executor.");
  {
    const BusLock lock(Bus::instance().mutex);
    nodes_.push_back(node);
  }
  Bus::instance().notify();
}

void Executor::remove_node(Base::SharedPtr node, bool) {
  {
    const BusLock lock(Bus::instance().mutex);
    const auto place =
        std::find_if(nodes_.begin(), nodes_.end(), [&](const auto& known) { return known.lock() == node; });
    if (place == nodes_.end())
      throw std::runtime_error("Node '" + std::string(node->get_fully_qualified_name()) +
                               "' needs to be associated with this executor.");
    nodes_.erase(place);
  }
  node->get_associated_with_executor_atomic() = false;
  Bus::instance().notify();
}

void Executor::add_callback_group(CallbackGroup::SharedPtr group, Base::SharedPtr, bool) {
  if (group->get_associated_with_executor_atomic().exchange(true))
    throw std::runtime_error("Callback group has already been added to an executor.");
  {
    const BusLock lock(Bus::instance().mutex);
    groups_.push_back(group);
  }
  Bus::instance().notify();
}

void Executor::remove_callback_group(CallbackGroup::SharedPtr group, bool) {
  {
    const BusLock lock(Bus::instance().mutex);
    const auto place =
        std::find_if(groups_.begin(), groups_.end(), [&](const auto& known) { return known.lock() == group; });
    if (place == groups_.end()) throw std::runtime_error("Callback group needs to be associated with this executor.");
    groups_.erase(place);
  }
  group->get_associated_with_executor_atomic() = false;
  Bus::instance().notify();
}

std::vector<CallbackGroup::SharedPtr> Executor::groups() {
  std::vector<CallbackGroup::SharedPtr> all;
  for (const auto& known : groups_)
    if (auto group = known.lock()) all.push_back(std::move(group));
  for (const auto& known : nodes_) {
    const auto node = known.lock();
    if (!node) continue;
    node->for_each_callback_group([&](const CallbackGroup::SharedPtr& group) {
      if (group->automatically_add_to_executor_with_node() && !group->get_associated_with_executor_atomic())
        all.push_back(group);
    });
  }
  return all;
}

std::vector<CallbackGroup::WeakPtr> Executor::get_all_callback_groups() {
  const BusLock lock(Bus::instance().mutex);
  const auto all = groups();
  return {all.begin(), all.end()};
}

std::vector<Executor::Work> Executor::ready_work(std::int64_t now, std::int64_t* due, bool only_first) {
  const BusLock lock(Bus::instance().mutex);
  std::vector<Work> work;
  const auto all = groups();
  for (int kind = 0; kind < rehearse_ros2::kinds_of_entities; ++kind)
    for (const auto& group : all) {
      if (!group->can_be_taken_from()) continue;
      for (auto& entity : group->rehearse_entities(static_cast<EntityKind>(kind))) {
        if (entity->rehearse_ready(now)) {
          work.push_back({std::move(entity), group});
          if (only_first) return work;
        } else if (due != nullptr) {
          *due = std::min(*due, entity->rehearse_due(now));
        }
      }
    }
  return work;
}

bool Executor::execute(const Work& work) {
  std::atomic_bool& can_be_taken_from = work.group->can_be_taken_from();
  const bool is_exclusive = work.group->type() == CallbackGroupType::MutuallyExclusive;
  if (is_exclusive && !can_be_taken_from.exchange(false)) return false;
  struct Return {
    std::atomic_bool* place;
    ~Return() {
      if (place == nullptr) return;
      *place = true;
      Bus::instance().notify();
    }
  } const give_back{is_exclusive ? &can_be_taken_from : nullptr};
  work.entity->rehearse_execute();
  return true;
}

void Executor::spin_ready(std::chrono::nanoseconds most, bool again) {
  const Spinning spinning(*this, again ? "spin_all" : "spin_some");
  const std::int64_t end = most.count() == 0 ? rehearse_ros2::never : deadline_after(most);
  bool is_over = false;
  do {
    const auto work = ready_work(steady_now(), nullptr, false);
    if (work.empty()) return;
    for (const Work& one : work) {
      if (!ok(context_) || !spinning_) return;
      execute(one);
      is_over = end != rehearse_ros2::never && steady_now() >= end;
      if (is_over) break;
    }
  } while (again && !is_over);
}

void Executor::spin_all(std::chrono::nanoseconds most) {
  if (most.count() < 0) throw std::invalid_argument("max_duration must be greater than or equal to 0");
  spin_ready(most, true);
}

bool Executor::execute_one(std::int64_t deadline) {
  Bus& bus = Bus::instance();
  while (ok(context_) && spinning_) {
    const std::uint64_t seen = bus.changes();
    const std::int64_t now = steady_now();
    std::int64_t due = deadline;
    const auto work = ready_work(now, &due, true);
    if (!work.empty()) {
      if (execute(work[0])) return true;
      continue;
    }
    if (now >= deadline) return false;
    bus.wait(seen, due);
  }
  return false;
}

bool Executor::spin_one(std::chrono::nanoseconds timeout) {
  const Spinning spinning(*this, "spin_once");
  return execute_one(deadline_after(timeout));
}

void Executor::spin() {
  const Spinning spinning(*this, "spin");
  while (execute_one(rehearse_ros2::never)) {
  }
}

FutureReturnCode Executor::spin_until(const std::function<bool()>& is_done, std::chrono::nanoseconds timeout) {
  if (is_done()) return FutureReturnCode::SUCCESS;
  const Spinning spinning(*this, "spin_until_future_complete");
  const std::int64_t deadline = deadline_after(timeout);
  while (ok(context_) && spinning_) {
    const bool is_executed = execute_one(deadline);
    if (is_done()) return FutureReturnCode::SUCCESS;
    if (!is_executed && ok(context_) && spinning_) return FutureReturnCode::TIMEOUT;
  }
  return FutureReturnCode::INTERRUPTED;
}

void Executor::cancel() {
  spinning_ = false;
  Bus::instance().notify();
}

WaitSet::~WaitSet() {
  for (const auto& entity : entities_) entity->exchange_in_use_by_wait_set_state(this, false);
}

void WaitSet::add(std::shared_ptr<rehearse_ros2::Entity> entity) {
  if (entity->exchange_in_use_by_wait_set_state(this, true))
    throw std::runtime_error("it is already in use by another wait set");
  entities_.push_back(std::move(entity));
}

void WaitSet::remove(const std::shared_ptr<rehearse_ros2::Entity>& entity) {
  const auto place = std::find(entities_.begin(), entities_.end(), entity);
  if (place == entities_.end()) throw std::runtime_error("it isn't in this wait set");
  entity->exchange_in_use_by_wait_set_state(this, false);
  entities_.erase(place);
}

void WaitSet::remove_guard_condition(GuardCondition::SharedPtr condition) {
  conditions_.erase(std::remove(conditions_.begin(), conditions_.end(), condition), conditions_.end());
}

WaitResultKind WaitSet::wait_nanoseconds(std::chrono::nanoseconds timeout) {
  if (entities_.empty() && conditions_.empty()) return Empty;
  Bus& bus = Bus::instance();
  const std::int64_t deadline = deadline_after(timeout);
  for (;;) {
    const std::uint64_t seen = bus.changes();
    const std::int64_t now = steady_now();
    std::int64_t due = deadline;
    bool is_ready = false;
    {
      const BusLock lock(bus.mutex);
      for (const auto& entity : entities_) {
        is_ready |= entity->rehearse_ready(now);
        due = std::min(due, entity->rehearse_due(now));
      }
    }
    for (const auto& condition : conditions_) is_ready |= condition->rehearse_take();
    if (is_ready) return Ready;
    if (now >= deadline || !ok()) return Timeout;
    bus.wait(seen, due);
  }
}

}  // namespace rclcpp
