// Errors of sensors against their closed forms, without a world: true readings of a wheel are given by hand. Then
// errors in the loop: what a recording has of them, replays and branches.
#include "core/simulation/sensor_errors.h"
#include "runs.h"

#include <Eigen/Geometry>

#include <cmath>
#include <functional>
#include <numbers>

namespace rehearse {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double tick = 0.001;  // [s]

class ErrorsOfSensors : public RunTest {
 protected:
  static std::string text_of(const std::string& rules, const std::string& more = "cameras: none\n") {
    return rig(behaviour("C", "all"), more, "10") + (rules.empty() ? "" : "noise:\n" + rules);
  }

  /// What the controllers read, tick by tick, if the truth of the gyro's x is `truth`, a function of the tick. NaN: no
  /// new reading.
  std::vector<Vector3d> gyro(const std::string& errors, int ticks, const std::function<Vector3d(int)>& truth,
                             const std::string& more = "cameras: none\n") const {
    const Scenario scenario = load(text_of("  - {sensor: Rig/Gyro, " + errors + "}\n", more));
    SensorErrors stage(scenario);
    const int index = scenario.bodies[0].model->find_device("Gyro");
    Observation seen = blank(scenario);
    DeviceReading& reading = seen.bodies[0].devices[static_cast<std::size_t>(index)];
    std::vector<Vector3d> read;
    for (int i = 0; i < ticks; ++i) {
      const Vector3d now = truth(i);
      reading.values = {now.x(), now.y(), now.z()};
      reading.fresh = true;
      stage.disturb_devices(i, seen);
      read.emplace_back(reading.fresh ? Vector3d(reading.values[0], reading.values[1], reading.values[2])
                                      : Vector3d::Constant(std::nan("")));
    }
    return read;
  }

  /// The displacements that are read of joint SHOULDER.
  std::vector<double> shoulder(const std::string& errors, int ticks, const std::function<double(int)>& truth) const {
    const Scenario scenario = load(text_of("  - {joint: Rig/SHOULDER, " + errors + "}\n"));
    SensorErrors stage(scenario);
    Observation seen = blank(scenario);
    std::vector<double> read;
    for (int i = 0; i < ticks; ++i) {
      seen.bodies[0].joints[0].q = truth(i);
      stage.disturb_joints(i, seen);
      read.push_back(seen.bodies[0].joints[0].q);
    }
    return read;
  }

  static Observation blank(const Scenario& scenario) {
    Observation seen;
    for (const ScenarioBody& body : scenario.bodies) {
      BodyObservation& of = seen.bodies.emplace_back();
      of.joints.resize(body.model->joints.size());
      for (const Device& device : body.model->devices)
        of.devices.emplace_back().values.assign(static_cast<std::size_t>(value_count(device)), 0.0);
    }
    return seen;
  }
};

Vector3d ramp(int i) { return {1.0 * i, 0.0, 0.0}; }
Vector3d nothing(int) { return Vector3d::Zero(); }

TEST_F(ErrorsOfSensors, ALatencyIsADeadTime) {
  for (const auto& [latency, ticks] : {std::pair("5 ms", 5), std::pair("4.2 ms", 5), std::pair("0.0", 0)}) {
    SCOPED_TRACE(latency);
    const auto read = gyro("latency: " + std::string(latency) + ", angular_velocity: {scale: 2}", 50, ramp);
    for (int i = 0; i < 50; ++i) {
      if (i < ticks) {
        EXPECT_TRUE(std::isnan(read[static_cast<std::size_t>(i)].x())) << i;
      } else {
        EXPECT_EQ(read[static_cast<std::size_t>(i)].x(), 2.0 * (i - ticks)) << i;
      }
    }
  }
}

TEST_F(ErrorsOfSensors, AJointReadsItsFirstSampleUntilTheNextArrives) {
  const auto read = shoulder("latency: 3 ms", 10, [](int i) { return 0.5 + i; });
  EXPECT_THAT(read, ElementsAre(0.5, 0.5, 0.5, 0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5));
}

TEST_F(ErrorsOfSensors, JitterSpreadsTheLatencyAndKeepsTheOrder) {
  const auto read = gyro("latency: 5 ms, jitter: 3 ms", 100000, ramp);
  double sum = 0.0, count = 0.0, last = -1.0;
  for (std::size_t i = 0; i < read.size(); ++i) {
    if (std::isnan(read[i].x())) continue;
    EXPECT_GT(read[i].x(), last);
    last = read[i].x();
    const double age = static_cast<double>(i) - last;
    EXPECT_GE(age, 2.0);
    EXPECT_LE(age, 8.0);
    sum += age, ++count;
  }
  EXPECT_LT(sum / count, 5.0) << "of samples that overtake each other the newest counts";
}

TEST_F(ErrorsOfSensors, ARateTakesSamplesFromItsPhaseOn) {
  const auto read = gyro("rate: 100 Hz, phase: 3 ms", 100, ramp);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(!std::isnan(read[static_cast<std::size_t>(i)].x()), i % 10 == 3) << i;
  const auto held = shoulder("rate: 200 Hz", 20, [](int i) { return 1.0 * i; });
  for (int i = 0; i < 20; ++i) EXPECT_EQ(held[static_cast<std::size_t>(i)], i / 5 * 5) << i;
}

// D. W. Allan, Statistics of Atomic Frequency Standards, Proceedings of the IEEE 54 (1966): for white noise of the
// density N and a walk K, sigma²(tau) = N² / tau + K² tau / 3.
TEST_F(ErrorsOfSensors, AnHourOfAnImuHasTheAllanDeviationOfItsDataSheet) {
  constexpr double density = 0.01, walk = 0.005, hertz = 100.0;  // [deg/s/sqrt(Hz)], [deg/s/sqrt(s)]
  const auto read = gyro("angular_velocity: {density: 0.01 deg/s/sqrt(Hz), bias_walk: 0.005 deg/s/sqrt(s), bias: 0.3}",
                         360000, nothing, "cameras: none\ntime_step: 0.01\n");
  std::cout << "tau [s]   measured   on paper [deg/s]\n";
  for (const double tau : {0.1, 1.0, 10.0, 60.0}) {
    const auto samples = static_cast<std::size_t>(tau * hertz);
    const std::size_t clusters = read.size() / samples;
    double variance = 0.0;
    Vector3d before = Vector3d::Zero();
    for (std::size_t c = 0; c < clusters; ++c) {
      Vector3d mean = Vector3d::Zero();
      for (std::size_t i = 0; i < samples; ++i) mean += read[c * samples + i];
      mean /= static_cast<double>(samples);
      if (c > 0) variance += (mean - before).squaredNorm() / 6.0;
      before = mean;
    }
    const double measured = std::sqrt(variance / static_cast<double>(clusters - 1)) * 180.0 / std::numbers::pi;
    const double paper = std::sqrt(density * density / tau + walk * walk * tau / 3.0);
    std::cout << tau << "   " << measured << "   " << paper << "\n";
    EXPECT_NEAR(measured / paper, 1.0, 4.0 / std::sqrt(2.0 * 3.0 * static_cast<double>(clusters - 1)) + 0.01) << tau;
  }
}

TEST_F(ErrorsOfSensors, BurstsHaveTheStatedMeanAndShare) {
  const auto read = gyro("dropout: 0.1, burst: 50 ms", 1000000, nothing);
  double lost = 0.0, gaps = 0.0;
  bool was_lost = false;
  for (const Vector3d& each : read) {
    const bool is_lost = std::isnan(each.x());
    if (is_lost) ++lost;
    if (is_lost && !was_lost) ++gaps;
    was_lost = is_lost;
  }
  std::cout << "mean gap " << lost / gaps << " ms, share " << lost / 1e6 << "\n";
  EXPECT_NEAR(lost / gaps, 50.0, 50.0 * 4.0 / std::sqrt(gaps));
  EXPECT_NEAR(lost / 1e6, 0.1, 0.013);
}

TEST_F(ErrorsOfSensors, AQuantumHasTheVarianceOfRounding) {
  constexpr double quantum = 0.02;
  const auto truth = [](int i) { return Vector3d(0.0137 * i * std::numbers::sqrt2, 0.0, 0.0); };
  const auto read = gyro("angular_velocity: {quantum: 0.02}", 100000, truth);
  double sum = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const double difference = read[static_cast<std::size_t>(i)].x() - truth(i).x();
    EXPECT_LE(std::abs(difference), quantum / 2.0 + 1e-9);
    sum += difference * difference;
  }
  EXPECT_NEAR(sum / 100000 / (quantum * quantum / 12.0), 1.0, 0.005);
}

// Of a color v the variance is shot² v, and 1/12 by the rounding to whole numbers.
TEST_F(ErrorsOfSensors, ShotNoiseGrowsWithTheRootOfTheColor) {
  const Scenario scenario =
      load(rig(behaviour("C", "all"), "cameras: all\n") + "noise:\n  - {sensor: Rig/Camera, color: {shot: 0.5}}\n");
  SensorErrors stage(scenario);
  const auto camera = static_cast<std::size_t>(scenario.bodies[0].model->find_device("Camera"));
  for (const int color : {0, 16, 64, 144}) {
    SCOPED_TRACE(color);
    Observation seen = blank(scenario);
    DeviceReading& reading = seen.bodies[0].devices[camera];
    auto image = std::make_shared<Image>();
    image->width = image->height = 200;
    image->pixels.assign(std::size_t{3} * 200 * 200, static_cast<std::uint8_t>(color));
    reading.image = image;
    reading.fresh = true;
    stage.disturb_devices(color, seen);
    double sum = 0.0, squares = 0.0;
    for (const std::uint8_t pixel : reading.image->pixels) {
      sum += pixel - color;
      squares += (pixel - color) * (pixel - color);
    }
    const auto count = static_cast<double>(reading.image->pixels.size());
    EXPECT_NEAR(sum / count, 0.0, 0.1);
    EXPECT_NEAR(squares / count, color == 0 ? 0.0 : 0.25 * color + 1.0 / 12.0, 0.03 * 0.25 * color);
  }
}

TEST_F(ErrorsOfSensors, AnEncoderCountsFromItsIndex) {
  const double count = 2.0 * std::numbers::pi / 1000.0;
  const auto read = shoulder("displacement: {counts: 1000}", 50, [&](int i) { return (i - 20 + 0.5) * count / 3.0; });
  for (int i = 0; i < 50; ++i)
    EXPECT_NEAR(read[static_cast<std::size_t>(i)], std::floor((i - 20 + 0.5) / 3.0) * count, 1e-12);
  const auto off = shoulder("displacement: {index_error: 2 deg}", 50, [](int) { return 1.0; });
  EXPECT_NE(off[0], 1.0);
  EXPECT_LT(std::abs(off[0] - 1.0), 2.0 * std::numbers::pi / 180.0);
  for (const double each : off) EXPECT_EQ(each, off[0]);
}

TEST_F(ErrorsOfSensors, AxesAreScaledTurnedAndMixed) {
  const auto vector = [](int) { return Vector3d(1.0, 2.0, 3.0); };
  const auto of = [&](const std::string& errors) { return gyro("angular_velocity: {" + errors + "}", 1, vector)[0]; };
  EXPECT_EQ(of("scale: [2, 1, -1]"), Vector3d(2.0, 2.0, -3.0));
  EXPECT_EQ(of("cross_axis: 10 %"), Vector3d(1.5, 2.4, 3.3));
  EXPECT_EQ(of("saturation: 2.5"), Vector3d(1.0, 2.0, 2.5));
  const Eigen::Matrix3d turned =
      (Eigen::AngleAxisd(0.3, Vector3d::UnitZ()) * Eigen::AngleAxisd(-0.2, Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.1, Vector3d::UnitX()))
          .toRotationMatrix();
  EXPECT_LT((of("misalignment: [0.1, -0.2, 0.3]") - turned.transpose() * vector(0)).norm(), 1e-15);
}

TEST_F(ErrorsOfSensors, AnOffsetAndAStuckSensorLastFromTheirBeginningToTheirEnd) {
  const auto read = gyro(
      "angular_velocity: {offset: {by: [0.5, 0, 0], from: 10 ms, until: 20 ms}}, stuck: {from: 30 ms, until: 40 ms}",
      60, ramp);
  for (int i = 0; i < 60; ++i) {
    const double expected = i >= 10 && i < 20 ? i + 0.5 : i >= 30 && i < 40 ? 29.0 : i;
    EXPECT_EQ(read[static_cast<std::size_t>(i)].x(), expected) << i;
  }
}

class ErrorsInTheLoop : public RunTest {
 protected:
  /// The errors of the joint move it, because the controller acts on what it reads.
  static std::string of(const std::string& rules) {
    return rig("{name: C, library: HingePd}", "cameras: none\n", "0.4") + rules;
  }
};

const std::string joint_errors =
    "  - {joint: Rig/SHOULDER, latency: 4 ms, jitter: 4 ms, dropout: 0.1, displacement: {counts: 500, stddev: 0.02}}\n";
const std::string all_errors =
    "noise:\n"
    "  - {sensor: Rig/Gyro, latency: 5 ms, jitter: 2 ms, rate: 250 Hz, dropout: 0.2, burst: 12 ms,\n"
    "     angular_velocity: {density: 0.01, bias_walk: 0.1, scale: 1.01, quantum: 0.001}}\n" +
    joint_errors;

TEST_F(ErrorsInTheLoop, TheTruthIsRecordedBesideTheReading) {
  const Trace trace = record_run(of(all_errors));
  const Trace other = record_run(of("noise:\n" + joint_errors));
  std::vector<double> truth = trace.values("Rig/Gyro/truth/angular_velocity/y");
  truth.erase(truth.begin());  // before the first step there is no reading
  EXPECT_EQ(truth, other.values("Rig/Gyro/angular_velocity/y"));
  EXPECT_GT(trace.max("Rig/Gyro/truth/angular_velocity/y"), 0.0);
  EXPECT_LT(trace.values("Rig/Gyro/angular_velocity/y").size(), 100u) << "a rate of 250 Hz, and gaps";
  EXPECT_NE(trace.values("Rig/measured_joints/SHOULDER/q"), trace.values("Rig/SHOULDER/q"));
}

TEST_F(ErrorsInTheLoop, NoiseAloneHasNoChannelOfTheTruth) {
  const Trace trace =
      record_run(of("noise: [{sensor: Rig/Gyro, angular_velocity: {stddev: 0.1, bias: 1}, dropout: 0.1}]\n"));
  EXPECT_THAT(topics(trace, "/Rig/Gyro/truth"), IsEmpty());
}

TEST_F(ErrorsInTheLoop, OfOneSensorChangeNoOther) {
  const std::string x = "Rig/Imu/angular_velocity/x";
  const std::string imu =
      "  - {sensor: Rig/Imu, latency: 5 ms, jitter: 3 ms, dropout: 0.2, burst: 20 ms, angular_velocity: {bias_walk: "
      "1}}\n";
  const auto alone = record_run(of("noise:\n" + imu)).values(x);
  const auto beside = record_run(of("noise:\n  - {sensor: Rig/Gyro, latency: 9 ms, jitter: 9 ms, dropout: 0.3, burst: "
                                    "9 ms, angular_velocity: {density: 1}}\n" +
                                    imu))
                          .values(x);
  EXPECT_EQ(beside, alone);
  EXPECT_NE(record_run("seed: 7\n" + of("noise:\n" + imu)).values(x), alone);
}

TEST_F(ErrorsInTheLoop, AReplayAndABranchContinueTheReadingsUnderWay) {
  record_run(of(all_errors));
  const auto replayed = replay_run();
  ASSERT_TRUE(replayed.ok()) << to_string(replayed.errors());
  EXPECT_TRUE(replayed->equal());
  BranchPoint point;
  point.trace = path("run.mcap").string();
  point.tick = 250;
  const auto branched = record_branch(point, path("branch.mcap"), {});
  ASSERT_TRUE(branched.ok()) << to_string(branched.errors());
  const auto one = Trace::load(path("run.mcap")), other = Trace::load(path("branch.mcap"));
  ASSERT_TRUE(one.ok() && other.ok());
  EXPECT_EQ(one->values("Rig/measured_joints/SHOULDER/q"), other->values("Rig/measured_joints/SHOULDER/q"));
  EXPECT_EQ(one->values("Rig/Gyro/angular_velocity/y"), other->values("Rig/Gyro/angular_velocity/y"));
  EXPECT_EQ(one->values("Rig/SHOULDER/q"), other->values("Rig/SHOULDER/q"));
}

// The child commands an effort of 1, 2, 3 ... N·m, tick by tick.
TEST_F(ErrorsInTheLoop, LostCommandsOfAChildLeaveTheLastOnesInForce) {
  record_run(rig("{name: P, library: Behaviours, delay: false, options: \"drive velocity 1 RAIL\", children: [" +
                     behaviour("Child", "stale") + "]}",
                 "cameras: none\n", "0.05") +
             "    faults: [{controller: Child, fault: lost, from: 10 ms, until: 20 ms}]\n");
  const auto run = Trace::load(path("run.mcap"));
  ASSERT_TRUE(run.ok());
  const auto written = run->values("Rig/Child/output/SHOULDER/u"), acted = run->values("Rig/SHOULDER/u");
  for (std::size_t i = 1; i < 50; ++i) {  // the effort of the step before
    EXPECT_EQ(written.at(i), static_cast<double>(i + 1));
    EXPECT_EQ(acted.at(i), i > 10 && i <= 20 ? 10.0 : static_cast<double>(i)) << i;
  }
  EXPECT_GT(run->values("Rig/RAIL/q").at(30), 0.0);
  const auto replayed = replay_run();
  ASSERT_TRUE(replayed.ok()) << to_string(replayed.errors());
  EXPECT_TRUE(replayed->equal());
  BranchPoint point;  // the recorded commands move the world up to it
  point.trace = path("run.mcap").string();
  point.tick = 15;
  const auto branched = record_branch(point, path("branch.mcap"), {});
  ASSERT_TRUE(branched.ok()) << to_string(branched.errors());
  const auto branch = Trace::load(path("branch.mcap"));
  ASSERT_TRUE(branch.ok());
  EXPECT_EQ(branch->integers("state_hash"), run->integers("state_hash"));
}

TEST_F(ErrorsInTheLoop, FaultsLastFromTheirBeginningToTheirEnd) {
  const std::string rigged =
      rig(behaviour("C", "drive effort 3 SHOULDER", ", delay: false"), "cameras: none\n", "0.05");
  const auto faulty = [&](const std::string& fault) { return record_run(rigged + "    faults: [" + fault + "]\n"); };
  const auto dead = faulty("{actuator: SHOULDER, fault: dead, from: 10 ms, until: 20 ms}").values("Rig/SHOULDER/u");
  const auto weak = faulty("{actuator: SHOULDER, fault: weak, effort: 0.4, from: 10 ms}").values("Rig/SHOULDER/u");
  for (std::size_t i = 2; i < 50; ++i) {  // the effort of the step before
    EXPECT_EQ(dead.at(i), i > 10 && i <= 20 ? 0.0 : 3.0) << i;
    EXPECT_EQ(weak.at(i), i > 10 ? 0.4 * 3.0 : 3.0) << i;
  }
  const auto moved =
      faulty("{link: ARM, fault: heavier, mass: 4, from: 10 ms, until: 20 ms}").values("Rig/SHOULDER/dq");
  for (std::size_t i = 2; i < 50; ++i)  // 3 N·m turn 0.5 kg·m²
    EXPECT_NEAR(moved.at(i) - moved.at(i - 1), i > 10 && i <= 20 ? 0.0015 : 0.006, 1e-9) << i;
  const Trace lost = faulty("{sensor: Gyro, fault: lost, from: 10 ms, until: 20 ms}");
  EXPECT_EQ(lost.find_channel("/Rig/Gyro/imu")->messages(), 40u);
  const Trace late = faulty("{encoder: SHOULDER, fault: delayed, by: 3 ms, from: 20 ms}");
  EXPECT_EQ(late.values("Rig/measured_joints/SHOULDER/q").at(40), late.values("Rig/SHOULDER/q").at(37));
  EXPECT_EQ(late.values("Rig/measured_joints/SHOULDER/q").at(15), late.values("Rig/SHOULDER/q").at(15));
}

}  // namespace
}  // namespace rehearse
