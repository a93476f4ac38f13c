// Controllers that print their inputs and outputs.

#include <limits>
#include <random>

#include "behaviours.h"

namespace behaviours {
namespace {

using cnoid::Link;

int flag_of(const std::string& word) {
  if (word == "effort") return Link::JointEffort;
  if (word == "displacement") return Link::JointDisplacement;
  if (word == "velocity") return Link::JointVelocity;
  if (word == "position") return Link::LinkPosition;
  if (word == "wrench") return Link::LinkExtWrench;
  if (word == "twist") return Link::LinkTwist;
  if (word == "acceleration") return Link::JointAcceleration;
  if (word == "high_gain") return Link::HighGainActuation | Link::JointDisplacement;
  if (word == "link_acceleration") return Link::LinkAcceleration;
  if (word == "surface") return Link::DeprecatedJointSurfaceVelocity;
  return Link::StateNone;
}

/// defaults MODE: the inputs that enableInput(link) gives in an actuation mode, for link ARM.
class Defaults : public cnoid::SimpleController {
 public:
  explicit Defaults(const Words& words) : mode_(flag_of(words.at(0))) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    Link* arm = io->body()->link("ARM");
    arm->setActuationMode(static_cast<short>(mode_));
    io->enableInput(arm);
    return true;
  }
  bool control() override { return true; }

 private:
  int mode_;
};
const Add<Defaults> defaults("defaults");

/// all: every state of link ARM.
class Everything : public cnoid::SimpleController {
 public:
  explicit Everything(const Words&) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io->enableInput(io->body()->link("ARM"), Link::JointDisplacement | Link::JointVelocity | Link::JointAcceleration |
                                                 Link::JointEffort | Link::LinkPosition | Link::LinkTwist |
                                                 Link::LinkAcceleration);
    return true;
  }
  bool control() override { return true; }
};
const Add<Everything> everything("all");

/// drive MODE VALUE [JOINT or LINK]: calls only enableOutput with flags.
class Driver : public cnoid::SimpleController {
 public:
  explicit Driver(const Words& words)
      : mode_(flag_of(words.at(0))), value_(std::stod(words.at(1))), joint_(words.size() > 2 ? words[2] : "SHOULDER") {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    link_ = io->body()->joint(joint_);
    if (!link_) link_ = io->body()->link(joint_);
    io->enableOutput(link_, mode_);
    io->os() << "mode " << link_->actuationMode() << "\n";
    return true;
  }
  bool control() override {
    link_->q_target() = link_->dq_target() = link_->ddq() = link_->u() = value_;
    return true;
  }

 private:
  int mode_;
  double value_;
  std::string joint_;
  Link* link_ = nullptr;
};
const Add<Driver> driver("drive");

/// mixed: commands SHOULDER an effort of 1 and RAIL the displacement 0.25.
class Mixed : public Pusher {
 public:
  explicit Mixed(const Words&) : Pusher(1.0) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    Link* rail = io->body()->joint("RAIL");
    rail->setActuationMode(Link::JointDisplacement);
    io->enableOutput(rail);
    rail->q_target() = 0.25;
    return Pusher::initialize(io);
  }
};
const Add<Mixed> mixed("mixed");

/// posture: holds every joint at its initial displacement, whatever robot it is.
class PostureKeeper : public cnoid::SimpleController {
 public:
  explicit PostureKeeper(const Words&) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    for (Link* joint : io->body()->joints()) {
      joint->setActuationMode(Link::JointDisplacement);
      io->enableIO(joint);
      joint->q_target() = joint->q();
    }
    return true;
  }
  bool control() override { return true; }
};
const Add<PostureKeeper> posture("posture");

/// chance SIZE: commands SHOULDER a random effort between 0 and SIZE [N·m].
class Chance : public Pusher {
 public:
  explicit Chance(const Words& words) : Pusher(0.0), size_(std::stod(words.at(0))) {}
  bool control() override {
    effort_ = std::uniform_real_distribution<double>(0.0, size_)(device_);
    return Pusher::control();
  }

 private:
  double size_;
  std::random_device device_;
};
const Add<Chance> chance("chance");

/// once EFFORT: commands SHOULDER that effort in the first ten ticks, then none, so that it stays in force.
class Once : public Pusher {
 public:
  explicit Once(const Words& words) : Pusher(std::stod(words.at(0))) {}
  bool control() override {
    if (tick_ == 10) effort_ = std::numeric_limits<double>::quiet_NaN();
    return Pusher::control();
  }
};
const Add<Once> once("once");

/// Enables no inputs. Commands SHOULDER one more than its last command, and RAIL the q in its body.
class Stale : public cnoid::SimpleController {
 public:
  explicit Stale(const Words&) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    shoulder_ = io->body()->joint("SHOULDER");
    rail_ = io->body()->joint("RAIL");
    for (Link* link : {shoulder_, rail_}) io->enableOutput(link, Link::JointEffort);
    return true;
  }
  bool control() override {
    shoulder_->u() += 1.0;
    rail_->u() = rail_->q();
    return true;
  }

 private:
  Link* shoulder_ = nullptr;
  Link* rail_ = nullptr;
};
const Add<Stale> stale("stale");

/// Enables inputs and outputs in start(), too late.
class LateEnabler : public Pusher {
 public:
  explicit LateEnabler(const Words&) : Pusher(1.0) {}
  bool start() override {
    io_->enableInput(shoulder_, Link::JointVelocity);
    io_->enableIO(io_->body()->joint("RAIL"));
    return true;
  }
};
const Add<LateEnabler> late_enabler("late");

/// wrench FX FY FZ: a force on the root link [N], through its centre.
class Wrench : public cnoid::SimpleController {
 public:
  explicit Wrench(const Words& words)
      : force_(std::stod(words.at(0)), std::stod(words.at(1)), std::stod(words.at(2))) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    root_ = io->body()->rootLink();
    root_->setActuationMode(Link::LinkExtWrench);
    io->enableIO(root_);
    return true;
  }
  bool control() override {
    root_->F_ext().setZero();
    root_->addExternalForceAtLocalPosition(force_, cnoid::Vector3::Zero());
    return true;
  }

 private:
  cnoid::Vector3 force_;
  Link* root_ = nullptr;
};
const Add<Wrench> wrench("wrench");

/// mark VALUE: writes a mark into a member of its body that is neither input nor output.
class Marker : public Pusher {
 public:
  explicit Marker(const Words& words) : Pusher(0.0), mark_(std::stod(words.at(0))) {}
  bool control() override {
    io_->body()->joint("RAIL")->dq_target() = mark_;
    return Pusher::control();
  }

 private:
  double mark_;
};
const Add<Marker> marker("mark");

/// Commands SHOULDER, as its effort, the value of that member.
class MarkReader : public Pusher {
 public:
  explicit MarkReader(const Words&) : Pusher(0.0) {}
  bool control() override {
    effort_ = io_->body()->joint("RAIL")->dq_target();
    return Pusher::control();
  }
};
const Add<MarkReader> mark_reader("read_mark");

/// step EFFORT TICK: commands that effort from that tick on, and 0 before [N·m].
class Stepper : public Pusher {
 public:
  explicit Stepper(const Words& words) : Pusher(std::stod(words.at(0))), from_(std::stoi(words.at(1))) {}
  bool control() override {
    const bool begun = tick_ >= from_;
    Pusher::control();
    if (!begun) shoulder_->u() = 0.0;
    return true;
  }

 private:
  int from_;
};
const Add<Stepper> stepper("step");

/// echo FLAG FIRST [nodelay]: reads and commands one quantity of joint SHOULDER, or of the root link without that
/// joint: in the calls of control() the numbers FIRST, FIRST + 1, and so on. Writes what it reads.
class Echo : public cnoid::SimpleController {
 public:
  explicit Echo(const Words& words)
      : flag_(flag_of(words.at(0))), next_(std::stod(words.at(1))), no_delay_(words.size() > 2) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    os_ = &io->os();
    if (no_delay_) io->setNoDelayMode(true);
    link_ = io->body()->joint("SHOULDER");
    if (!link_) link_ = io->body()->rootLink();
    io->enableInput(link_, flag_);
    io->enableOutput(link_, flag_);
    return true;
  }
  bool control() override {
    *os_ << *read() << "\n";
    *written() = next_++;
    return true;
  }

 private:
  double* read() {
    switch (flag_) {
      case Link::JointDisplacement: return &link_->q();
      case Link::JointVelocity: return &link_->dq();
      default: return written();
    }
  }
  double* written() {
    switch (flag_) {
      case Link::JointDisplacement: return &link_->q_target();
      case Link::JointVelocity: return &link_->dq_target();
      case Link::JointAcceleration: return &link_->ddq();
      case Link::JointEffort: return &link_->u();
      case Link::LinkPosition: return &link_->p().x();
      case Link::LinkTwist: return &link_->v().x();
      case Link::LinkAcceleration: return &link_->dv().x();
      default: return &link_->F_ext()[0];
    }
  }

  int flag_;
  double next_;
  bool no_delay_;
  std::ostream* os_ = nullptr;
  Link* link_ = nullptr;
};
const Add<Echo> echo("echo");

/// body_name: writes the name of its body.
class Namer : public cnoid::SimpleController {
 public:
  explicit Namer(const Words&) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io->os() << io->body()->name() << "\n";
    return true;
  }
  bool control() override { return true; }
};
const Add<Namer> namer("body_name");

/// calls WORD: writes its word with the name of each function that is called.
class Caller : public cnoid::SimpleController {
 public:
  explicit Caller(const Words& words) : word_(words.at(0)) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    return say("initialize");
  }
  bool start() override { return say("start"); }
  bool control() override { return say("control"); }
  void stop() override { say("stop"); }

 private:
  bool say(const char* function) {
    io_->os() << word_ << " " << function << "\n";
    return true;
  }
  std::string word_;
  cnoid::SimpleControllerIO* io_ = nullptr;
};
const Add<Caller> caller("calls");

/// teleport [LINK]: drives the link, or the root link, by its position: 1 mm along x in each step.
class Teleporter : public cnoid::SimpleController {
 public:
  explicit Teleporter(const Words& words) : name_(words.empty() ? "" : words[0]) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    link_ = name_.empty() ? io->body()->rootLink() : io->body()->link(name_);
    io->enableOutput(link_, Link::LinkPosition);
    return true;
  }
  bool control() override {
    link_->p().x() += 0.001;
    return true;
  }

 private:
  std::string name_;
  Link* link_ = nullptr;
};
const Add<Teleporter> teleporter("teleport");

/// spin RATE: keeps the root where it is, and turns it about z [rad/s].
class Spinner : public cnoid::SimpleController {
 public:
  explicit Spinner(const Words& words) : rate_(std::stod(words.at(0))) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    root_ = io->body()->rootLink();
    io->enableOutput(root_, Link::LinkTwist);
    return true;
  }
  bool control() override {
    root_->v().setZero();
    root_->w() = cnoid::Vector3(0.0, 0.0, rate_);
    return true;
  }

 private:
  double rate_;
  Link* root_ = nullptr;
};
const Add<Spinner> spinner("spin");

}  // namespace
}  // namespace behaviours
