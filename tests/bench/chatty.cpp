// Writes ten lines a tick, for the curves of tools/bench --growth.
#include <cnoid/SimpleController>

class Chatty : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    return true;
  }
  bool control() override {
    for (int i = 0; i < 10; ++i) io_->os() << "line " << line_++ << " of many\n";
    io_->os().flush();
    return true;
  }

 private:
  cnoid::SimpleControllerIO* io_ = nullptr;
  long line_ = 0;
};

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Chatty)
