// Services and clients.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include <rosidl_typesupport_introspection_cpp/service_introspection.hpp>
#include <rosidl_typesupport_introspection_cpp/service_type_support_decl.hpp>

#include "rclcpp/detail/entity.hpp"
#include "rclcpp/detail/message_type.hpp"
#include "rclcpp/qos.hpp"

namespace rclcpp {

class ServiceBase : public rehearse_ros2::Entity {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(ServiceBase)
  ServiceBase(const std::string& name, const rehearse_ros2::MessageMembers& request,
              const rehearse_ros2::MessageMembers& response)
      : request_type(request), response_type(response), name_(name) {}
  const char* get_service_name() const { return name_.c_str(); }
  bool rehearse_ready(std::int64_t) override { return !requests_.empty(); }

  /// Called with the response.
  using Answer = std::function<void(std::shared_ptr<void>)>;
  struct Request {
    std::int64_t number = 0;
    std::shared_ptr<void> request;
    Answer answer;
  };
  /// It waits until an executor takes it.
  void rehearse_ask(Request request);
  const rehearse_ros2::MessageMembers& request_type;
  const rehearse_ros2::MessageMembers& response_type;

 protected:
  bool take_request(Request& request);
  void answer(std::int64_t number, std::shared_ptr<void> response);

 private:
  std::string name_;
  std::deque<Request> requests_;
  std::map<std::int64_t, Answer> open_;  // taken and not answered yet
};

template <class Type>
class Service : public ServiceBase, public std::enable_shared_from_this<Service<Type>> {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Service)
  using SharedRequest = std::shared_ptr<typename Type::Request>;
  using SharedResponse = std::shared_ptr<typename Type::Response>;
  using Header = std::shared_ptr<rmw_request_id_t>;

  template <class Callback>
  Service(const std::string& name, Callback callback)
      : ServiceBase(name, rehearse_ros2::members_of<typename Type::Request>(),
                    rehearse_ros2::members_of<typename Type::Response>()),
        call_([callback = std::move(callback)](Service& self, const Header& header,
                                               const SharedRequest& request) mutable {
          const auto response = std::make_shared<typename Type::Response>();
          if constexpr (std::is_invocable_v<Callback&, SharedRequest, SharedResponse>) {
            callback(request, response);
          } else if constexpr (std::is_invocable_v<Callback&, Header, SharedRequest, SharedResponse>) {
            callback(header, request, response);
          } else {
            // It answers later, by send_response().
            if constexpr (std::is_invocable_v<Callback&, Header, SharedRequest>)
              callback(header, request);
            else
              callback(self.shared_from_this(), header, request);
            return;
          }
          self.send_response(*header, *response);
        }) {}
  void send_response(rmw_request_id_t& header, typename Type::Response& response) {
    answer(header.sequence_number, std::make_shared<typename Type::Response>(response));
  }
  void rehearse_execute() override {
    Request request;
    if (!take_request(request)) return;
    const auto header = std::make_shared<rmw_request_id_t>();
    header->sequence_number = request.number;
    call_(*this, header, std::static_pointer_cast<typename Type::Request>(request.request));
  }

 private:
  std::function<void(Service&, const Header&, const SharedRequest&)> call_;
};

/// The services of the process by name, under the lock of the bus; the one that was made last answers.
std::map<std::string, std::weak_ptr<ServiceBase>>& rehearse_services();

class ClientBase : public rehearse_ros2::Entity {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(ClientBase)
  explicit ClientBase(const std::string& name) : name_(name) {}
  const char* get_service_name() const { return name_.c_str(); }
  bool service_is_ready() const { return find() != nullptr; }
  /// False: it isn't there in this time; negative: without limit.
  template <class Count = std::int64_t, class Period = std::milli>
  bool wait_for_service(std::chrono::duration<Count, Period> timeout = std::chrono::duration<Count, Period>(-1)) {
    return rehearse_ros2::Bus::instance().wait_for(std::chrono::duration_cast<std::chrono::nanoseconds>(timeout),
                                                   [this] { return service_is_ready(); });
  }
  bool rehearse_ready(std::int64_t) override { return !answers_.empty(); }
  void rehearse_execute() override;

 protected:
  std::shared_ptr<ServiceBase> find() const;
  /// Sends it; `done` is called with the response by the executor of this client. Returns its number.
  std::int64_t send(std::shared_ptr<void> request, std::weak_ptr<ClientBase> self,
                    std::function<void(std::shared_ptr<void>)> done);
  std::size_t forget(std::int64_t number);
  std::size_t forget_all();

 private:
  std::string name_;
  std::map<std::int64_t, std::function<void(std::shared_ptr<void>)>> pending_;
  std::deque<std::pair<std::int64_t, std::shared_ptr<void>>> answers_;
};

template <class Type>
class Client : public ClientBase, public std::enable_shared_from_this<Client<Type>> {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Client)
  using Request = typename Type::Request;
  using Response = typename Type::Response;
  using SharedRequest = std::shared_ptr<Request>;
  using SharedResponse = std::shared_ptr<Response>;
  using Promise = std::promise<SharedResponse>;
  using SharedPromise = std::shared_ptr<Promise>;
  using Future = std::future<SharedResponse>;
  using SharedFuture = std::shared_future<SharedResponse>;
  using SharedFutureWithRequest = std::shared_future<std::pair<SharedRequest, SharedResponse>>;
  using CallbackType = std::function<void(SharedFuture)>;
  using CallbackWithRequestType = std::function<void(SharedFutureWithRequest)>;

  /// A future, and the number of its request.
  template <class FutureOf>
  struct Numbered {
    FutureOf future;
    std::int64_t request_id = 0;
    operator FutureOf&() { return future; }
    auto get() { return future.get(); }
    bool valid() const noexcept { return future.valid(); }
    void wait() const { future.wait(); }
    template <class Count, class Period>
    std::future_status wait_for(const std::chrono::duration<Count, Period>& timeout) const {
      return future.wait_for(timeout);
    }
    template <class ClockOf, class DurationOf>
    std::future_status wait_until(const std::chrono::time_point<ClockOf, DurationOf>& until) const {
      return future.wait_until(until);
    }
    auto share() { return future.share(); }
  };
  using FutureAndRequestId = Numbered<Future>;
  using SharedFutureAndRequestId = Numbered<SharedFuture>;
  using SharedFutureWithRequestAndRequestId = Numbered<SharedFutureWithRequest>;

  explicit Client(const std::string& name) : ClientBase(name) {}
  FutureAndRequestId async_send_request(SharedRequest request) {
    const auto promise = std::make_shared<Promise>();
    Future future = promise->get_future();
    const std::int64_t number =
        send(copy_of(request), this->weak_from_this(), [promise](std::shared_ptr<void> response) {
          promise->set_value(std::static_pointer_cast<Response>(response));
        });
    return {std::move(future), number};
  }
  template <class Callback, std::enable_if_t<std::is_invocable_v<Callback, SharedFuture>, int> = 0>
  SharedFutureAndRequestId async_send_request(SharedRequest request, Callback&& callback) {
    const auto promise = std::make_shared<Promise>();
    const SharedFuture future = promise->get_future().share();
    const std::int64_t number =
        send(copy_of(request), this->weak_from_this(),
             [promise, future, callback = std::decay_t<Callback>(std::forward<Callback>(callback))](
                 std::shared_ptr<void> response) mutable {
               promise->set_value(std::static_pointer_cast<Response>(response));
               callback(future);
             });
    return {future, number};
  }
  template <class Callback, std::enable_if_t<!std::is_invocable_v<Callback, SharedFuture> &&
                                                 std::is_invocable_v<Callback, SharedFutureWithRequest>,
                                             int> = 0>
  SharedFutureWithRequestAndRequestId async_send_request(SharedRequest request, Callback&& callback) {
    const auto promise = std::make_shared<std::promise<std::pair<SharedRequest, SharedResponse>>>();
    const SharedFutureWithRequest future = promise->get_future().share();
    const std::int64_t number =
        send(copy_of(request), this->weak_from_this(),
             [promise, future, request, callback = std::decay_t<Callback>(std::forward<Callback>(callback))](
                 std::shared_ptr<void> response) mutable {
               promise->set_value({request, std::static_pointer_cast<Response>(response)});
               callback(future);
             });
    return {future, number};
  }
  bool remove_pending_request(std::int64_t number) { return forget(number) > 0; }
  template <class FutureOf>
  bool remove_pending_request(const Numbered<FutureOf>& future) {
    return forget(future.request_id) > 0;
  }
  std::size_t prune_pending_requests() { return forget_all(); }

 private:
  static std::shared_ptr<void> copy_of(const SharedRequest& request) { return std::make_shared<Request>(*request); }
};

}  // namespace rclcpp
