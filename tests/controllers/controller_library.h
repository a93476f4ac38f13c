// A controller's shared library, opened in the same way as in the harness.
#pragma once

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <cnoid/SimpleController>

#include <memory>
#include <string>

namespace rehearse::test {

class ControllerLibrary {
 public:
  explicit ControllerLibrary(const std::string& path) : handle_(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) {
    if (!handle_) {
      ADD_FAILURE() << dlerror();
      return;
    }
    const auto create = reinterpret_cast<cnoid::SimpleController::Factory>(dlsym(handle_, "createSimpleController"));
    EXPECT_NE(create, nullptr) << "no factory in " << path;
    if (create) controller_.reset(create());
  }
  ~ControllerLibrary() {
    controller_.reset();  // its code is in the library
    if (handle_) dlclose(handle_);
  }
  ControllerLibrary(const ControllerLibrary&) = delete;
  ControllerLibrary& operator=(const ControllerLibrary&) = delete;

  cnoid::SimpleController* controller() { return controller_.get(); }

 private:
  void* handle_;
  std::unique_ptr<cnoid::SimpleController> controller_;
};

}  // namespace rehearse::test
