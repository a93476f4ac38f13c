// A controller that prints on stdout in all ways, whenever its code runs: while it is loaded, in its calls, in a
// thread, and when its static objects are destroyed.
#include <cnoid/SimpleController>

#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <string>
#include <thread>

namespace {

void print(const std::string& where) {
  std::cout << "cout " << where << std::endl;
  std::printf("printf %s\n", where.c_str());
  const std::string text = "write " + where + "\n";
  static_cast<void>(!write(STDOUT_FILENO, text.data(), text.size()));
}

struct Prints {
  Prints() { print("at load"); }
  ~Prints() { print("at unload"); }
} prints;

class Printer : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    print("in initialize");
    hinge_ = io->body()->joint(0);
    hinge_->setActuationMode(cnoid::Link::JointEffort);
    io->enableIO(hinge_);
    return true;
  }
  bool control() override {
    if (calls_++ % 10 == 0) print("in control");
    if (calls_ == 5) std::thread([] { print("in a thread"); }).join();
    hinge_->u() = -1.0 * hinge_->q();
    return true;
  }

 private:
  int calls_ = 0;
  cnoid::Link* hinge_ = nullptr;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Printer)
