// A planner in a thread, and two workers a tick, of which each takes a lock.
#include <pthread.h>
#include <cnoid/SimpleController>

#include <cmath>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace {

class Planner : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    hinge_ = io->body()->joint("hinge");
    hinge_->setActuationMode(cnoid::Link::JointEffort);
    io->enableIO(hinge_);
    thread_ = std::thread([this] { make_plans(); });
    return true;
  }
  bool control() override {
    std::vector<std::thread> workers;
    for (int share = 0; share < 2; ++share)
      workers.emplace_back([this, share] {
        const std::scoped_lock lock(mutex_);
        count_ = std::fmod(2.0 * count_, 1000.0) + share;
      });
    for (std::thread& worker : workers) worker.join();
    const std::scoped_lock lock(mutex_);
    for (; !plans_.empty(); plans_.pop_front()) plan_ = plans_.front();
    angles_.push_back(hinge_->q());
    woken_.notify_one();
    hinge_->u() = plan_ + 1e-6 * count_;
    return true;
  }
  void stop() override {
    {
      const std::scoped_lock lock(mutex_);
      angles_.push_back(std::nullopt);
    }
    woken_.notify_one();
    thread_.join();
  }

 private:
  void make_plans() {
    pthread_setname_np(pthread_self(), "planner");
    std::unique_lock lock(mutex_);
    for (;;) {
      woken_.wait(lock, [this] { return !angles_.empty(); });
      const std::optional<double> angle = angles_.front();
      angles_.pop_front();
      if (!angle) return;
      count_ += 1.0;
      plans_.push_back(-4.0 * *angle);
    }
  }

  cnoid::Link* hinge_ = nullptr;
  std::mutex mutex_;
  std::condition_variable woken_;
  std::deque<std::optional<double>> angles_;
  std::deque<double> plans_;
  double plan_ = 0.0, count_ = 0.0;
  std::thread thread_;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Planner)
