// A controller whose progress is visible to other processes, however its process ends: it writes the number of its
// calls into the file that its options name, through shared memory. Its second option is its computing time in each
// call [microseconds], so that runs last long enough to be killed.
#include <cnoid/SimpleController>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <sstream>
#include <string>

namespace {

class Ticking : public cnoid::SimpleController {
 public:
  ~Ticking() override {
    if (calls_ != nullptr) munmap(calls_, sizeof *calls_);
  }

  bool initialize(cnoid::SimpleControllerIO* io) override {
    std::istringstream words(io->optionString());
    std::string file;
    int microseconds = 0;
    words >> file >> microseconds;
    busy_ = std::chrono::microseconds(microseconds);
    joint_ = io->body()->joint(0);
    joint_->setActuationMode(cnoid::Link::JointTorque);
    io->enableIO(joint_);
    const int opened = open(file.c_str(), O_RDWR | O_CLOEXEC);
    if (opened < 0) return false;
    void* place = mmap(nullptr, sizeof *calls_, PROT_READ | PROT_WRITE, MAP_SHARED, opened, 0);
    close(opened);
    if (place == MAP_FAILED) return false;
    calls_ = static_cast<std::atomic<std::uint64_t>*>(place);
    return true;
  }

  bool control() override {
    joint_->u() = -1.0 * joint_->q() - 0.1 * joint_->dq();
    const auto end = std::chrono::steady_clock::now() + busy_;
    while (std::chrono::steady_clock::now() < end) {
    }
    calls_->fetch_add(1);
    return true;
  }

 private:
  cnoid::Link* joint_ = nullptr;
  std::atomic<std::uint64_t>* calls_ = nullptr;
  std::chrono::microseconds busy_{0};
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Ticking)
