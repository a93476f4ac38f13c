// Controllers that read sensors and command devices.

#include <cmath>
#include <cnoid/AccelerationSensor>
#include <cnoid/DeviceList>
#include <cnoid/ForceSensor>
#include <cnoid/HolderDevice>
#include <cnoid/Imu>
#include <cnoid/RangeCamera>
#include <cnoid/RangeSensor>
#include <cnoid/RateGyroSensor>
#include <cnoid/RotorDevice>
#include <cnoid/SpotLight>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include "behaviours.h"

namespace behaviours {
namespace {

/// Writes the sensors' readings in its first two ticks to os().
class SensorSayer : public cnoid::SimpleController {
 public:
  explicit SensorSayer(const Words&) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    for (cnoid::Device* device : io->body()->devices()) io->enableInput(device);
    return true;
  }
  bool control() override {
    if (tick_ > 1) return true;
    const cnoid::Body& body = *io_->body();
    io_->os() << "tick " << tick_ << " accelerometer "
              << body.findDevice<cnoid::AccelerationSensor>("Accelerometer")->dv().z() << " imu "
              << body.findDevice<cnoid::Imu>("Imu")->dv().z() << " force "
              << body.findDevice<cnoid::ForceSensor>("Force")->f().z() << "\n";
    ++tick_;
    return true;
  }

 private:
  cnoid::SimpleControllerIO* io_ = nullptr;
  int tick_ = 0;
};
const Add<SensorSayer> sensor_sayer("sense");

/// Commands the accelerometer's z as an effort, although its input was never enabled.
class Blind : public Pusher {
 public:
  explicit Blind(const Words&) : Pusher(0.0) {}
  bool control() override {
    effort_ = io_->body()->findDevice<cnoid::AccelerationSensor>("Accelerometer")->dv().z();
    return Pusher::control();
  }
};
const Add<Blind> blind("blind");

/// A number in [0, 1) that depends on every bit of the added data.
class Fingerprint {
 public:
  void add(const void* data, std::size_t size) {
    unsigned char byte;
    for (std::size_t i = 0; i < size; ++i) {
      std::memcpy(&byte, static_cast<const char*>(data) + i, 1);
      sum_ = (sum_ ^ byte) * 0x100000001b3u;  // FNV-1a
    }
  }
  double number() const { return static_cast<double>(sum_ >> 11) * 0x1p-53; }

 private:
  std::uint64_t sum_ = 0xcbf29ce484222325u;
};

/// switch TICK [notify] [nodelay]: switches the camera off in that tick (-1: in initialize), with or without a
/// notification.
class CameraSwitch : public Pusher {
 public:
  explicit CameraSwitch(const Words& words) : Pusher(0.0), off_tick_(std::stoi(words.at(0))), words_(words) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io->setNoDelayMode(words_.back() == "nodelay");
    Pusher::initialize(io);
    if (off_tick_ < 0) turn_off();
    return true;
  }
  bool control() override {
    if (tick_ == off_tick_) turn_off();
    return Pusher::control();
  }

 private:
  void turn_off() {
    auto* camera = io_->body()->findDevice<cnoid::Camera>("Camera");
    camera->on(false);
    if (words_.size() > 1 && words_[1] == "notify") camera->notifyStateChange();
  }
  int off_tick_;
  Words words_;
};
const Add<CameraSwitch> camera_switch("switch");

/// Commands a fingerprint of the camera's picture and points.
class PictureReader : public Pusher {
 public:
  explicit PictureReader(const Words&) : Pusher(0.0) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    camera_ = io->body()->findDevice<cnoid::RangeCamera>("Camera");
    io->enableInput(camera_);
    return Pusher::initialize(io);
  }
  bool control() override {
    Fingerprint seen;
    const cnoid::Image& image = camera_->constImage();
    seen.add(image.pixels(), static_cast<std::size_t>(image.width() * image.height() * image.numComponents()));
    for (const cnoid::Vector3f& point : camera_->constPoints()) seen.add(point.data(), sizeof point);
    const double delay = camera_->delay();
    seen.add(&delay, sizeof delay);
    effort_ = seen.number();
    return Pusher::control();
  }

 private:
  cnoid::RangeCamera* camera_ = nullptr;
};
const Add<PictureReader> picture_reader("look");

/// scan NAME: writes the range sensor's parameters, and at each new scan the tick and the data.
class ScanSayer : public Pusher {
 public:
  explicit ScanSayer(const Words& words) : Pusher(0.0), name_(words.at(0)) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    laser_ = io->body()->findDevice<cnoid::RangeSensor>(name_);
    io->os() << laser_->numYawSamples() << " x " << laser_->numPitchSamples() << " beams, yaw " << laser_->minYawAngle()
             << " to " << laser_->maxYawAngle() << ", pitch " << laser_->minPitchAngle() << " to "
             << laser_->maxPitchAngle() << ", " << laser_->minDistance() << " to " << laser_->maxDistance() << " m, "
             << laser_->scanRate() << " Hz\n";
    io->enableInput(laser_);
    laser_->sigStateChanged().connect([this] { is_new_ = true; });
    return Pusher::initialize(io);
  }
  bool control() override {
    Fingerprint seen;
    const std::vector<double>& ranges = laser_->constRangeData();
    seen.add(ranges.data(), ranges.size() * sizeof(double));
    const double delay = laser_->delay();
    seen.add(&delay, sizeof delay);
    effort_ = seen.number();
    if (is_new_) {
      io_->os() << "tick " << tick_ << " delay " << delay << ":";
      for (const double range : ranges) io_->os() << " " << range;
      io_->os() << "\n";
    }
    is_new_ = false;
    return Pusher::control();
  }

 private:
  std::string name_;
  cnoid::RangeSensor* laser_ = nullptr;
  bool is_new_ = false;
};
const Add<ScanSayer> scan_sayer("scan");

/// lamp: writes the parameters of the lights.
class LampSayer : public Pusher {
 public:
  explicit LampSayer(const Words&) : Pusher(0.0) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    for (const auto& light : io->body()->devices<cnoid::PointLight>()) {
      io->os() << light->typeName() << " " << light->name() << (light->on() ? " on" : " off") << " color "
               << light->color().transpose() << " intensity " << light->intensity() << " fading "
               << light->constantAttenuation() << " " << light->linearAttenuation() << " "
               << light->quadraticAttenuation();
      if (const auto* spot = dynamic_cast<cnoid::SpotLight*>(light.get()))
        io->os() << " towards " << spot->direction().transpose() << " within " << spot->beamWidth() << " to "
                 << spot->cutOffAngle() << " exponent " << spot->cutOffExponent();
      io->os() << "\n";
    }
    return Pusher::initialize(io);
  }
};
const Add<LampSayer> lamp_sayer("lamp");

/// laser_off NAME TICK: switches a range sensor off in that tick, and on again 15 ticks later.
class LaserSwitch : public Pusher {
 public:
  explicit LaserSwitch(const Words& words) : Pusher(0.0), name_(words.at(0)), tick_off_(std::stoi(words.at(1))) {}
  bool control() override {
    if (tick_ == tick_off_ || tick_ == tick_off_ + 15) {
      auto* laser = io_->body()->findDevice<cnoid::RangeSensor>(name_);
      laser->on(tick_ != tick_off_);
      laser->notifyStateChange();
    }
    return Pusher::control();
  }

 private:
  std::string name_;
  int tick_off_;
};
const Add<LaserSwitch> laser_switch("laser_off");

/// Commands the IMU's numbers, combined into one effort.
class Feeler : public Pusher {
 public:
  explicit Feeler(const Words&) : Pusher(0.0) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    for (cnoid::Device* device : io->body()->devices())
      if (!dynamic_cast<cnoid::Camera*>(device)) io->enableInput(device);
    Pusher::initialize(io);
    io->enableInput(shoulder_, cnoid::Link::JointDisplacement | cnoid::Link::JointVelocity |
                                   cnoid::Link::JointAcceleration | cnoid::Link::LinkPosition | cnoid::Link::LinkTwist |
                                   cnoid::Link::LinkAcceleration);
    return true;
  }
  bool control() override {
    const cnoid::Body& body = *io_->body();
    effort_ = 0.5 - shoulder_->q() - 0.1 * shoulder_->dq() + 1e-3 * shoulder_->ddq() + shoulder_->R()(0, 2) +
              1e-3 * shoulder_->w().y() + 1e-4 * shoulder_->dw().y() +
              1e-3 * body.findDevice<cnoid::RateGyroSensor>("Gyro")->w().y() +
              1e-3 * body.findDevice<cnoid::AccelerationSensor>("Accelerometer")->dv().sum() +
              1e-3 * body.findDevice<cnoid::Imu>("Imu")->dv().x() +
              1e-4 * body.findDevice<cnoid::ForceSensor>("Force")->F().sum();
    return Pusher::control();
  }
};
const Add<Feeler> feeler("feel");

/// bulb TICK [TWICE|silent]: switches light Bulb off in that tick (-1: in initialize) and notifies. TWICE: after a
/// notification that it is green; silent: without notification; nan: with an invalid colour.
class BulbSwitch : public Pusher {
 public:
  explicit BulbSwitch(const Words& words)
      : Pusher(0.0), off_tick_(std::stoi(words.at(0))), how_(words.size() > 1 ? words[1] : "") {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    bulb_ = io->body()->findDevice<cnoid::PointLight>("Bulb");
    io->enableInput(bulb_);
    echo_ = bulb_->sigStateChanged().connect([this] { heard_ += 1.0; });
    if (off_tick_ < 0) put_out();
    return Pusher::initialize(io);
  }
  bool control() override {
    if (tick_ == off_tick_) put_out();
    effort_ = heard_;
    return Pusher::control();
  }

 private:
  void put_out() {
    if (how_ == "TWICE") {
      bulb_->setColor(cnoid::Vector3f(0, 1, 0));
      bulb_->notifyStateChange();
    }
    bulb_->setColor(cnoid::Vector3f(how_ == "nan" ? NAN : 0.5f, 0, 0));
    bulb_->on(false);
    if (how_ == "silent") return;
    bulb_->notifyStateChange();
    heard_ = 0.0;  // but for its own
  }
  int off_tick_;
  std::string how_;
  cnoid::PointLight* bulb_ = nullptr;
  cnoid::ScopedConnection echo_;
  double heard_ = 0.0;
};
const Add<BulbSwitch> bulb_switch("bulb");

/// blink TICK: switches light Bulb off in that tick, and commands nothing else.
class Blinker : public cnoid::SimpleController {
 public:
  explicit Blinker(const Words& words) : off_tick_(std::stoi(words.at(0))) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    bulb_ = io->body()->findDevice<cnoid::PointLight>("Bulb");
    return true;
  }
  bool control() override {
    if (tick_++ != off_tick_) return true;
    bulb_->on(false);
    bulb_->notifyStateChange();
    return true;
  }

 private:
  int off_tick_;
  int tick_ = 0;
  cnoid::PointLight* bulb_ = nullptr;
};
const Add<Blinker> blinker("blink");

/// overhear [throw]: writes the changes of light Bulb and of the info of device Camera, with the tick; or throws then.
class Listener : public cnoid::SimpleController {
 public:
  explicit Listener(const Words& words) : throws_(!words.empty()) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    auto* bulb = io->body()->findDevice<cnoid::PointLight>("Bulb");
    auto* camera = io->body()->findDevice<cnoid::Camera>("Camera");
    io->enableInput(bulb);
    io->enableInput(camera);
    states_ = bulb->sigStateChanged().connect([this, io, bulb] {
      if (throws_) throw std::runtime_error("too dark");
      io->os() << "tick " << tick_ << " bulb " << (bulb->on() ? "on" : "off") << " red " << bulb->color().x() << "\n";
    });
    infos_ = camera->sigInfoChanged().connect([this, io, camera] {
      io->os() << "tick " << tick_ << " exposure " << camera->info()->get("exposure", 0.0) << "\n";
    });
    return true;
  }
  bool control() override { return ++tick_, true; }

 private:
  bool throws_;
  cnoid::ScopedConnection states_, infos_;
  int tick_ = 0;
};
const Add<Listener> listener("overhear");

/// expose TICK VALUE: writes the value into the info of device Camera in that tick, and notifies.
class Exposer : public Pusher {
 public:
  explicit Exposer(const Words& words)
      : Pusher(0.0), change_tick_(std::stoi(words.at(0))), value_(std::stod(words.at(1))) {}
  bool control() override {
    auto* camera = io_->body()->findDevice<cnoid::Camera>("Camera");
    if (tick_ == change_tick_) {
      camera->info()->write("exposure", value_);
      camera->notifyInfoChange();
    } else if (tick_ > change_tick_) {
      camera->info()->write("exposure", -1.0);  // without a word: in no copy
    }
    return Pusher::control();
  }

 private:
  int change_tick_;
  double value_;
};
const Add<Exposer> exposer("expose");

/// fly ROTOR THRUST TICK OTHER: commands that thrust [N] from the beginning on, and another from a tick on.
class Flyer : public cnoid::SimpleController {
 public:
  explicit Flyer(const Words& words)
      : name_(words.at(0)),
        thrust_(std::stod(words.at(1))),
        tick_(std::stoi(words.at(2))),
        other_(std::stod(words.at(3))) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    rotor_ = io->body()->findDevice<Multicopter::RotorDevice>(name_);
    return rotor_ != nullptr;
  }
  bool control() override {
    rotor_->setValue(tick_-- > 0 ? thrust_ : other_);
    rotor_->notifyStateChange();
    return true;
  }

 private:
  std::string name_;
  double thrust_;
  int tick_;
  double other_;
  Multicopter::RotorDevicePtr rotor_;
};
const Add<Flyer> flyer("fly");

/// hold HOLDER ON OFF: turns it on and off in these ticks.
class Gripper : public cnoid::SimpleController {
 public:
  explicit Gripper(const Words& words)
      : name_(words.at(0)), on_(std::stoi(words.at(1))), off_(std::stoi(words.at(2))) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    holder_ = io->body()->findDevice<cnoid::HolderDevice>(name_);
    return holder_ && holder_->holdCondition() == cnoid::HolderDevice::Distance && holder_->maxHoldDistance() == 0.5;
  }
  bool control() override {
    if (tick_ == on_ || tick_ == off_) {
      holder_->on(tick_ == on_);
      holder_->notifyStateChange();
    }
    return ++tick_, true;
  }

 private:
  std::string name_;
  int on_, off_, tick_ = 0;
  cnoid::HolderDevicePtr holder_;
};
const Add<Gripper> gripper("hold");

/// compass DEVICE: reads a magnetometer, and commands 1e6 times its first number as an effort.
class Compass : public Pusher {
 public:
  explicit Compass(const Words& words) : Pusher(0.0), name_(words.at(0)) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    device_ = io->body()->findDevice(name_);
    io->os() << device_->typeName() << " " << device_->name() << ", " << device_->stateSize() << " numbers\n";
    io->enableInput(device_);
    return Pusher::initialize(io);
  }
  bool control() override {
    double field[3];
    device_->writeState(field);
    effort_ = 1e6 * field[0];
    return Pusher::control();
  }

 private:
  std::string name_;
  cnoid::Device* device_ = nullptr;
};
const Add<Compass> compass("compass");

}  // namespace
}  // namespace behaviours
