// Controllers that read the contacts of their robot.

#include "behaviours.h"

namespace behaviours {
namespace {

using cnoid::Link;

/// touch LINK: writes a line when the number of the link's contact points changes. Commands SHOULDER, as its effort, a
/// sum of all numbers of the points that is too small to move the robot.
class Toucher : public Pusher {
 public:
  explicit Toucher(const Words& words) : Pusher(0.0), name_(words.at(0)) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    link_ = io->body()->link(name_);
    io->enableInput(link_, Link::LinkContactState);
    return Pusher::initialize(io);
  }
  bool control() override {
    const auto& points = link_->contactPoints();
    effort_ = 0.0;
    cnoid::Vector3 force = cnoid::Vector3::Zero();
    double weight = 1e-3;
    for (const Link::ContactPoint& point : points) {
      force += point.force();
      for (const cnoid::Vector3& numbers : {point.position(), point.normal(), point.force(), point.velocity()})
        for (int i = 0; i < 3; ++i) effort_ += (weight *= 1.01) * numbers[i];
      effort_ += (weight *= 1.01) * point.depth();
    }
    if (points.size() != count_)
      io_->os() << "tick " << tick_ << ": " << points.size() << " points, " << (force.z() > 0.0 ? "pushed up" : "free")
                << "\n";
    count_ = points.size();
    return Pusher::control();
  }

 private:
  std::string name_;
  Link* link_ = nullptr;
  std::size_t count_ = 0;
};
const Add<Toucher> toucher("touch");

/// bump DEVICE: writes a contact sensor's reading when its number of points changes, and the number of earlier
/// notifications.
class Bumper : public Pusher {
 public:
  explicit Bumper(const Words& words) : Pusher(0.0), name_(words.at(0)) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    device_ = io->body()->findDevice(name_);
    io->os() << device_->typeName() << " " << device_->name() << " on " << device_->link()->name() << ", "
             << device_->stateSize() << " numbers, " << io->body()->devices().size() << " devices\n";
    io->enableInput(device_);
    device_->sigStateChanged().connect([this] { ++notified_; });
    return Pusher::initialize(io);
  }
  bool control() override {
    double values[4];
    device_->writeState(values);
    if (values[0] != count_)
      io_->os() << "tick " << tick_ << ": " << values[0] << " points, " << (values[3] > 0.0 ? "pushed up" : "free")
                << ", notified " << notified_ << " times\n";
    count_ = values[0];
    effort_ = values[3];
    return Pusher::control();
  }

 private:
  std::string name_;
  cnoid::Device* device_ = nullptr;
  int notified_ = 0;
  double count_ = 0.0;
};
const Add<Bumper> bumper("bump");

}  // namespace
}  // namespace behaviours
