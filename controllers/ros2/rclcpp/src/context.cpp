#include "rclcpp/context.hpp"

#include <rcutils/logging.h>

#include <algorithm>
#include <string_view>

#include "rclcpp/detail/entity.hpp"
#include "rclcpp/time.hpp"

namespace rclcpp {

void Context::init(int argc, char const* const* argv, const InitOptions& options) {
  if (valid_) throw std::runtime_error("context is already initialized");
  if (rcutils_logging_initialize() != RCUTILS_RET_OK) throw exceptions::RCLError("logging can't be initialised");
  arguments_.assign(argv, argv + argc);
  options_ = options;
  reason_.clear();
  for (std::size_t i = 0; i + 1 < arguments_.size(); ++i) {
    if (arguments_[i] != RCL_LOG_LEVEL_FLAG) continue;
    std::string level = arguments_[i + 1];
    std::string logger;
    if (const std::size_t equals = level.find(":="); equals != std::string::npos) {
      logger = level.substr(0, equals);
      level = level.substr(equals + 2);
    }
    int severity = 0;
    if (rcutils_logging_severity_level_from_string(level.c_str(), rcutils_get_default_allocator(), &severity) !=
        RCUTILS_RET_OK)
      throw exceptions::RCLInvalidROSArgsError("'" + level + "' is no level of a log");
    if (logger.empty())
      rcutils_logging_set_default_logger_level(severity);
    else
      (void)rcutils_logging_set_logger_level(logger.c_str(), severity);
  }
  valid_ = true;
}

bool Context::shutdown(const std::string& reason) {
  if (!valid_) return false;
  Callbacks before, after;
  {
    const std::lock_guard lock(mutex_);
    before = pre_;
    after = on_;
  }
  for (const auto& callback : before) (*callback)();
  valid_ = false;
  reason_ = reason;
  for (const auto& callback : after) (*callback)();
  rehearse_ros2::Bus::instance().notify();
  return true;
}

Context::OnShutdownCallback Context::on_shutdown(OnShutdownCallback callback) {
  add(on_, callback);
  return callback;
}

ShutdownCallbackHandle Context::add(Callbacks& callbacks, std::function<void()> callback) {
  const std::lock_guard lock(mutex_);
  callbacks.push_back(std::make_shared<std::function<void()>>(std::move(callback)));
  return {callbacks.back()};
}

bool Context::remove(Callbacks& callbacks, const ShutdownCallbackHandle& handle) {
  const std::lock_guard lock(mutex_);
  const auto place = std::find(callbacks.begin(), callbacks.end(), handle.callback.lock());
  if (place == callbacks.end()) return false;
  callbacks.erase(place);
  return true;
}

bool Context::sleep_for(const std::chrono::nanoseconds& duration) {
  rehearse_ros2::Bus& bus = rehearse_ros2::Bus::instance();
  const std::int64_t until = rehearse_ros2::deadline_after(std::max(duration, std::chrono::nanoseconds(0)));
  while (valid_) {
    const std::uint64_t seen = bus.changes();
    if (rehearse_ros2::read_clock(RCL_STEADY_TIME) >= until || !bus.wait(seen, until)) break;
  }
  return valid_;
}

namespace contexts {

Context::SharedPtr get_global_default_context() {
  static const auto context = std::make_shared<Context>();
  return context;
}

}  // namespace contexts

namespace {

Context& given_or_global(const Context::SharedPtr& context) {
  return context ? *context : *get_global_default_context();
}

}  // namespace

void init(int argc, char const* const* argv, const InitOptions& options, SignalHandlerOptions) {
  get_global_default_context()->init(argc, argv, options);
}

std::vector<std::string> remove_ros_arguments(int argc, char const* const* argv) {
  std::vector<std::string> others;
  bool is_ros = false;
  for (int i = 0; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (!is_ros && argument == RCL_ROS_ARGS_FLAG)
      is_ros = true;
    else if (is_ros && argument == "--")
      is_ros = false;
    else if (!is_ros)
      others.emplace_back(argument);
  }
  return others;
}

std::vector<std::string> init_and_remove_ros_arguments(int argc, char const* const* argv, const InitOptions& options) {
  init(argc, argv, options);
  return remove_ros_arguments(argc, argv);
}

bool ok(Context::SharedPtr context) { return given_or_global(context).is_valid(); }
bool shutdown(Context::SharedPtr context, const std::string& reason) {
  return given_or_global(context).shutdown(reason);
}
void on_shutdown(std::function<void()> callback, Context::SharedPtr context) {
  given_or_global(context).on_shutdown(std::move(callback));
}
bool sleep_for(const std::chrono::nanoseconds& duration, Context::SharedPtr context) {
  return given_or_global(context).sleep_for(duration);
}

}  // namespace rclcpp
