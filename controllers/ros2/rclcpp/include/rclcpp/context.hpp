// Contexts: what init() begins and shutdown() ends.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "rclcpp/exceptions.hpp"
#include "rclcpp/macros.hpp"

namespace rclcpp {

enum class SignalHandlerOptions { All, SigInt, SigTerm, None };

class InitOptions {
 public:
  bool shutdown_on_signal = true;
  InitOptions& auto_initialize_logging(bool) { return *this; }
  bool auto_initialize_logging() const { return true; }
  void set_domain_id(std::size_t id) { domain_id_ = id; }
  std::size_t get_domain_id() const { return domain_id_; }

 private:
  std::size_t domain_id_ = 0;
};

/// Of a callback that a context calls; it can be removed by it.
struct ShutdownCallbackHandle {
  std::weak_ptr<std::function<void()>> callback;
};
using OnShutdownCallbackHandle = ShutdownCallbackHandle;
using PreShutdownCallbackHandle = ShutdownCallbackHandle;

class Context : public std::enable_shared_from_this<Context> {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Context)
  using OnShutdownCallback = std::function<void()>;
  using PreShutdownCallback = std::function<void()>;
  Context() = default;
  virtual ~Context() = default;
  RCLCPP_DISABLE_COPY(Context)

  /// Throws std::runtime_error if it is valid already.
  virtual void init(int argc, char const* const* argv, const InitOptions& options = InitOptions());
  bool is_valid() const { return valid_; }
  const InitOptions& get_init_options() const { return options_; }
  std::size_t get_domain_id() const { return options_.get_domain_id(); }
  /// False if it isn't valid.
  virtual bool shutdown(const std::string& reason);
  std::string shutdown_reason() const { return reason_; }
  OnShutdownCallback on_shutdown(OnShutdownCallback callback);
  OnShutdownCallbackHandle add_on_shutdown_callback(OnShutdownCallback callback) { return add(on_, callback); }
  PreShutdownCallbackHandle add_pre_shutdown_callback(PreShutdownCallback callback) { return add(pre_, callback); }
  bool remove_on_shutdown_callback(const OnShutdownCallbackHandle& handle) { return remove(on_, handle); }
  bool remove_pre_shutdown_callback(const PreShutdownCallbackHandle& handle) { return remove(pre_, handle); }
  /// False: it was shut down before the time was over.
  bool sleep_for(const std::chrono::nanoseconds& duration);

  /// What init() was given.
  const std::vector<std::string>& rehearse_arguments() const { return arguments_; }

 private:
  using Callbacks = std::vector<std::shared_ptr<std::function<void()>>>;
  ShutdownCallbackHandle add(Callbacks& callbacks, std::function<void()> callback);
  bool remove(Callbacks& callbacks, const ShutdownCallbackHandle& handle);
  mutable std::mutex mutex_;
  Callbacks pre_, on_;
  std::atomic<bool> valid_{false};
  std::string reason_;
  InitOptions options_;
  std::vector<std::string> arguments_;
};

namespace contexts {
using DefaultContext = Context;
Context::SharedPtr get_global_default_context();
}  // namespace contexts
using contexts::get_global_default_context;

void init(int argc, char const* const* argv, const InitOptions& options = InitOptions(),
          SignalHandlerOptions signals = SignalHandlerOptions::All);
std::vector<std::string> init_and_remove_ros_arguments(int argc, char const* const* argv,
                                                       const InitOptions& options = InitOptions());
std::vector<std::string> remove_ros_arguments(int argc, char const* const* argv);
bool ok(Context::SharedPtr context = nullptr);
bool shutdown(Context::SharedPtr context = nullptr, const std::string& reason = "user called rclcpp::shutdown()");
void on_shutdown(std::function<void()> callback, Context::SharedPtr context = nullptr);
bool sleep_for(const std::chrono::nanoseconds& duration, Context::SharedPtr context = nullptr);
inline bool install_signal_handlers(SignalHandlerOptions = SignalHandlerOptions::All) { return false; }
inline bool signal_handlers_installed() { return false; }
inline bool uninstall_signal_handlers() { return false; }

}  // namespace rclcpp
