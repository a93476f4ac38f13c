// Keeps a red ball in the middle of the picture of a camera on a pan-tilt head.
//
// A picture is old when it arrives: it was captured one camera period earlier, with the head's direction at that time.
// So the controller stores its earlier directions and computes the direction of the ball at the time of the capture,
// and the rate of change of this direction. Then it aims at the predicted present direction of the ball.

#include <algorithm>
#include <cmath>
#include <cnoid/Camera>
#include <cnoid/EigenUtil>
#include <cnoid/SimpleController>
#include <cstddef>
#include <optional>
#include <vector>

namespace {

using cnoid::Vector2;
using cnoid::Vector3;

constexpr double gain = 8.0;       // of the aim's error [1/s]
constexpr double smoothing = 0.4;  // weight of a new measurement in the ball's rate
constexpr int fewest_pixels = 4;

bool is_red(const unsigned char* pixel) { return pixel[0] > 60 && pixel[0] > 2 * pixel[1] && pixel[0] > 2 * pixel[2]; }

class CameraFollowerController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    pan_ = io->body()->joint("PAN");
    tilt_ = io->body()->joint("TILT");
    camera_ = io->body()->findDevice<cnoid::Camera>();
    if (!pan_ || !tilt_ || !camera_) {
      io->os() << io->controllerName() << " needs joints PAN and TILT, and a camera\n";
      return false;
    }
    for (cnoid::Link* joint : {pan_, tilt_}) {
      joint->setActuationMode(JointVelocity);
      io->enableIO(joint);
    }
    io->enableInput(camera_);
    new_picture_ = camera_->sigStateChanged().connect([this] { has_new_picture_ = true; });
    direction_ = Vector2(pan_->q(), tilt_->q());
    return true;
  }

  bool control() override {
    const Vector2 aim(pan_->q(), tilt_->q());
    aims_.push_back(aim);
    if (has_new_picture_) look();
    has_new_picture_ = false;
    const Vector2 wanted = direction_ + rate_ * (io_->currentTime() - seen_at_);
    const Vector2 velocity = rate_ + gain * (wanted - aim);
    pan_->dq_target() = velocity.x();
    tilt_->dq_target() = velocity.y();
    return true;
  }

 private:
  void look() {
    const std::optional<Vector3> ray = ray_to_ball();
    if (!ray) {
      rate_.setZero();
      return;
    }
    // delay() is the age of the picture at the end of the last step
    const double captured_at = io_->currentTime() - io_->timeStep() - camera_->delay();
    const Vector2 aim = aims_[static_cast<std::size_t>(std::lround(captured_at / io_->timeStep()))];
    const Vector3 to_ball = cnoid::rotFromRpy(0.0, aim.y(), aim.x()) * camera_->R_local() * *ray;
    const Vector2 direction(std::atan2(to_ball.y(), to_ball.x()),
                            std::atan2(-to_ball.z(), std::hypot(to_ball.x(), to_ball.y())));
    if (has_seen_it_) rate_ += smoothing * ((direction - direction_) / (captured_at - seen_at_) - rate_);
    has_seen_it_ = true;
    direction_ = direction;
    seen_at_ = captured_at;
  }

  /// The ray through the middle of all red pixels, in the camera's frame: it looks along -z, with y up.
  std::optional<Vector3> ray_to_ball() const {
    const cnoid::Image& image = camera_->constImage();
    const unsigned char* pixel = image.pixels();
    int count = 0;
    Vector2 sum = Vector2::Zero();
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x, pixel += image.numComponents()) {
        if (!is_red(pixel)) continue;
        sum += Vector2(x + 0.5, y + 0.5);
        ++count;
      }
    }
    if (count < fewest_pixels) return std::nullopt;
    const double focal_length = 0.5 * image.height() / std::tan(0.5 * camera_->fieldOfView());  // [pixels]
    const Vector2 offset = sum / count - 0.5 * Vector2(image.width(), image.height());
    return Vector3(offset.x(), -offset.y(), -focal_length);
  }

  cnoid::SimpleControllerIO* io_ = nullptr;
  cnoid::Link* pan_ = nullptr;
  cnoid::Link* tilt_ = nullptr;
  cnoid::Camera* camera_ = nullptr;
  cnoid::ScopedConnection new_picture_;
  bool has_new_picture_ = false;
  bool has_seen_it_ = false;
  std::vector<Vector2> aims_;       // pan and tilt in each step so far [rad]
  Vector2 direction_;               // to the ball, as pan and tilt [rad] ...
  double seen_at_ = 0.0;            // ... at this time [s]
  Vector2 rate_ = Vector2::Zero();  // of the direction [rad/s]
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(CameraFollowerController)
