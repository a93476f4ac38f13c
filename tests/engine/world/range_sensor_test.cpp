// Range sensors: the shapes that their beams hit, and the distances.

#include "robots.h"

#include <cmath>
#include <limits>

namespace rehearse {
namespace {

using Eigen::Vector3d;

constexpr float nothing = std::numeric_limits<float>::infinity();

/// A sensor of so many beams between two angles, on one level row [rad].
RangeSensor fan(int samples, double lower, double upper) {
  RangeSensor sensor;
  sensor.yaw = {lower, upper, samples};
  return sensor;
}

/// One beam straight ahead.
RangeSensor pointer(double min_distance = 0.1, double max_distance = 10.0) {
  RangeSensor sensor;
  sensor.min_distance = min_distance;
  sensor.max_distance = max_distance;
  return sensor;
}

/// A device frame that looks along the link's +x with +z up: its left is the link's +y.
Eigen::Isometry3d looking_ahead(const Vector3d& place = Vector3d::Zero()) {
  Eigen::Isometry3d pose = at(place.x(), place.y(), place.z());
  pose.linear() << 0, 0, -1, -1, 0, 0, 0, 1, 0;
  return pose;
}

/// A fixed body without shapes that looks along the world's +x.
WorldBody eye(const RangeSensor& sensor, const Vector3d& place = Vector3d::Zero()) {
  RobotBuilder robot(JointType::fixed);
  robot.add_device("Laser", 0, sensor, looking_ahead());
  WorldBody body = body_of(robot.build(), place);
  body.name = "Eye";
  return body;
}

WorldBody thing(const Geometry& geometry, const Vector3d& position,
                const Eigen::Quaterniond& rotation = Eigen::Quaterniond::Identity()) {
  WorldBody body = body_of(std::make_shared<const Model>(single_shape_model("Thing", geometry, 0.0, {})), position);
  body.fixed = true;
  body.rotation = rotation;
  return body;
}

/// A wall across the x axis, its near face at x = `distance` [m].
WorldBody wall(double distance, double thickness = 0.2) {
  return thing(Box{{thickness, 100.0, 100.0}}, {distance + thickness / 2, 0, 0});
}

std::vector<float> measure(const RangeSensor& sensor, std::vector<WorldBody> things) {
  things.insert(things.begin(), eye(sensor));
  return make_world({}, std::move(things))->measure_ranges(0, 0);
}

float single(const RangeSensor& sensor, std::vector<WorldBody> things) {
  const std::vector<float> ranges = measure(sensor, std::move(things));
  EXPECT_EQ(ranges.size(), 1u);
  return ranges.empty() ? -1.0f : ranges[0];
}

/// Both rounded to float: the same number but for the last digit.
void expect_range(float actual, double expected) { EXPECT_NEAR(actual, expected, 1e-6 * expected); }

/// From the origin along `beam` to a sphere, or to a circle if z is left out: the smaller root of |t beam - c| = r.
double to_sphere(const Vector3d& beam, const Vector3d& center, double radius) {
  const double along = beam.dot(center), a = beam.squaredNorm();
  return (along - std::sqrt(along * along - a * (center.squaredNorm() - radius * radius))) / a;
}

TEST(RangeSensors, MeasureAWallAtItsDistanceOverTheCosine) {
  const RangeSensor sensor = fan(11, -1.0, 1.0);
  const std::vector<float> ranges = measure(sensor, {wall(3.0)});
  ASSERT_EQ(ranges.size(), 11u);
  for (int i = 0; i < 11; ++i) expect_range(ranges[static_cast<std::size_t>(i)], 3.0 / std::cos(-1.0 + 0.2 * i));
}

TEST(RangeSensors, MeasureASphere) {
  const Vector3d center(4.0, 0.3, 0.0);
  const std::vector<float> ranges = measure(fan(5, -0.1, 0.3), {thing(Sphere{1.0}, center)});
  for (int i = 0; i < 5; ++i) {
    const double yaw = -0.1 + 0.1 * i;
    expect_range(ranges[static_cast<std::size_t>(i)], to_sphere({std::cos(yaw), std::sin(yaw), 0.0}, center, 1.0));
  }
}

TEST(RangeSensors, MeasureCylindersAndCapsules) {
  const Vector3d center(4.0, 0.0, 0.0);
  RangeSensor sensor;
  sensor.pitch = {-0.2, 0.2, 5};  // the middle of the side, whose height is 2 m
  for (const Geometry& geometry : {Geometry(Cylinder{0.5, 2.0}), Geometry(Capsule{0.5, 2.0})}) {
    const std::vector<float> ranges = measure(sensor, {thing(geometry, center)});
    ASSERT_EQ(ranges.size(), 5u);
    for (int i = 0; i < 5; ++i) {
      const double pitch = -0.2 + 0.1 * i;
      expect_range(ranges[static_cast<std::size_t>(i)], 3.5 / std::cos(pitch));
    }
  }
  // from above: the flat end of the cylinder, the round end of the capsule
  const Eigen::Quaterniond lying(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY()));
  const RangeSensor aside = fan(3, 0.0, 0.1);
  const std::vector<float> flat = measure(aside, {thing(Cylinder{0.5, 2.0}, center, lying)});
  const std::vector<float> round = measure(aside, {thing(Capsule{0.5, 2.0}, center, lying)});
  for (int i = 0; i < 3; ++i) {
    const double yaw = 0.05 * i;
    const Vector3d beam(std::cos(yaw), std::sin(yaw), 0.0);
    expect_range(flat[static_cast<std::size_t>(i)], 3.0 / std::cos(yaw));
    expect_range(round[static_cast<std::size_t>(i)], to_sphere(beam, center - Vector3d::UnitX(), 0.5));
  }
}

TEST(RangeSensors, MeasureATurnedBox) {
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(M_PI / 4, Vector3d::UnitZ()));
  expect_range(single(pointer(), {thing(Box{{1.0, 1.0, 1.0}}, {4.0, 0.0, 0.0}, turned)}), 4.0 - std::sqrt(0.5));
}

TEST(RangeSensors, BeginWithTheRightMostBeam) {
  const std::vector<float> ranges = measure(fan(3, -0.5, 0.5), {thing(Sphere{0.5}, {2.0, -1.1, 0.0})});  // -y is right
  EXPECT_LT(ranges[0], 2.5f);
  EXPECT_EQ(ranges[1], nothing);
  EXPECT_EQ(ranges[2], nothing);
}

TEST(RangeSensors, BeginWithTheLowestRow) {
  RangeSensor sensor = fan(2, 0.0, 0.5);
  sensor.pitch = {-0.3, 0.3, 3};
  const std::vector<float> ranges = measure(sensor, {thing(Box{{10.0, 10.0, 0.2}}, {0.0, 0.0, -0.6})});
  ASSERT_EQ(ranges.size(), 6u);
  for (int i = 0; i < 2; ++i) expect_range(ranges[static_cast<std::size_t>(i)], 0.5 / std::sin(0.3));
  for (int i = 2; i < 6; ++i) EXPECT_EQ(ranges[static_cast<std::size_t>(i)], nothing) << i;
}

TEST(RangeSensors, TurnAboutTheUprightFirstAndThenUp) {
  RangeSensor sensor = fan(1, 0.7, 0.7);
  sensor.pitch = {0.4, 0.4, 1};
  const Vector3d beam(std::cos(0.4) * std::cos(0.7), std::cos(0.4) * std::sin(0.7), std::sin(0.4));
  expect_range(single(sensor, {thing(Sphere{0.05}, 5.0 * beam)}), 4.95);
}

TEST(RangeSensors, HonourAnglesThatAreNotSymmetric) {
  const RangeSensor sensor = fan(2, 0.2, 0.8);
  expect_range(measure(sensor, {wall(1.0)})[0], 1.0 / std::cos(0.2));
  expect_range(measure(sensor, {wall(1.0)})[1], 1.0 / std::cos(0.8));
}

TEST(RangeSensors, SeeNothingBeyondTheirMaximum) {
  EXPECT_EQ(single(pointer(0.1, 5.0), {wall(5.001)}), nothing);
  expect_range(single(pointer(0.1, 5.0), {wall(4.999)}), 4.999);
  EXPECT_EQ(single(pointer(), {}), nothing);
}

TEST(RangeSensors, LookThroughWhatIsNearerThanTheirMinimum) {
  const std::vector<WorldBody> walls{wall(0.5), wall(3.0)};
  expect_range(single(pointer(0.4), walls), 0.5);
  expect_range(single(pointer(1.0), walls), 3.0);
  EXPECT_EQ(single(pointer(1.0), {wall(0.5)}), nothing);
}

TEST(RangeSensors, LookOutOfAShapeThatHoldsTheirMinimum) {
  const Geometry around[] = {Box{{1.0, 1.0, 1.0}}, Sphere{0.5}, Cylinder{0.5, 1.0}, Capsule{0.5, 1.0}};
  for (const Geometry& geometry : around) {
    expect_range(single(pointer(), {thing(geometry, {0.2, 0.0, 0.1}), wall(3.0)}), 3.0);
    // and see it from outside
    expect_range(single(pointer(), {thing(geometry, {2.0, 0.0, 0.1}), wall(3.0)}),
                 std::holds_alternative<Sphere>(geometry) ? to_sphere({1, 0, 0}, {2.0, 0.0, 0.1}, 0.5) : 1.5);
  }
}

TEST(RangeSensors, MeasureTheNearestOfAll) {
  const WorldBody near = wall(2.0), far = wall(4.0);
  expect_range(single(pointer(), {near, far}), 2.0);
  expect_range(single(pointer(), {far, near}), 2.0);
}

TEST(RangeSensors, DoNotSeeWhatMovesWithThem) {
  RobotBuilder robot(JointType::fixed);
  robot.add("PLATE", 0, JointType::fixed, Vector3d::UnitX(), {}, at(1.0, 0, 0));
  robot.add("FLAP", 0, JointType::revolute, Vector3d::UnitZ(), inertial(1.0, {0.1, 0.1, 0.1}), at(2.0, 0, 0));
  robot.add_collision(0, Sphere{0.5});
  robot.add_collision(1, Sphere{0.2});
  robot.add_collision(2, Sphere{0.3});
  robot.add_device("OnTheWorld", 0, pointer(), looking_ahead());
  robot.add_device("OnTheFlap", 2, pointer(), looking_ahead());
  const auto world = make_world(weightless(), {body_of(robot.build()), wall(5.0)});
  expect_range(world->measure_ranges(0, 0)[0], 1.7);  // its own flap, through its own plate
  expect_range(world->measure_ranges(0, 1)[0], 3.0);
}

TEST(RangeSensors, OnALinkThatMovesSeeTheRestOfTheirBody) {
  RobotBuilder robot(JointType::free, inertial(1.0, {0.1, 0.1, 0.1}));
  robot.add("HEAD", 0, JointType::revolute, Vector3d::UnitZ(), inertial(1.0, {0.1, 0.1, 0.1}));
  robot.add_collision(0, Box{{0.2, 2.0, 0.2}}).pose = at(1.0, 0, 0);
  robot.add_collision(1, Sphere{0.2});
  robot.add_device("Laser", 1, pointer(), looking_ahead());
  WorldBody body = body_of(robot.build(), {3.0, 0.0, 1.0});
  expect_range(make_world(weightless(), {body})->measure_ranges(0, 0)[0], 0.9);
  body.joints = {M_PI};  // the sensor faces backwards
  EXPECT_EQ(make_world(weightless(), {body})->measure_ranges(0, 0)[0], nothing);
}

TEST(RangeSensors, DoNotSeeWhatHasNoCollisionShape) {
  Model ghost = single_shape_model("Ghost", Sphere{0.5}, 0.0, {});
  ghost.links[0].collisions.clear();
  WorldBody body = body_of(std::make_shared<const Model>(ghost), {2.0, 0.0, 0.0});
  body.fixed = true;
  EXPECT_EQ(single(pointer(), {body}), nothing);
}

TEST(RangeSensors, MeasureWhereThingsAreNow) {
  const auto world = make_world(weightless(), {eye(pointer()), free_box("Box", {1.0, 1.0, 1.0}, 1.0, {3.0, 0, 0})});
  expect_range(world->measure_ranges(0, 0)[0], 2.5);
  Command command = idle(*world);
  command.bodies[1].external[0].force.x() = 1000.0;  // during one step: 1 m/s
  world->actuate(command);
  run(*world, 500);
  expect_range(world->measure_ranges(0, 0)[0], 3.0);
}

TEST(RangeSensors, LeaveTheSimulationAlone) {
  const auto make = [] {
    return make_world({},
                      {eye(fan(50, -1.5, 1.5)), free_box("Box", {0.4, 0.4, 0.4}, 1.0, {1.0, 0, 0.4}), floor_body()});
  };
  const auto watched = make(), alone = make();
  for (int tick = 0; tick < 300; ++tick) {
    watched->measure_ranges(0, 0);
    ASSERT_TRUE(watched->step());
    ASSERT_TRUE(alone->step());
  }
  EXPECT_EQ(watched->state_hash(), alone->state_hash());
}

TEST(RangeSensors, MeasureTheSameBitsInARestoredWorld) {
  const auto make = [] {
    return make_world({},
                      {eye(fan(500, -1.5, 1.5)), free_box("Box", {0.4, 0.3, 0.4}, 1.0, {1.0, 0, 0.4}), floor_body()});
  };
  const auto one = make(), two = make();
  run(*one, 321);
  ASSERT_TRUE(two->restore(one->save()).ok());
  EXPECT_EQ(one->measure_ranges(0, 0), two->measure_ranges(0, 0));
}

}  // namespace
}  // namespace rehearse
