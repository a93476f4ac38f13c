// The lock of the bus, callback groups, topics, services.
#include <rcutils/logging_macros.h>

#include <algorithm>
#include <chrono>

#include "rclcpp/detail/topic.hpp"
#include "rclcpp/exceptions.hpp"
#include "rclcpp/service.hpp"
#include "rclcpp/subscription.hpp"
#include "rclcpp/time.hpp"
#include "rclcpp/timer.hpp"

namespace rehearse_ros2 {
namespace {

/// Those that are there; the others are forgotten.
template <class Object>
std::vector<std::shared_ptr<Object>> present(std::vector<std::weak_ptr<Object>>& all) {
  std::vector<std::shared_ptr<Object>> found;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    auto object = all[i].lock();
    if (!object) continue;
    found.push_back(std::move(object));
    if (kept != i) all[kept] = all[i];
    ++kept;
  }
  all.resize(kept);
  return found;
}

}  // namespace

std::int64_t deadline_after(std::chrono::nanoseconds timeout) {
  const std::int64_t now = read_clock(RCL_STEADY_TIME);
  return timeout.count() < 0 || timeout.count() > never - now ? never : now + timeout.count();
}

Bus& Bus::instance() {
  static Bus bus;
  return bus;
}

void Bus::notify() {
  {
    const std::lock_guard lock(waiting_);
    ++changes_;
  }
  changed_.notify_all();
}

bool Bus::wait(std::uint64_t seen, std::int64_t deadline) {
  std::unique_lock lock(waiting_);
  const auto is_new = [&] { return changes_ != seen; };
  if (deadline == never) {
    changed_.wait(lock, is_new);
    return true;
  }
  const std::chrono::steady_clock::time_point until{std::chrono::nanoseconds(deadline)};
  return changed_.wait_until(lock, until, is_new);
}

bool Bus::wait_for(std::chrono::nanoseconds timeout, const std::function<bool()>& is_true) {
  const std::int64_t deadline = deadline_after(timeout);
  for (;;) {
    const std::uint64_t seen = changes();
    if (is_true()) return true;
    if (timeout.count() == 0 || !rclcpp::ok() || !wait(seen, deadline)) return is_true();
  }
}

void Endpoint::put(const Delivery& delivery) {
  while (queue.size() >= qos.rehearse_limit()) queue.pop_front();
  queue.push_back(delivery);
}

bool Endpoint::take(Delivery& delivery) {
  if (queue.empty()) return false;
  delivery = std::move(queue.front());
  queue.pop_front();
  return true;
}

Topics& Topics::instance() {
  static Topics topics;
  return topics;
}

Topic& Topics::of(const Endpoint& endpoint) {
  Topic& topic = topics_[endpoint.topic];
  if (present(topic.publishers).empty() && present(topic.subscriptions).empty()) topic.type = &endpoint.type;
  if (type_name_of(*topic.type) != type_name_of(endpoint.type))
    throw rclcpp::exceptions::InvalidTopicNameError("topic '" + endpoint.topic + "' has the type " +
                                                    type_name_of(*topic.type) + ", not " + type_name_of(endpoint.type));
  return topic;
}

void Topics::add_publisher(const std::shared_ptr<Endpoint>& publisher) {
  {
    const BusLock lock(Bus::instance().mutex);
    of(*publisher).publishers.push_back(publisher);
  }
  Bus::instance().notify();
}

void Topics::add_subscription(const std::shared_ptr<Endpoint>& subscription) {
  {
    const BusLock lock(Bus::instance().mutex);
    Topic& topic = of(*subscription);
    topic.subscriptions.push_back(subscription);
    if (subscription->qos.durability() == rclcpp::DurabilityPolicy::TransientLocal)
      for (const auto& publisher : present(topic.publishers))
        if (qos_check_compatible(publisher->qos, subscription->qos).compatibility == rclcpp::QoSCompatibility::Ok)
          for (const Delivery& kept : publisher->queue) subscription->put(kept);
  }
  Bus::instance().notify();
}

void Topics::publish(Endpoint& publisher, std::shared_ptr<const void> message) {
  {
    const BusLock lock(Bus::instance().mutex);
    if (tap_) tap_(publisher, message.get());
    Delivery delivery{std::move(message), {}};
    rmw_message_info_t& info = delivery.info.get_rmw_message_info();
    info.source_timestamp = info.received_timestamp = read_clock(RCL_ROS_TIME);
    info.publication_sequence_number = static_cast<std::uint64_t>(Bus::instance().next_number());
    info.publisher_gid.implementation_identifier = "rehearse";
    if (publisher.qos.durability() == rclcpp::DurabilityPolicy::TransientLocal) publisher.put(delivery);
    const auto topic = topics_.find(publisher.topic);
    if (topic == topics_.end()) return;
    for (const auto& subscription : present(topic->second.subscriptions))
      if (qos_check_compatible(publisher.qos, subscription->qos).compatibility == rclcpp::QoSCompatibility::Ok)
        subscription->put(delivery);
  }
  Bus::instance().notify();
}

std::vector<std::shared_ptr<Endpoint>> Topics::publishers_of(const std::string& topic) {
  const BusLock lock(Bus::instance().mutex);
  const auto found = topics_.find(topic);
  return found == topics_.end() ? std::vector<std::shared_ptr<Endpoint>>() : present(found->second.publishers);
}
std::vector<std::shared_ptr<Endpoint>> Topics::subscriptions_of(const std::string& topic) {
  const BusLock lock(Bus::instance().mutex);
  const auto found = topics_.find(topic);
  return found == topics_.end() ? std::vector<std::shared_ptr<Endpoint>>() : present(found->second.subscriptions);
}
std::size_t Topics::count_publishers(const std::string& topic) { return publishers_of(topic).size(); }
std::size_t Topics::count_subscriptions(const std::string& topic) { return subscriptions_of(topic).size(); }

const MessageMembers* Topics::type_of(const std::string& topic) {
  const BusLock lock(Bus::instance().mutex);
  if (count_publishers(topic) + count_subscriptions(topic) == 0) return nullptr;
  return topics_.at(topic).type;
}

std::map<std::string, std::string> Topics::names_and_types() {
  const BusLock lock(Bus::instance().mutex);
  std::map<std::string, std::string> names;
  for (const auto& [name, topic] : topics_)
    if (const MessageMembers* type = type_of(name)) names[name] = type_name_of(*type);
  return names;
}

}  // namespace rehearse_ros2

namespace rclcpp {

using rehearse_ros2::Bus;
using rehearse_ros2::BusLock;
using rehearse_ros2::Entity;
using rehearse_ros2::EntityKind;

std::size_t CallbackGroup::size() const {
  const BusLock lock(Bus::instance().mutex);
  std::size_t count = 0;
  for (const Entities& of_kind : entities_)
    count += static_cast<std::size_t>(
        std::count_if(of_kind.begin(), of_kind.end(), [](const auto& entity) { return !entity.expired(); }));
  return count;
}

std::vector<std::shared_ptr<Entity>> CallbackGroup::rehearse_entities(EntityKind kind) {
  return rehearse_ros2::present(entities_[static_cast<int>(kind)]);
}

void CallbackGroup::rehearse_add(EntityKind kind, const std::shared_ptr<Entity>& entity) {
  {
    const BusLock lock(Bus::instance().mutex);
    entities_[static_cast<int>(kind)].push_back(entity);
  }
  Bus::instance().notify();
}

void CallbackGroup::rehearse_remove(EntityKind kind, const std::shared_ptr<Entity>& entity) {
  const BusLock lock(Bus::instance().mutex);
  Entities& of_kind = entities_[static_cast<int>(kind)];
  of_kind.erase(
      std::remove_if(of_kind.begin(), of_kind.end(), [&](const auto& known) { return known.lock() == entity; }),
      of_kind.end());
}

void GuardCondition::trigger() {
  triggered_ = true;
  Bus::instance().notify();
}

std::size_t PublisherBase::get_subscription_count() const {
  return rehearse_ros2::Topics::instance().count_subscriptions(endpoint_->topic);
}
void PublisherBase::rehearse_publish(std::shared_ptr<const void> message) {
  rehearse_ros2::Topics::instance().publish(*endpoint_, std::move(message));
}

std::size_t SubscriptionBase::get_publisher_count() const {
  return rehearse_ros2::Topics::instance().count_publishers(endpoint_->topic);
}
bool SubscriptionBase::take_delivery(rehearse_ros2::Delivery& delivery) {
  const BusLock lock(Bus::instance().mutex);
  return endpoint_->take(delivery);
}

TimerBase::TimerBase(Clock::SharedPtr clock, std::chrono::nanoseconds period, Context::SharedPtr, bool starts)
    : clock_(std::move(clock)), period_(period.count()), next_(clock_now() + period_), is_canceled_(!starts) {
  if (period.count() < 0) throw std::invalid_argument("timer period cannot be negative");
}
void TimerBase::cancel() {
  const BusLock lock(Bus::instance().mutex);
  is_canceled_ = true;
}
bool TimerBase::is_canceled() {
  const BusLock lock(Bus::instance().mutex);
  return is_canceled_;
}
void TimerBase::reset() {
  {
    const BusLock lock(Bus::instance().mutex);
    is_canceled_ = false;
    next_ = clock_now() + period_;
  }
  Bus::instance().notify();
}
bool TimerBase::is_ready() {
  const BusLock lock(Bus::instance().mutex);
  return !is_canceled_ && clock_now() >= next_;
}
std::chrono::nanoseconds TimerBase::time_until_trigger() {
  const BusLock lock(Bus::instance().mutex);
  return is_canceled_ ? std::chrono::nanoseconds::max() : std::chrono::nanoseconds(next_ - clock_now());
}
std::int64_t TimerBase::rehearse_due(std::int64_t now) {
  if (is_canceled_) return rehearse_ros2::never;
  if (clock_->get_clock_type() == RCL_STEADY_TIME) return next_;
  return now + (next_ - clock_now());
}
std::optional<TimerInfo> TimerBase::rehearse_call() {
  const BusLock lock(Bus::instance().mutex);
  if (is_canceled_) return std::nullopt;
  const std::int64_t now = clock_now();
  const rcl_clock_type_t kind = clock_->get_clock_type();
  const TimerInfo info{Time(next_, kind), Time(now, kind)};
  // A timer that is late by whole periods leaves these calls out.
  next_ += period_;
  if (period_ == 0)
    next_ = now;
  else if (next_ < now)
    next_ += ((now - next_) / period_ + 1) * period_;
  return info;
}
void TimerBase::rehearse_execute() {
  if (const auto info = rehearse_call()) execute_callback(*info);
}

std::map<std::string, std::weak_ptr<ServiceBase>>& rehearse_services() {
  static std::map<std::string, std::weak_ptr<ServiceBase>> services;
  return services;
}

void ServiceBase::rehearse_ask(Request request) {
  {
    const BusLock lock(Bus::instance().mutex);
    requests_.push_back(std::move(request));
  }
  Bus::instance().notify();
}
bool ServiceBase::take_request(Request& request) {
  const BusLock lock(Bus::instance().mutex);
  if (requests_.empty()) return false;
  request = std::move(requests_.front());
  requests_.pop_front();
  open_[request.number] = request.answer;
  return true;
}
void ServiceBase::answer(std::int64_t number, std::shared_ptr<void> response) {
  Answer answer;
  {
    const BusLock lock(Bus::instance().mutex);
    const auto found = open_.find(number);
    if (found == open_.end()) return;
    answer = std::move(found->second);
    open_.erase(found);
  }
  answer(std::move(response));
}

std::shared_ptr<ServiceBase> ClientBase::find() const {
  const BusLock lock(Bus::instance().mutex);
  const auto found = rehearse_services().find(name_);
  return found == rehearse_services().end() ? nullptr : found->second.lock();
}
std::int64_t ClientBase::send(std::shared_ptr<void> request, std::weak_ptr<ClientBase> self,
                              std::function<void(std::shared_ptr<void>)> done) {
  const std::int64_t number = Bus::instance().next_number();
  {
    const BusLock lock(Bus::instance().mutex);
    pending_[number] = std::move(done);
  }
  const auto service = find();
  if (!service) return number;  // nobody answers, as in life
  service->rehearse_ask({number, std::move(request), [self, number](std::shared_ptr<void> response) {
                           const auto client = self.lock();
                           if (!client) return;
                           {
                             const BusLock lock(Bus::instance().mutex);
                             client->answers_.emplace_back(number, std::move(response));
                           }
                           Bus::instance().notify();
                         }});
  return number;
}
void ClientBase::rehearse_execute() {
  std::function<void(std::shared_ptr<void>)> done;
  std::shared_ptr<void> response;
  {
    const BusLock lock(Bus::instance().mutex);
    if (answers_.empty()) return;
    const auto found = pending_.find(answers_.front().first);
    response = std::move(answers_.front().second);
    answers_.pop_front();
    if (found == pending_.end()) return;
    done = std::move(found->second);
    pending_.erase(found);
  }
  done(std::move(response));
}
std::size_t ClientBase::forget(std::int64_t number) {
  const BusLock lock(Bus::instance().mutex);
  return pending_.erase(number);
}
std::size_t ClientBase::forget_all() {
  const BusLock lock(Bus::instance().mutex);
  const std::size_t count = pending_.size();
  pending_.clear();
  return count;
}

}  // namespace rclcpp
