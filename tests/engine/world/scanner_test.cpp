// The ticks at which range sensors scan and at which their scans arrive.

#include "world/scanner.h"
#include "base/clock.h"

#include <set>

#include "robots.h"

namespace rehearse {
namespace {

using Ticks = std::set<std::int64_t>;

/// A laser that rises at 1 m/s above a floor and looks down at it.
class ScannerTest : public ::testing::Test {
 protected:
  void create(double rate) {
    RangeSensor sensor;
    sensor.scan_rate = rate;
    RobotBuilder robot(JointType::free, inertial(1.0, {0.1, 0.1, 0.1}));
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // -z is down as it is
    robot.add_device("Gyro", 0, Gyro{});
    robot.add_device("Laser", 0, sensor, pose);
    const WorldBody riser = body_of(robot.build(), {0.0, 0.0, 1.0});
    world_ = make_world(weightless(), {riser, floor_body()});
    scanner_ = std::make_unique<Scanner>(*world_, 0.001,
                                         std::vector<std::shared_ptr<const Model>>{riser.model, floor_body().model});
    command_ = idle(*world_);
    command_.bodies[0].external[0].force.z() = 1000.0;
    world_->actuate(command_);
  }

  /// Runs until `last`; the ticks at which there was a new scan.
  Ticks arrivals(std::int64_t last) {
    Ticks ticks;
    for (; tick_ <= last; ++tick_) {
      observation_ = world_->sense();
      scanner_->look(tick_, observation_);
      if (reading().fresh && reading().ranges) ticks.insert(tick_);
      EXPECT_TRUE(world_->step());
    }
    return ticks;
  }

  void switch_laser(bool on) {
    command_.bodies[0].devices[1] = {true, on, {}};
    scanner_->switch_sensors(tick_ - 1, command_);
  }

  const DeviceReading& reading() const { return observation_.bodies[0].devices[1]; }

  std::unique_ptr<World> world_;
  std::unique_ptr<Scanner> scanner_;
  Observation observation_;
  Command command_;
  std::int64_t tick_ = 0;
};

TEST_F(ScannerTest, AScanArrivesAPeriodAfterItWasMade) {
  create(30.0);
  EXPECT_EQ(arrivals(140), (Ticks{34, 67, 100, 134}));
  EXPECT_EQ(reading().measured_at, time_of(100, 0.001));
}

TEST_F(ScannerTest, AScanShowsTheMomentInWhichItWasMade) {
  create(10.0);
  arrivals(99);
  EXPECT_EQ(reading().ranges, nullptr);
  EXPECT_FALSE(reading().fresh);
  arrivals(100);
  EXPECT_NEAR(reading().ranges->at(0), 1.0, 1e-6);  // at tick 0
  arrivals(199);
  EXPECT_FALSE(reading().fresh);
  EXPECT_NEAR(reading().ranges->at(0), 1.0, 1e-6);
  arrivals(200);
  EXPECT_NEAR(reading().ranges->at(0), 1.1, 1e-6);  // at tick 100, a tenth of a second after the push
}

TEST_F(ScannerTest, SwitchedOffItsScanIsTakenAway) {
  create(30.0);
  arrivals(40);
  switch_laser(false);
  arrivals(41);
  EXPECT_TRUE(reading().fresh);
  EXPECT_EQ(reading().ranges, nullptr);
  EXPECT_EQ(arrivals(200), Ticks{});
  switch_laser(true);  // in tick 200
  EXPECT_EQ(arrivals(240), Ticks{235});
}

TEST_F(ScannerTest, SwitchedOffBeforeTheFirstTickItNeverScans) {
  create(30.0);
  switch_laser(false);  // as controllers do in initialize()
  EXPECT_EQ(arrivals(100), Ticks{});
}

TEST_F(ScannerTest, TheWorldsOwnObservationHasNoScans) {
  create(30.0);
  arrivals(50);
  EXPECT_NE(reading().ranges, nullptr);
  EXPECT_EQ(world_->sense().bodies[0].devices[1].ranges, nullptr);
  EXPECT_TRUE(world_->sense().bodies[0].devices[1].values.empty());
  EXPECT_FALSE(world_->sense().bodies[0].devices[1].fresh);
}

}  // namespace
}  // namespace rehearse
