// Controllers with a planted fault each, for the search of fuzz tests. The option string is the name of one; after the
// word `sound` the same controller does it right. Efforts are limited to 20 N·m, so that nothing but the fault breaks
// the limit.
#include <rehearse_variable.h>

#include <cnoid/Imu>
#include <cnoid/SimpleController>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

constexpr double most = 20.0;    // [N·m]
constexpr double wrong = 100.0;  // [N·m]
bool sound = false;              // set before the fault is made

struct Readings {
  double q[3], dq[3];  // [rad], [rad/s]
  double w[3], dv[3];  // of the IMU [rad/s], [m/s²]
};

struct Fault {
  virtual ~Fault() = default;
  virtual void control(const Readings& in, double* u) = 0;
};

double limited(double effort) { return std::clamp(effort, -most, most); }
bool near(double value, double wanted, double distance) { return std::abs(value - wanted) < distance; }

/// A mode that few inputs select.
bool is_rare(const Readings& in) {
  if (!near(in.q[2], -0.45, 2e-3)) return false;
  return near(in.dq[1], 0.7, 4e-3);
}

struct ChainOfThree final : Fault {
  void control(const Readings& in, double* u) override {
    if (near(in.q[0], 0.731, 1e-3))
      if (near(in.dq[1], -1.7, 2e-3))
        if (near(in.dv[2], 31.0, 0.02)) u[0] = sound ? most : wrong;
  }
};

struct ChainOfFive final : Fault {
  void control(const Readings& in, double* u) override {
    if (near(in.q[0], 0.5, 0.04))
      if (near(in.dq[0], -1.2, 0.12))
        if (near(in.q[1], -0.3, 0.04))
          if (near(in.dq[1], 2.0, 0.12))
            if (near(in.dv[0], -20.0, 2.0)) u[1] = sound ? most : -wrong;
  }
};

/// Standing, bending, gripping, lifting: from `gripping` a fall isn't handled.
struct ForgottenEdge final : Fault {
  int state = 0;
  void control(const Readings& in, double* u) override {
    const bool falls = near(in.dv[2], -30.0, 0.5);
    if (state == 0 && near(in.q[0], 0.5, 0.004))
      state = 1;
    else if (state == 1 && near(in.dq[0], -2.0, 0.01))
      state = 2;
    else if (state == 2 && near(in.q[1], 0.25, 0.004))
      state = 3;
    rehearse_variable("state", state);
    if (falls && (state < 2 || sound)) state = 0;
    if (falls && state == 3) u[0] = wrong;
  }
};

/// Each time that the brake is applied the gain is doubled; it must be doubled once.
struct EdgeTakenTwice final : Fault {
  bool brakes = false;
  double gain = 1.0;
  void control(const Readings& in, double* u) override {
    const bool wants = near(in.q[1], -0.6, 0.004);
    if (wants && !brakes) gain = sound ? 8.0 : gain * 8.0;
    if (!wants && near(in.q[2], 0.4, 0.004))
      brakes = false;
    else
      brakes = brakes || wants;
    u[0] = gain > 8.0 ? wrong : limited(gain * in.dq[0]);
  }
};

/// The length of a vector that is 0 in free fall, while it turns.
struct ZeroLength final : Fault {
  void control(const Readings& in, double* u) override {
    const double length = std::sqrt(in.dv[0] * in.dv[0] + in.dv[1] * in.dv[1] + in.dv[2] * in.dv[2]);
    if (!is_rare(in)) return;
    u[0] = sound && length == 0.0 ? 0.0 : 5.0 * in.dv[2] / length;
  }
};

/// The height of a foot by Pythagoras, in one gait without the check of its reach.
struct SquareRoot final : Fault {
  void control(const Readings& in, double* u) override {
    const double reach = 1.0 - in.q[0] * in.q[0] - in.q[1] * in.q[1];
    const bool trots = is_rare(in);
    if (!trots && reach < 0.0) return;
    u[1] = limited(5.0 * std::sqrt(sound ? std::max(0.0, reach) : reach));
  }
};

/// The angle of a knee by the cosine rule.
struct ArcCosine final : Fault {
  void control(const Readings& in, double* u) override {
    if (!is_rare(in)) return;
    const double length = 0.7 + 0.31 * in.q[1];
    const double cosine = 1.0 - length * length / 0.5;
    u[2] = limited(std::acos(sound ? std::clamp(cosine, -1.0, 1.0) : cosine));
  }
};

/// Milliseconds for which the foot has slipped, in a byte.
struct Wraps final : Fault {
  std::uint8_t slipped = 0;
  void control(const Readings& in, double* u) override {
    if (near(in.dq[0], 1.3, 0.01)) {
      if (slipped < 255 || !sound) ++slipped;
      if (slipped == 0) u[0] = wrong;
    }
    rehearse_variable("slipped", slipped);
  }
};

/// A row for each tenth of the range, and none for its end.
struct BeyondTheTable final : Fault {
  std::vector<double> rows = std::vector<double>(10, 1.0);
  void control(const Readings& in, double* u) override {
    if (!is_rare(in)) return;
    auto row = static_cast<std::size_t>((in.q[0] + 1.0) * 5.0);
    if (sound) row = std::min<std::size_t>(row, 9);
    u[0] = limited(rows.at(row));
  }
};

/// A filter of the velocity, which the change to another mode must reset.
struct NotReset final : Fault {
  int mode = 0;
  double filtered = 0.0;
  void control(const Readings& in, double* u) override {
    const int wanted = near(in.q[1], 0.62, 0.005) ? 1 : near(in.q[1], -0.17, 0.005) ? 2 : 0;
    if (wanted != 0 && wanted != mode) {
      if (sound) filtered = 0.0;
      if (mode == 1 && filtered > 15.0) u[0] = wrong;
      mode = wanted;
    }
    if (mode == 1) filtered = std::min(most, filtered + 0.5 * std::max(0.0, in.dq[0]));
    rehearse_variable("mode", mode);
  }
};

/// The cosine of a pitch near its singularity divides.
struct Gimbal final : Fault {
  void control(const Readings& in, double* u) override {
    const double cosine = std::cos(in.q[1] * 1.5707963267948966);
    const double rate = in.w[2] / (sound ? std::max(0.6, std::abs(cosine)) : cosine + (cosine < 0.0 ? -0.02 : 0.02));
    if (is_rare(in)) u[1] = sound ? limited(0.2 * rate) : 0.2 * rate;
  }
};

/// What was integrated while the brake held is released with it.
struct WindUp final : Fault {
  double integral = 0.0;
  void control(const Readings& in, double* u) override {
    const bool is_held = in.q[0] > 0.7;
    if (!(is_held && sound)) integral = is_held ? integral + 0.35 * in.dq[1] : 0.9 * integral;
    if (!is_held && near(in.q[0], 0.11, 0.004)) u[0] = sound ? limited(integral) : integral;
    rehearse_variable("integral", integral);
  }
};

/// Degrees where radians are meant, in one branch of a recovery.
struct UnitSlip final : Fault {
  void control(const Readings& in, double* u) override {
    u[2] = limited(10.0 * in.q[0]);
    if (is_rare(in) && in.q[0] > 0.5) u[2] = 10.0 * in.q[0] * (sound ? 1.0 : 57.29577951308232);
  }
};

/// Positive feedback in one branch.
struct SignSlip final : Fault {
  void control(const Readings& in, double* u) override {
    u[1] = limited(-4.0 * in.dq[1]);
    if (is_rare(in)) u[1] = (sound ? -4.0 : 4.0) * in.dq[1];
  }
};

/// The rate of the effort is limited, but not when the mode changes to `stand` from `sit`.
struct NoRateLimit final : Fault {
  double last = 0.0;
  bool sits = false;
  void control(const Readings& in, double* u) override {
    double wanted = limited(8.0 * in.q[0]);
    if (near(in.dq[2], -2.4, 0.002)) sits = true;
    const bool stands = sits && near(in.q[2], 0.77, 0.0015);
    if (sound || !stands) wanted = std::clamp(wanted, last - 0.05, last + 0.05);
    if (stands) sits = false;
    u[0] = last = wanted;
    rehearse_variable("sits", sits);
  }
};

/// A fault latches; a second one opens the latch.
struct Latch final : Fault {
  bool is_latched = false;
  bool was = false;
  void control(const Readings& in, double* u) override {
    const bool fails = near(in.w[0], 9.0, 0.01);
    if (fails && !was) {
      if (is_latched && !sound) u[0] = wrong;
      is_latched = true;
    }
    if (!fails && near(in.dv[1], 20.0, 0.05))
      was = false;
    else
      was = was || fails;
    rehearse_variable("latched", is_latched);
  }
};

/// Floats are compared for equality.
struct Equality final : Fault {
  void control(const Readings& in, double* u) override {
    if (in.q[0] == 0.3712 && !sound) u[0] = wrong;
  }
};

/// A member is read before it is written, in a rare branch.
struct Uninitialised final : Fault {
  double offset;
  Uninitialised() {
    if (sound) offset = 0.0;
  }
  void control(const Readings& in, double* u) override {
    if (is_rare(in)) u[0] = sound ? offset : limited(offset);
  }
};

/// Each share keeps to its limit; the sum doesn't if all three joints are at their ends.
struct Sum final : Fault {
  void control(const Readings& in, double* u) override {
    const double sum = 7.0 * in.q[0] + 7.0 * in.q[1] + 7.0 * in.q[2];
    if (sum > 0.0) u[0] = sound ? limited(sum) : sum * (20.0 / 20.6);
  }
};

/// A filter that keeps its value for as long as no sample is new, and differentiates it by the time of one tick.
struct Stale final : Fault {
  double last = 0.0, value = 0.0;
  int age = 0;
  void control(const Readings& in, double* u) override {
    if (in.dv[0] == last) {
      ++age;
    } else {
      if (age > 20 && near(in.dv[0] - last, 17.0, 0.1)) u[0] = sound ? most : wrong;
      age = 0;
    }
    last = in.dv[0];
  }
};

struct Throws final : Fault {
  void control(const Readings& in, double*) override {
    if (near(in.q[0], 0.44, 0.002) && !sound) throw std::runtime_error("no plan for q");
  }
};

struct Crashes final : Fault {
  void control(const Readings& in, double* u) override {
    const double* nothing = near(in.q[0], 0.44, 0.002) && !sound ? nullptr : &in.q[1];
    u[0] = limited(*const_cast<const volatile double*>(nothing));
  }
};

struct Hangs final : Fault {
  void control(const Readings& in, double* u) override {
    volatile bool waits = in.q[0] > 0.8 && !sound;
    while (waits) u[0] = 0.0;
  }
};

struct EatsMemory final : Fault {
  std::vector<std::vector<char>> all;
  void control(const Readings& in, double*) override {
    while (in.q[0] > 0.8 && !sound) {
      all.emplace_back(8 << 20, 'x');
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
};

struct EndsTheProcess final : Fault {
  void control(const Readings& in, double*) override {
    if (in.q[0] > 0.8 && !sound) std::_Exit(0);
  }
};

template <class Kind>
std::unique_ptr<Fault> make() {
  return std::make_unique<Kind>();
}

const std::map<std::string, std::unique_ptr<Fault> (*)()> faults{
    {"ChainOfThree", make<ChainOfThree>},
    {"ChainOfFive", make<ChainOfFive>},
    {"ForgottenEdge", make<ForgottenEdge>},
    {"EdgeTakenTwice", make<EdgeTakenTwice>},
    {"ZeroLength", make<ZeroLength>},
    {"SquareRoot", make<SquareRoot>},
    {"ArcCosine", make<ArcCosine>},
    {"Wraps", make<Wraps>},
    {"BeyondTheTable", make<BeyondTheTable>},
    {"NotReset", make<NotReset>},
    {"Gimbal", make<Gimbal>},
    {"WindUp", make<WindUp>},
    {"UnitSlip", make<UnitSlip>},
    {"SignSlip", make<SignSlip>},
    {"NoRateLimit", make<NoRateLimit>},
    {"Latch", make<Latch>},
    {"Equality", make<Equality>},
    {"Uninitialised", make<Uninitialised>},
    {"Sum", make<Sum>},
    {"Stale", make<Stale>},
    {"Throws", make<Throws>},
    {"Crashes", make<Crashes>},
    {"Hangs", make<Hangs>},
    {"EatsMemory", make<EatsMemory>},
    {"EndsTheProcess", make<EndsTheProcess>},
};

class Planted : public cnoid::SimpleController {
  cnoid::Link* joints_[3] = {};
  cnoid::Imu* imu_ = nullptr;
  std::unique_ptr<Fault> fault_;

 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    const auto words = io->options();
    sound = words.size() > 1 && words[0] == "sound";
    const auto found = faults.find(words.empty() ? "" : words.back());
    if (found == faults.end()) return false;
    fault_ = found->second();
    const char* names[] = {"A", "B", "C"};
    for (int i = 0; i < 3; ++i) {
      joints_[i] = io->body()->joint(names[i]);
      joints_[i]->setActuationMode(cnoid::Link::JointEffort);
      io->enableOutput(joints_[i]);
      io->enableInput(joints_[i], cnoid::Link::JointDisplacement | cnoid::Link::JointVelocity);
    }
    imu_ = io->body()->findDevice<cnoid::Imu>("Imu");
    io->enableInput(imu_);
    return true;
  }

  bool control() override {
    Readings in{};
    double u[3] = {};
    for (int i = 0; i < 3; ++i) {
      in.q[i] = joints_[i]->q();
      in.dq[i] = joints_[i]->dq();
      in.w[i] = imu_->w()[i];
      in.dv[i] = imu_->dv()[i];
    }
    fault_->control(in, u);
    for (int i = 0; i < 3; ++i) joints_[i]->u() = u[i];
    return true;
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Planted)
