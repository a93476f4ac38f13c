// Hands a number to a thread and back 500 times a tick: a thousand hand-overs.
#include <cnoid/SimpleController>
#include <semaphore.h>

#include <thread>

class PingPong : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    hinge_ = io->body()->joint(0);
    hinge_->setActuationMode(cnoid::Link::JointEffort);
    io->enableOutput(hinge_);
    sem_init(&ping_, 0, 0);
    sem_init(&pong_, 0, 0);
    thread_ = std::thread([this] {
      for (;;) {
        sem_wait(&ping_);
        if (is_over_) return;
        number_ = 0.5 * number_ + 1.0;
        sem_post(&pong_);
      }
    });
    return true;
  }
  bool control() override {
    for (int i = 0; i < 500; ++i) {
      sem_post(&ping_);
      sem_wait(&pong_);
    }
    hinge_->u() = number_;
    return true;
  }
  void stop() override {
    is_over_ = true;
    sem_post(&ping_);
    thread_.join();
  }

 private:
  cnoid::Link* hinge_ = nullptr;
  sem_t ping_, pong_;
  bool is_over_ = false;
  double number_ = 0.0;
  std::thread thread_;
};

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(PingPong)
