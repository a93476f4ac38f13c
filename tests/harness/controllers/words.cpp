// Controllers that write lines to their stream, and variables.
#include <rehearse_variable.h>

#include <cmath>
#include <stdexcept>
#include <thread>

#include "behaviours.h"

namespace behaviours {
namespace {

/// variables STEP: sets "gain" in initialize(), "phase" (STEP times the tick, after another value) in each tick, "even"
/// in every second one, "odd/name%" in each; "phase" is NaN in tick 3.
class Varying : public Pusher {
 public:
  explicit Varying(const Words& words) : Pusher(1.0), step_(std::stod(words.at(0))) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    rehearse_variable("gain", 2.5);
    return Pusher::initialize(io);
  }
  bool control() override {
    rehearse_variable("phase", -1.0);
    rehearse_variable("phase", tick_ == 3 ? std::nan("") : step_ * tick_);
    if (tick_ % 2 == 0) rehearse_variable("even", tick_);
    rehearse_variable("odd/name%", 1.0);
    return Pusher::control();
  }

 private:
  double step_;
};
const Add<Varying> varying("variables");

/// Sets variables with forbidden names and values, each twice.
class Misnaming : public Pusher {
 public:
  explicit Misnaming(const Words&) : Pusher(1.0) {}
  bool control() override {
    rehearse_variable(nullptr, 1.0);
    rehearse_variable("", 1.0);
    rehearse_variable(std::string(300, 'x').c_str(), 1.0);
    rehearse_variable("\xff\xfe", 1.0);
    for (int i = 0; i < 1100; ++i) rehearse_variable(("v" + std::to_string(i)).c_str(), i);
    return Pusher::control();
  }
};
const Add<Misnaming> misnaming("misnaming");

/// stray HOW: sets a variable in a separate thread ("thread"), or in stop() ("stop").
class Straying : public Pusher {
 public:
  explicit Straying(const Words& words) : Pusher(1.0), how_(words.at(0)) {}
  bool control() override {
    if (how_ == "thread" && tick_ == 2) std::thread([] { rehearse_variable("stray", 1.0); }).join();
    return Pusher::control();
  }
  void stop() override {
    if (how_ == "stop") rehearse_variable("stray", 1.0);
  }

 private:
  std::string how_;
};
const Add<Straying> straying("stray");

/// lines [END] [WORD]: writes two lines and a half in each of the ticks 0 and 1, the other half in the next tick. In
/// tick 2 it writes WORD, sets a variable and, depending on END, throws or crashes.
class Speaking : public Pusher {
 public:
  explicit Speaking(const Words& words) : Pusher(1.0), words_(words) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io->os() << "before\n"
             << "the run\n";
    return Pusher::initialize(io);
  }
  bool control() override {
    if (tick_ < 2) io_->os() << "one " << tick_ << "\n\nthree " << tick_;
    if (tick_ == 2) end();
    return Pusher::control();
  }
  void stop() override { io_->os() << "over\n"; }

 private:
  void end() {
    const std::string how = words_.empty() ? "" : words_[0];
    io_->os() << (words_.size() > 1 ? words_[1] : "last") << " words\n";
    rehearse_variable("doom", 13.0);
    if (how == "throw") throw std::runtime_error("no more");
    if (how == "crash") *static_cast<volatile int*>(nullptr) = 1;
  }
  Words words_;
};
const Add<Speaking> speaking("lines");

}  // namespace
}  // namespace behaviours
