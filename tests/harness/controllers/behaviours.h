// Small controllers for the tests of the host, all in one library, Behaviours.so. The first word of a controller's own
// options chooses one of them, the words after it are its arguments.
#pragma once

#include <cnoid/SimpleController>

#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace behaviours {

using Words = std::vector<std::string>;
using Make = std::function<cnoid::SimpleController*(const Words&)>;

std::map<std::string, Make>& registry();

/// A namespace-scope object of this type adds a controller class, made from its arguments, under a name.
template <class Controller>
struct Add {
  explicit Add(const char* name) {
    const Make make = [](const Words& words) { return new Controller(words); };
    if (!registry().emplace(name, make).second) std::abort();  // two controllers of one name
  }
};

/// Commands a constant effort [N·m] to joint SHOULDER and counts its ticks. Base class of most other controllers.
class Pusher : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    shoulder_ = io->body()->joint("SHOULDER");
    shoulder_->setActuationMode(cnoid::Link::JointEffort);
    io->enableOutput(shoulder_);
    return true;
  }
  bool control() override {
    shoulder_->u() = effort_;
    ++tick_;
    return true;
  }

 protected:
  explicit Pusher(double effort) : effort_(effort) {}

  cnoid::SimpleControllerIO* io_ = nullptr;
  cnoid::Link* shoulder_ = nullptr;
  double effort_;
  int tick_ = 0;
};

}  // namespace behaviours
