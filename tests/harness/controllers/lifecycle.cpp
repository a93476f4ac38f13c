// Controllers that log their calls: the order, the results, the time.

#include <cnoid/ExecutablePath>
#include <cnoid/YAMLReader>
#include <fstream>
#include <iomanip>
#include <memory>

#include "behaviours.h"

namespace behaviours {
namespace {

/// Writes the name of each of its functions when it is called; control() only the first time.
class Narrator : public cnoid::SimpleController {
 public:
  explicit Narrator(const Words&) {}
  bool configure(cnoid::SimpleControllerConfig* config) override { return config->os() << "configure\n", true; }
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    return say("initialize");
  }
  bool start() override { return say("start"); }
  bool control() override {
    if (!controlled_) say("control");
    controlled_ = true;
    return true;
  }
  void stop() override { say("stop"); }
  void unconfigure() override { say("unconfigure"); }

 private:
  bool say(const char* word) {
    io_->os() << word << "\n";
    return true;
  }
  cnoid::SimpleControllerIO* io_ = nullptr;
  bool controlled_ = false;
};
const Add<Narrator> narrator("narrate");

/// Writes the time in stop().
class EndTeller : public Pusher {
 public:
  explicit EndTeller(const Words&) : Pusher(1.0) {}
  void stop() override { io_->os() << "stopped at " << io_->currentTime() << " s\n"; }
};
const Add<EndTeller> end_teller("tell_end");

/// refuse FUNCTION: that function returns false. Writes a line if it is called after that, and when it is stopped.
class Refuser : public Pusher {
 public:
  explicit Refuser(const Words& words) : Pusher(1.0), function_(words.at(0)) {}
  bool configure(cnoid::SimpleControllerConfig*) override { return function_ != "configure"; }
  bool initialize(cnoid::SimpleControllerIO* io) override {
    return Pusher::initialize(io) && function_ != "initialize";
  }
  bool start() override { return function_ != "start"; }
  bool control() override {
    io_->os() << "control after all\n";
    return Pusher::control();
  }
  void stop() override { io_->os() << "stop after all\n"; }

 private:
  std::string function_;
};
const Add<Refuser> refuser("refuse");

/// rest FROM UNTIL: control() returns false from one tick on, and true again from the other on.
class Rester : public Pusher {
 public:
  explicit Rester(const Words& words) : Pusher(1.0), from_(std::stoi(words.at(0))), until_(std::stoi(words.at(1))) {}
  bool control() override {
    const int tick = tick_;
    return Pusher::control() && (tick < from_ || tick >= until_);
  }

 private:
  const int from_, until_;
};
const Add<Rester> rester("rest");

/// push EFFORT [nodelay] [false]: commands a constant effort; with no-delay mode; control() returns false.
class ConstantPusher : public Pusher {
 public:
  explicit ConstantPusher(const Words& words) : Pusher(std::stod(words.at(0))), words_(words) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    if (has("nodelay")) io->setNoDelayMode(true);
    return Pusher::initialize(io);
  }
  bool control() override { return Pusher::control() && !has("false"); }

 private:
  bool has(const char* word) const {
    for (const std::string& known : words_)
      if (known == word) return true;
    return false;
  }
  Words words_;
};
const Add<ConstantPusher> constant_pusher("push");

/// busy TICK: control() takes some tens of milliseconds in that tick.
class Busy : public cnoid::SimpleController {
 public:
  explicit Busy(const Words& words) : busy_at_(std::stoi(words.at(0))) {}
  bool initialize(cnoid::SimpleControllerIO*) override { return true; }
  bool control() override {
    for (volatile int turn = 0; tick_ == busy_at_ && turn < 20'000'000;) turn = turn + 1;
    ++tick_;
    return true;
  }

 private:
  int busy_at_ = 0, tick_ = 0;
};
const Add<Busy> busy("busy");

/// allocate TICK: control() allocates and releases a block of 1000 B from that tick on.
class Allocator : public cnoid::SimpleController {
 public:
  explicit Allocator(const Words& words) : from_(std::stoi(words.at(0))) {}
  bool initialize(cnoid::SimpleControllerIO*) override { return true; }
  bool control() override {
    if (tick_++ >= from_) block_.reset(new char[1000]);
    block_.reset();
    return true;
  }

 private:
  int from_ = 0, tick_ = 0;
  std::unique_ptr<char[]> block_;
};
const Add<Allocator> allocator("allocate");

/// file PATH: commands the effort in the file; refuses if there is no file.
class FileReader : public Pusher {
 public:
  explicit FileReader(const Words& words) : Pusher(0.0), path_(words.at(0)) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    std::ifstream stream(path_);
    return stream >> effort_ && Pusher::initialize(io);
  }

 private:
  std::string path_;
};
const Add<FileReader> file_reader("file");

/// shared_file NAME: as `file`, of a file below shareDirPath().
class SharedFileReader : public Pusher {
 public:
  explicit SharedFileReader(const Words& words) : Pusher(0.0), name_(words.at(0)) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    std::ifstream stream(cnoid::shareDirPath() / name_);
    return stream >> effort_ && Pusher::initialize(io);
  }

 private:
  std::string name_;
};
const Add<SharedFileReader> shared_file_reader("shared_file");

/// yaml PATH: commands the `effort` in the file, which the API reads.
class YamlReader : public Pusher {
 public:
  explicit YamlReader(const Words& words) : Pusher(0.0), path_(words.at(0)) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    cnoid::YAMLReader reader;
    return reader.load(path_) && reader.document()->toMapping()->read("effort", effort_) && Pusher::initialize(io);
  }

 private:
  std::string path_;
};
const Add<YamlReader> yaml_reader("yaml");

/// add EFFORT: adds to the command of a different controller of the body.
class Adder : public Pusher {
 public:
  explicit Adder(const Words& words) : Pusher(std::stod(words.at(0))) {}
  bool control() override {
    shoulder_->u() += effort_;
    return true;
  }
};
const Add<Adder> adder("add");

/// Writes an effort in initialize() only: 5, or 4 with the run's option "softer". "once": control() resets it.
class EarlyPusher : public Pusher {
 public:
  explicit EarlyPusher(const Words& words) : Pusher(0.0), acts_once_(!words.empty()) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    Pusher::initialize(io);
    shoulder_->u() = io->optionString().find("softer") == std::string::npos ? 5.0 : 4.0;
    return true;
  }
  bool control() override {
    if (acts_once_) shoulder_->u() = 0.0;
    return true;
  }

 private:
  bool acts_once_;
};
const Add<EarlyPusher> early_pusher("early");

/// Writes an external force of 7 N on the root link in initialize() only, and in control() the force that it reads.
class EarlyForce : public cnoid::SimpleController {
 public:
  explicit EarlyForce(const Words&) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    os_ = &io->os();
    root_ = io->body()->rootLink();
    io->enableInput(root_, LinkExtWrench);
    io->enableOutput(root_, LinkExtWrench);
    root_->F_ext()[0] = 7.0;
    return true;
  }
  bool control() override {
    *os_ << root_->F_ext()[0] << "\n";
    root_->F_ext().setZero();
    return true;
  }

 private:
  std::ostream* os_ = nullptr;
  cnoid::Link* root_ = nullptr;
};
const Add<EarlyForce> early_force("early_force");

/// Commands the time [s] as an effort, and writes the time in the other functions.
class Clock : public Pusher {
 public:
  explicit Clock(const Words&) : Pusher(0.0) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io->os() << "initialize at " << io->currentTime() << " step " << io->timeStep() << "\n";
    return Pusher::initialize(io);
  }
  bool start() override {
    io_->os() << "start at " << io_->currentTime() << "\n";
    return true;
  }
  bool control() override {
    effort_ = io_->currentTime();
    return Pusher::control();
  }
};
const Add<Clock> controller_clock("clock");

/// Writes its options, in configure() and in initialize().
class OptionSayer : public cnoid::SimpleController {
 public:
  explicit OptionSayer(const Words&) {}
  bool configure(cnoid::SimpleControllerConfig* config) override {
    config->os() << "configure: " << config->optionString() << "\n";
    return true;
  }
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io->os() << "initialize: " << io->optionString() << "\n";
    for (const std::string& option : io->options()) io->os() << "[" << option << "]";
    io->os() << "\n";
    return true;
  }
  bool control() override { return true; }
};
const Add<OptionSayer> option_sayer("options");

}  // namespace
}  // namespace behaviours
