// ControllerWatch: is notified when code of a controller begins to run, and when it has ended.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace rehearse {

/// One call into a controller, or the loading of its library.
struct ControllerCall {
  const std::string& controller;         // "SR1/SR1Minimum"
  const std::filesystem::path& library;  // its file, absolute
  const char* function;                  // "load", "createSimpleController", "configure", "control", ...
  std::int64_t tick = -1;                // -1: while it is loaded; 0 until the first control()
  double time = 0.0;                     // [s] of simulation
};

/// Called on the thread that makes the calls. Calls don't nest, and each enter() is followed by a leave(), independent
/// of the result of the call.
class ControllerWatch {
 public:
  virtual ~ControllerWatch() = default;
  virtual void enter(const ControllerCall& call) = 0;
  virtual void leave() = 0;
  /// Directly before and after control(), within enter() and leave(). end_control() is not called if the controller
  /// crashes or hangs.
  virtual void begin_control() {}
  virtual void end_control() {}
};

/// Notifies the watch of one call during its lifetime. Without a watch it has no effect.
class Watched {
 public:
  Watched(ControllerWatch* watch, const ControllerCall& call) : watch_(watch) {
    if (watch_) watch_->enter(call);
  }
  ~Watched() {
    if (watch_) watch_->leave();
  }
  Watched(const Watched&) = delete;
  Watched& operator=(const Watched&) = delete;

 private:
  ControllerWatch* watch_;
};

/// Notifies the watch of control() during its lifetime. Without a watch it has no effect.
class WatchedControl {
 public:
  explicit WatchedControl(ControllerWatch* watch) : watch_(watch) {
    if (watch_) watch_->begin_control();
  }
  ~WatchedControl() {
    if (watch_) watch_->end_control();
  }
  WatchedControl(const WatchedControl&) = delete;
  WatchedControl& operator=(const WatchedControl&) = delete;

 private:
  ControllerWatch* watch_;
};

}  // namespace rehearse
