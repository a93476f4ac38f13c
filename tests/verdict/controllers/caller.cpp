// A controller that holds its joints, and calls members of the API at chosen ticks. Its options are a list of calls,
// each MEMBER@TICK. A gain comes from the file gain.txt below shareDirPath(), a second one from CALLER_GAIN. Built
// again with another GAIN.
#include <rehearse_variable.h>
#include <cnoid/Camera>
#include <cnoid/ExecutablePath>
#include <cnoid/Light>
#include <cnoid/RateGyroSensor>
#include <cnoid/SimpleController>
#include <cnoid/ValueTree>

#include <unistd.h>
#include <cfenv>
#include <clocale>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

extern "C" double strength();  // of a library that one build links, and uses as GAIN

inline int runs = 0;  // of the process

namespace {

class Caller : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    ++runs;
    io_ = io;
    shoulder_ = io->body()->joint("SHOULDER");
    rail_ = io->body()->joint("RAIL");
    shoulder_->setActuationMode(cnoid::Link::JointEffort);
    io->enableIO(shoulder_);
    io->enableInput(shoulder_, cnoid::Link::JointVelocity);
    io->enableOutput(rail_, cnoid::Link::JointVelocity | cnoid::Link::LinkExtWrench);
    gyro_ = io->body()->findDevice<cnoid::RateGyroSensor>();
    camera_ = io->body()->findDevice<cnoid::Camera>();
    lamp_ = io->body()->findDevice<cnoid::Light>();
    io->enableInput(gyro_);
    std::ifstream(cnoid::shareDirPath() / "gain.txt") >> gain_of_file_;
    if (const char* gain = std::getenv("CALLER_GAIN")) gain_of_variable_ = std::atof(gain);
    std::istringstream words(io->optionString());
    for (std::string word; words >> word;) {
      const std::size_t at = word.find('@');
      calls_.emplace(std::stoi(word.substr(at + 1)), word.substr(0, at));
    }
    return true;
  }

  bool control() override {
    const double gain = GAIN * gain_of_file_ * gain_of_variable_;
    shoulder_->u() = -gain * shoulder_->q() - 0.5 * shoulder_->dq() - 0.1 * gyro_->w().y();
    rail_->dq_target() = 0.1;
    rail_->F_ext().setZero();
    result_ = true;
    const auto [begin, end] = calls_.equal_range(tick_++);
    for (auto call = begin; call != end; ++call) members().at(call->second)(*this);
    return result_;
  }

 private:
  using Member = std::function<void(Caller&)>;
  static const std::map<std::string, Member>& members() {
    using cnoid::Link;
    static const std::map<std::string, Member> all{
        // how commands act
        {"no_delay", [](Caller& c) { c.io_->setNoDelayMode(true); }},
        {"delay", [](Caller& c) { c.io_->setNoDelayMode(false); }},
        // requests after initialize(), which have no effect
        {"enable_input", [](Caller& c) { c.io_->enableInput(c.rail_); }},
        {"enable_device", [](Caller& c) { c.io_->enableInput(c.camera_); }},
        {"enable_output", [](Caller& c) { c.io_->enableOutput(c.rail_, Link::JointEffort); }},
        {"mode", [](Caller& c) { c.rail_->setActuationMode(Link::JointDisplacement); }},
        {"no_mode", [](Caller& c) { c.shoulder_->setActuationMode(Link::StateNone); }},
        // numbers of links: commanded ones, ones that nobody reads
        {"u", [](Caller& c) { c.shoulder_->u() += 0.01; }},
        {"same_u", [](Caller& c) { c.shoulder_->u() += 0.0; }},
        {"negative_zero", [](Caller& c) { c.shoulder_->u() *= -1.0; }},
        {"dq_target", [](Caller& c) { c.rail_->dq_target() = 0.2; }},
        {"nan", [](Caller& c) { c.rail_->dq_target() = std::numeric_limits<double>::quiet_NaN(); }},
        {"q_target", [](Caller& c) { c.shoulder_->q_target() = 0.3; }},
        {"own_q", [](Caller& c) { c.rail_->q() = 0.3; }},
        {"own_q_of_input", [](Caller& c) { c.shoulder_->q() = 0.3; }},
        {"root", [](Caller& c) { c.io_->body()->rootLink()->p().x() += 1.0; }},
        {"force", [](Caller& c) { c.rail_->F_ext()[0] = 5.0; }},
        {"kinematics", [](Caller& c) { c.io_->body()->calcForwardKinematics(true, true); }},
        // devices
        {"lamp_off", [](Caller& c) { c.lamp_->on(false), c.lamp_->notifyStateChange(); }},
        {"lamp_off_unsaid", [](Caller& c) { c.lamp_->on(false); }},
        {"lamp_dimmed", [](Caller& c) { c.lamp_->setIntensity(0.25f), c.lamp_->notifyStateChange(); }},
        {"lamp_said", [](Caller& c) { c.lamp_->notifyStateChange(); }},
        {"camera_off", [](Caller& c) { c.camera_->on(false), c.camera_->notifyStateChange(); }},
        {"camera_off_unsaid", [](Caller& c) { c.camera_->on(false); }},
        {"camera_rate", [](Caller& c) { c.camera_->setFrameRate(50), c.camera_->notifyStateChange(); }},
        {"gyro_said", [](Caller& c) { c.gyro_->notifyStateChange(); }},
        {"info", [](Caller& c) { c.lamp_->resetInfo(new cnoid::Mapping), c.lamp_->notifyInfoChange(); }},
        // words, the end, failures
        {"line", [](Caller& c) { c.io_->os() << "a line" << std::endl; }},
        {"half_line", [](Caller& c) { c.io_->os() << "half"; }},
        {"variable", [](Caller&) { rehearse_variable("phase", 0.5); }},
        {"done", [](Caller& c) { c.result_ = false; }},
        {"throw", [](Caller&) { throw std::runtime_error("thrown on purpose"); }},
        // the process
        {"folder",
         [](Caller&) {
           if (chdir("/") != 0) throw std::runtime_error("chdir");
         }},
        {"environment", [](Caller&) { setenv("CALLER_NOTE", "1", 1), unsetenv("CALLER_NOTE"); }},
        {"locale", [](Caller&) { std::setlocale(LC_ALL, "C"); }},
        {"rounding", [](Caller&) { std::fesetround(FE_DOWNWARD); }},
        {"random", [](Caller& c) { std::srand(1), c.unused_ = std::rand(); }},
        // state that outlives a run in its process
        {"unseeded", [](Caller& c) { c.shoulder_->u() += 1e-3 * std::rand() / RAND_MAX; }},
        {"runs", [](Caller& c) { c.shoulder_->u() += 1e-3 * runs; }},
    };
    return all;
  }

  cnoid::SimpleControllerIO* io_ = nullptr;
  cnoid::Link* shoulder_ = nullptr;
  cnoid::Link* rail_ = nullptr;
  cnoid::RateGyroSensor* gyro_ = nullptr;
  cnoid::Camera* camera_ = nullptr;
  cnoid::Light* lamp_ = nullptr;
  std::multimap<int, std::string> calls_;  // by tick
  double gain_of_file_ = 1.0, gain_of_variable_ = 1.0;
  bool result_ = true;
  int tick_ = 0;
  int unused_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Caller)
