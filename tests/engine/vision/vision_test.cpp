// The ticks at which cameras capture and at which their pictures arrive.

#include "renderer/vision.h"
#include "base/clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace rehearse {
namespace {

using Ticks = std::set<std::int64_t>;

/// A body with cameras in front of which a red sphere stands; it can be moved away.
class VisionTest : public ::testing::Test {
 protected:
  VisionTest() {
    model_.name = "Eye";
    model_.links.resize(2);
    model_.links[0].name = "HEAD";
    model_.links[1].name = "BALL";
    model_.links[1].parent = 0;
    model_.links[1].visuals.push_back({"", Sphere{0.3}, Eigen::Isometry3d::Identity(), Color(1, 0, 0, 1), {}});
  }

  void add_camera(const std::string& name, double rate, bool depth = false) {
    Camera camera;
    camera.width = 8;
    camera.height = 6;
    camera.frame_rate = rate;
    camera.depth = depth;
    model_.devices.push_back({name, -1, 0, Eigen::Isometry3d::Identity(), camera, 0});
  }

  void create(double time_step = 0.001, const Look& look = {}) {
    time_step_ = time_step;
    auto vision = Vision::create(time_step, {std::make_shared<const Model>(model_)},
                                 {std::vector<bool>(model_.devices.size(), true)}, look);
    ASSERT_TRUE(vision.ok()) << to_string(vision.errors());
    vision_ = std::move(*vision);
    observation_.bodies.resize(1);
    observation_.bodies[0].links.resize(2);
    observation_.bodies[0].devices.resize(model_.devices.size());
    move_ball(-2.0);
  }

  void move_ball(double z) { observation_.bodies[0].links[1].position = {0.0, 0.0, z}; }

  /// Looks until `last`; the ticks at which the camera had a new picture.
  Ticks arrivals(std::int64_t last, int camera = 0) {
    Ticks ticks;
    for (; tick_ <= last; ++tick_) {
      vision_->look(tick_, observation_);
      if (reading(camera).fresh && reading(camera).image) ticks.insert(tick_);
    }
    return ticks;
  }

  void switch_camera(bool on, int camera = 0) {
    Command command;
    command.bodies.resize(1);
    command.bodies[0].devices.resize(model_.devices.size());
    command.bodies[0].devices[camera] = {true, on, {}};
    vision_->obey(tick_ - 1, command);
  }

  const DeviceReading& reading(int camera = 0) const { return observation_.bodies[0].devices[camera]; }

  /// Whether the picture's middle is red.
  bool sees_ball(int camera = 0) const {
    const std::uint8_t* middle = reading(camera).image->pixels.data() + (3 * 8 + 4) * 3;
    return middle[0] > 2 * middle[2] + 20;
  }

  Model model_;
  std::unique_ptr<Vision> vision_;
  Observation observation_;
  double time_step_ = 0.0;
  std::int64_t tick_ = 0;
};

TEST_F(VisionTest, AntialiasingAndLightsOfTheLookApplyToAllCameras) {
  add_camera("Camera", 50.0);
  const auto picture = [&](const Look& look) {
    tick_ = 0;
    create(0.001, look);
    arrivals(20);
    return *reading().image;
  };
  const Image plain = picture({});
  Look smooth, lit;
  smooth.antialiasing = true;
  lit.lights.push_back({});
  EXPECT_NE(picture(smooth).pixels, plain.pixels);
  EXPECT_NE(picture(lit).pixels, plain.pixels);
  EXPECT_EQ(picture({}).pixels, plain.pixels);
}

TEST_F(VisionTest, ACameraMayHaveAntialiasingOfItsOwn) {
  add_camera("Plain", 50.0);
  add_camera("Smooth", 50.0);
  std::get<Camera>(model_.devices[1].kind).antialiasing = true;
  create();
  arrivals(20);
  EXPECT_NE(reading(1).image->pixels, reading(0).image->pixels);
}

TEST_F(VisionTest, APictureThatIsTooLargeForAntialiasingIsRefused) {
  add_camera("Camera", 50.0);
  std::get<Camera>(model_.devices[0].kind).width = 4096;
  std::get<Camera>(model_.devices[0].kind).antialiasing = true;
  const auto vision = Vision::create(0.001, {std::make_shared<const Model>(model_)}, {{true}});
  ASSERT_FALSE(vision.ok());
  EXPECT_EQ(vision.errors()[0].message, "camera 'Camera' has 4096 x 6 pixels and antialiasing");
}

TEST_F(VisionTest, APictureArrivesAPeriodAfterItsCapture) {
  add_camera("Camera", 30.0);
  create();
  // captured at 0, 34, 67, 100, the first ticks at or after multiples of 33.3 ms; seen a period after these multiples
  EXPECT_EQ(arrivals(140), (Ticks{34, 67, 100, 134}));
}

TEST_F(VisionTest, APictureTellsWhenItWasCaptured) {
  add_camera("Camera", 30.0);
  create();
  arrivals(33);
  EXPECT_EQ(reading().image, nullptr);
  EXPECT_FALSE(reading().fresh);
  arrivals(34);
  EXPECT_EQ(reading().measured_at, 0.0);
  arrivals(68);
  EXPECT_EQ(reading().measured_at, time_of(34, 0.001));
  arrivals(101);
  EXPECT_EQ(reading().measured_at, time_of(67, 0.001));
}

TEST_F(VisionTest, APictureShowsTheMomentOfItsCapture) {
  add_camera("Camera", 30.0);
  create();
  arrivals(0);
  move_ball(+2.0);  // behind the camera
  arrivals(34);
  EXPECT_TRUE(sees_ball());
  arrivals(68);
  EXPECT_FALSE(sees_ball());
}

TEST_F(VisionTest, APictureStaysUntilTheNextOne) {
  add_camera("Camera", 30.0);
  create();
  arrivals(34);
  const auto first = reading().image;
  arrivals(66);
  EXPECT_EQ(reading().image, first);
  EXPECT_FALSE(reading().fresh);
  arrivals(67);
  EXPECT_NE(reading().image, first);
}

TEST_F(VisionTest, ARateThatTheStepDividesIsKeptExactly) {
  add_camera("Camera", 50.0);
  create(0.004);
  EXPECT_EQ(arrivals(26), (Ticks{5, 10, 15, 20, 25}));
}

TEST_F(VisionTest, ARateFasterThanTheStepGivesAPictureEachTick) {
  add_camera("Camera", 10000.0);
  create();
  EXPECT_EQ(arrivals(5), (Ticks{1, 2, 3, 4, 5}));
  EXPECT_EQ(reading().measured_at, time_of(4, 0.001));
}

TEST_F(VisionTest, ASlowCamerasPictureArrivesAfterASecond) {
  add_camera("Camera", 0.5);  // a period of two seconds, a latency of at most one
  create(0.1);
  EXPECT_EQ(arrivals(35), (Ticks{10, 30}));
}

TEST_F(VisionTest, SwitchedOffACameraLosesItsPictureAndSaysSo) {
  add_camera("Camera", 30.0);
  create();
  arrivals(40);
  switch_camera(false);
  vision_->look(tick_++, observation_);
  EXPECT_TRUE(reading().fresh);
  EXPECT_EQ(reading().image, nullptr);
  vision_->look(tick_++, observation_);
  EXPECT_FALSE(reading().fresh);
  EXPECT_EQ(arrivals(200), Ticks{});
}

TEST_F(VisionTest, SwitchedOnAgainItCapturesAtTheNextTick) {
  add_camera("Camera", 30.0);
  create();
  arrivals(40);
  switch_camera(false);
  arrivals(49);
  switch_camera(true);  // in tick 49
  EXPECT_EQ(arrivals(120), (Ticks{84, 117}));
  EXPECT_EQ(reading().measured_at, time_of(84, 0.001));
}

TEST_F(VisionTest, SwitchingOnWhatIsOnChangesNothing) {
  add_camera("Camera", 30.0);
  create();
  arrivals(20);
  switch_camera(true);
  EXPECT_EQ(arrivals(70), (Ticks{34, 67}));
}

TEST_F(VisionTest, OneCamerasPicturesDoNotDependOnTheOthers) {
  add_camera("Camera", 30.0, true);
  create();
  arrivals(68);
  const Image alone = *reading().image;
  const DepthImage alone_depth = *reading().depth;

  add_camera("Fast", 500.0);
  add_camera("Depth", 17.0, true);
  tick_ = 0;
  observation_ = {};
  create();
  arrivals(68);
  EXPECT_EQ(reading().image->pixels, alone.pixels);
  EXPECT_EQ(reading().depth->meters, alone_depth.meters);
}

TEST_F(VisionTest, OnlyACameraThatMeasuresDepthGivesIt) {
  add_camera("Colour", 30.0, false);
  add_camera("Depth", 30.0, true);
  create();
  arrivals(34);
  EXPECT_EQ(reading(0).depth, nullptr);
  ASSERT_NE(reading(1).depth, nullptr);
  EXPECT_NEAR(reading(1).depth->meters[3 * 8 + 4], 1.75, 0.05);
}

TEST_F(VisionTest, LightsShineIntoPicturesFromTheLinkTheySitOn) {
  const auto redness = [this] { return int{reading().image->pixels[static_cast<std::size_t>(3 * 8 + 4) * 3]}; };
  add_camera("Camera", 500.0);
  model_.links[1].visuals[0].color = Color(0.4f, 0.1f, 0.1f, 1.0f);
  create();
  arrivals(2);
  const int dark = redness();

  Light light;
  Eigen::Isometry3d beside = Eigen::Isometry3d::Identity();
  beside.translation().x() = 0.5;
  model_.devices.push_back({"Lamp", -1, 0, beside, light, 0});
  tick_ = 0;
  observation_ = {};
  create();
  arrivals(2);
  EXPECT_GT(redness(), dark + 20);
  observation_.bodies[0].links[0].position.z() = -3.0;  // the camera and its lamp, behind the ball
  observation_.bodies[0].links[0].rotation = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY());
  arrivals(5);
  EXPECT_GT(redness(), dark + 20);
}

TEST_F(VisionTest, RefusesMoreLightsThanAPictureCanHave) {
  add_camera("Camera", 30.0);
  for (int i = 0; i <= Renderer::max_lights; ++i)
    model_.devices.push_back({"Lamp", -1, 0, Eigen::Isometry3d::Identity(), Light{}, 0});
  const auto vision =
      Vision::create(0.001, {std::make_shared<const Model>(model_)}, {std::vector<bool>(model_.devices.size(), true)});
  ASSERT_FALSE(vision.ok());
  EXPECT_EQ(vision.errors()[0].message, "there are more than 64 lights");
}

TEST_F(VisionTest, ShowsTheSkyOfItsLook) {
  add_camera("Camera", 1000.0);
  Look look;
  look.sky = {0.0f, 0.4f, 1.0f, 1.0f};
  create();
  auto vision = Vision::create(0.001, {std::make_shared<const Model>(model_)}, {{true}}, look);
  ASSERT_TRUE(vision.ok());
  for (int tick = 0; tick < 2; ++tick) (*vision)->look(tick, observation_);
  const std::vector<std::uint8_t>& pixels = reading().image->pixels;
  EXPECT_EQ((std::vector<int>(pixels.begin(), pixels.begin() + 3)), (std::vector<int>{0, 102, 255}));
}

/// A camera with an exposure, and one that shows each tick, in front of a ball that moves.
class ExposureTest : public VisionTest {
 protected:
  void begin(const Exposure& exposure, bool depth = false) {
    model_.devices.clear();
    add_camera("Exposed", 50.0, depth);
    add_camera("Each", 1000.0);
    std::get<Camera>(model_.devices[0].kind).exposure = exposure;
    tick_ = 0;
    observation_ = {};
    sharp_.clear();
    create();
  }
  /// Looks until the first picture of the exposed camera arrives, at tick 20.
  void expose() {
    for (; tick_ <= 20; ++tick_) {
      observation_.bodies[0].links[1].position = {0.06 * static_cast<double>(tick_) - 0.4, 0.0, -2.0};
      vision_->look(tick_, observation_);
      if (reading(1).image) sharp_.push_back(*reading(1).image);  // of the tick before
    }
    ASSERT_TRUE(reading().image);
  }
  /// A colour of light that is the mean of these ticks.
  int mean(std::size_t place, const std::vector<std::size_t>& ticks) const {
    double light = 0.0;
    for (const std::size_t tick : ticks) light += std::pow(sharp_.at(tick).pixels[place], 2);
    return static_cast<int>(std::lround(std::sqrt(light / static_cast<double>(ticks.size()))));
  }

  std::vector<Image> sharp_;  // by tick
};

TEST_F(ExposureTest, APictureIsTheMeanLightOfItsTicks) {
  begin({.time = 0.01, .frames = 10});
  expose();
  bool differs = false;
  for (std::size_t i = 0; i < reading().image->pixels.size(); ++i) {
    ASSERT_EQ(reading().image->pixels[i], mean(i, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9})) << i;
    differs |= reading().image->pixels[i] != sharp_[0].pixels[i];
  }
  EXPECT_TRUE(differs);
  EXPECT_EQ(reading().measured_at, 0.0);
}

TEST_F(ExposureTest, ItsMomentsLieEvenlyInTheExposure) {
  begin({.time = 0.012, .frames = 3});
  expose();
  for (std::size_t i = 0; i < reading().image->pixels.size(); ++i)
    ASSERT_EQ(reading().image->pixels[i], mean(i, {2, 6, 10})) << i;
}

// On paper a tick is drawn once, and counts as often as moments lie in it.
TEST_F(ExposureTest, AnExposureMayHaveMoreMomentsThanTicks) {
  begin({.time = 0.002, .frames = 8});
  expose();
  for (std::size_t i = 0; i < reading().image->pixels.size(); ++i)
    ASSERT_EQ(reading().image->pixels[i], mean(i, {0, 1})) << i;
}

// Row r of 6 shows the tick 12 r / 6.
TEST_F(ExposureTest, RowsBeginOneAfterTheOther) {
  begin({.readout = 0.012});
  expose();
  const std::size_t stride = 8 * 3;
  for (std::size_t i = 0; i < reading().image->pixels.size(); ++i)
    ASSERT_EQ(reading().image->pixels[i], sharp_.at(2 * (i / stride)).pixels[i]) << i;
}

TEST_F(ExposureTest, RowsAreExposedFromTheirBeginningsOn) {
  begin({.time = 0.004, .frames = 2, .readout = 0.012});
  expose();
  const std::size_t stride = 8 * 3;
  for (std::size_t i = 0; i < reading().image->pixels.size(); ++i) {
    const std::size_t row = i / stride;
    ASSERT_EQ(reading().image->pixels[i], mean(i, {2 * row + 1, 2 * row + 3})) << i;
  }
}

TEST_F(ExposureTest, OfAPeriodItEndsBeforeThePictureArrives) {
  begin({.time = 0.02, .frames = 60});
  expose();
  for (std::size_t i = 0; i < reading().image->pixels.size(); ++i)
    ASSERT_EQ(reading().image->pixels[i],
              mean(i, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19}))
        << i;
}

TEST_F(ExposureTest, DepthIsThatOfTheCapture) {
  begin({.time = 0.01}, true);
  expose();
  const DepthImage blurred = *reading().depth;
  begin({}, true);
  expose();
  EXPECT_EQ(blurred.meters, reading().depth->meters);
}

TEST_F(ExposureTest, ASwitchClosesTheShutter) {
  begin({.time = 0.01});
  arrivals(5);
  switch_camera(false);
  switch_camera(true);
  EXPECT_EQ(arrivals(60), (Ticks{26, 46}));
  begin({.time = 0.01});
  arrivals(5);
  vision_->begin_at(20);
  tick_ = 20;
  EXPECT_EQ(arrivals(60), (Ticks{40, 60}));
}

TEST_F(VisionTest, ACameraThatDoesNotRunIsLeftAlone) {
  add_camera("Camera", 30.0);
  auto vision = Vision::create(0.001, {std::make_shared<const Model>(model_)}, {{false}});
  ASSERT_TRUE(vision.ok());
  observation_.bodies.resize(1);
  observation_.bodies[0].links.resize(2);
  observation_.bodies[0].devices.resize(1);
  for (int tick = 0; tick < 70; ++tick) (*vision)->look(tick, observation_);
  EXPECT_EQ(reading().image, nullptr);
  EXPECT_FALSE(reading().fresh);
}

}  // namespace
}  // namespace rehearse
