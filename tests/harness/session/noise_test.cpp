// Readings of sensors and joints in a run with noise, compared with the same run without noise.
#include "runs.h"

#include "picture/picture.h"

#include <cmath>
#include <numeric>

namespace rehearse {
namespace {

using ::testing::Each;

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation_of(const std::vector<double>& values) {
  const double mean = mean_of(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

class NoisyRuns : public RunTest {
 protected:
  /// Two seconds of the rig at rest.
  Trace run(const std::string& noise, const std::string& more = "cameras: none\n", const std::string& duration = "2") {
    return record_run(rig(behaviour("C", "all"), more, duration) + (noise.empty() ? "" : "noise:\n" + noise));
  }

  std::vector<std::uint64_t> states(const Trace& trace) { return trace.integers("state_hash"); }

  std::vector<std::uint8_t> first_colors(const Trace& trace) {
    const auto payload = trace.payload(*trace.find_channel("/Rig/Camera/image"), 0);
    CdrReader reader(*payload);
    msg::CompressedImage message;
    EXPECT_TRUE(msg::decode(reader, message));
    return decode_png(message.data)->pixels;
  }

  std::vector<float> first_depths(const Trace& trace) {
    const auto payload = trace.payload(*trace.find_channel("/Rig/Camera/depth"), 0);
    CdrReader reader(*payload);
    msg::Image message;
    EXPECT_TRUE(msg::decode(reader, message));
    std::vector<float> depths(message.data.size() / sizeof(float));
    std::memcpy(depths.data(), message.data.data(), message.data.size());
    return depths;
  }
};

TEST_F(NoisyRuns, HaveTheStatedBiasAndDeviation) {
  const Trace trace = run("  - {sensor: Rig/Gyro, angular_velocity: {stddev: 0.02, bias: [0.5, 0, -0.25]}}\n");
  const double at_rest[] = {0.5, 0.0, -0.25};
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values =
        trace.values(std::string("Rig/Gyro/angular_velocity/") + static_cast<char>('x' + axis));
    ASSERT_EQ(values.size(), 2000u);
    EXPECT_NEAR(mean_of(values), at_rest[axis], 4 * 0.02 / std::sqrt(2000.0));
    EXPECT_NEAR(deviation_of(values), 0.02, 4 * 0.02 / std::sqrt(2 * 2000.0));
  }
  EXPECT_EQ(trace.max("Rig/Imu/angular_velocity/x"), 0.0) << "the rule doesn't speak of it";
}

TEST_F(NoisyRuns, HaveNumbersThatDoNotFollowEachOther) {
  const Trace trace = run("  - {sensor: Rig/Gyro, angular_velocity: {stddev: 1}}\n");
  const std::vector<double> x = trace.values("Rig/Gyro/angular_velocity/x");
  const std::vector<double> y = trace.values("Rig/Gyro/angular_velocity/y");
  double lag = 0.0, across = 0.0;
  for (std::size_t i = 1; i < x.size(); ++i) lag += x[i] * x[i - 1], across += x[i] * y[i];
  const double bound = 4 * std::sqrt(static_cast<double>(x.size()));
  EXPECT_LT(std::abs(lag), bound);
  EXPECT_LT(std::abs(across), bound);
}

TEST_F(NoisyRuns, DisturbOnlyWhatIsRead) {
  const std::vector<std::uint64_t> truth = states(run("", "cameras: none\n", "0.1"));
  const Trace noisy =
      run("  - {sensor: Rig/Imu, acceleration: {stddev: 1}, dropout: 0.5}\n"
          "  - {joint: \"Rig/*\", displacement: {stddev: 0.01}}\n",
          "cameras: none\n", "0.1");
  EXPECT_EQ(states(noisy), truth);
}

TEST_F(NoisyRuns, OfOneSensorChangeNoOther) {
  const std::string gyro = "  - {sensor: Rig/Gyro, angular_velocity: {stddev: 0.02}}\n";
  const std::string imu = "  - {sensor: Rig/Imu, angular_velocity: {stddev: 0.02}, dropout: 0.3}\n";
  const std::string x = "Rig/Gyro/angular_velocity/x";
  const std::vector<double> alone = run(gyro, "cameras: none\n", "0.1").values(x);
  EXPECT_EQ(run(imu + gyro, "cameras: none\n", "0.1").values(x), alone);
  EXPECT_NE(run(imu + gyro, "cameras: none\n", "0.1").values("Rig/Imu/angular_velocity/x"), alone);
  std::string more_sensors = rig_urdf;
  more_sensors.replace(more_sensors.find("<sensor name=\"Accelerometer\""), 0,
                       "<sensor name=\"Another\" type=\"gyroscope\"/>");
  write("rig.urdf", more_sensors);
  EXPECT_EQ(
      run("  - {sensor: Rig/Another, angular_velocity: {stddev: 1}}\n" + gyro, "cameras: none\n", "0.1").values(x),
      alone);
}

TEST_F(NoisyRuns, AreTheSameForASeedAndOthersForAnother) {
  const std::string noise = "  - {sensor: Rig/Gyro, angular_velocity: {stddev: 0.02}}\n";
  const std::string x = "Rig/Gyro/angular_velocity/x";
  const std::vector<double> once = run(noise, "cameras: none\nseed: 3\n", "0.1").values(x);
  const std::string bytes_of_it = bytes("run.mcap");
  run(noise, "cameras: none\nseed: 3\n", "0.1");
  EXPECT_EQ(bytes("run.mcap"), bytes_of_it);
  EXPECT_NE(run(noise, "cameras: none\nseed: 4\n", "0.1").values(x), once);
}

TEST_F(NoisyRuns, LoseTheStatedShareOfReadings) {
  const Trace trace = run("  - {sensor: Rig/Force, dropout: 0.25}\n");
  const double expected = 0.75 * 2000, deviation = std::sqrt(2000 * 0.25 * 0.75);
  EXPECT_NEAR(static_cast<double>(trace.find_channel("/Rig/Force/wrench")->messages()), expected, 4 * deviation);
  EXPECT_EQ(trace.find_channel("/Rig/Gyro/imu")->messages(), 2000u);
}

TEST_F(NoisyRuns, LetJointsBeReadWrongAndRecordedRight) {
  const Trace trace = run("  - {joint: Rig/RAIL, displacement: {stddev: 0.001, bias: 0.1}, velocity: {bias: 2}}\n");
  EXPECT_EQ(trace.max("Rig/RAIL/q"), 0.25);
  EXPECT_EQ(trace.min("Rig/RAIL/q"), 0.25);
  const Trace driven =
      record_run(rig(behaviour("C", "defaults effort"), "cameras: none\n", "0.5") +
                 "noise:\n  - {joint: Rig/SHOULDER, displacement: {stddev: 0.001, bias: 0.1}, velocity: {bias: 2}}\n");
  const std::vector<double> read = driven.values("Rig/C/input/SHOULDER/q");
  EXPECT_NEAR(mean_of(read), 0.1, 4 * 0.001 / std::sqrt(500.0));
  EXPECT_NEAR(deviation_of(read), 0.001, 0.0002);
  EXPECT_EQ(driven.max("Rig/SHOULDER/q"), 0.0);
}

TEST_F(NoisyRuns, ReplayWithTheJointsAsTheyWereRead) {
  const Trace trace = record_run(
      "rehearse: 1\nduration: 0.2\ncameras: none\nbodies:\n  - name: Rig\n    model: rig.urdf\n"
      "    controllers: [{name: C, library: HingePd}]\n"
      "noise:\n  - {joint: Rig/SHOULDER, displacement: {stddev: 0.01}}\n");
  EXPECT_GT(deviation_of(trace.values("Rig/C/output/SHOULDER/u")), 0.1) << "the controller acts on what it reads";
  EXPECT_EQ(trace.values("Rig/C/input/SHOULDER/q").at(7), trace.values("Rig/measured_joints/SHOULDER/q").at(7));
  const auto report = replay_run();
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_TRUE(report->equal()) << (report->first ? to_string(*report->first) : to_string(*report->failure));
}

TEST_F(NoisyRuns, ReplayWithTheSameReadings) {
  run("  - {sensor: \"Rig/*\", angular_velocity: {stddev: 0.1}, acceleration: {stddev: 0.1}, force: {bias: 1},\n"
      "     color: {stddev: 3}, depth: {stddev: 0.01}, dropout: 0.2}\n"
      "  - {joint: \"Rig/*\", displacement: {stddev: 0.01}}\n",
      "", "0.1");
  const auto report = replay_run();
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_TRUE(report->equal()) << (report->first ? to_string(*report->first) : to_string(*report->failure));
}

TEST_F(NoisyRuns, DisturbColorsWithinTheirRange) {
  const std::vector<std::uint8_t> truth = first_colors(run("", "", "0.02"));
  const std::vector<std::uint8_t> noisy =
      first_colors(run("  - {sensor: Rig/Camera, color: {stddev: 3, bias: 10}}\n", "", "0.02"));
  ASSERT_EQ(noisy.size(), truth.size());
  std::vector<double> differences;
  for (std::size_t i = 0; i < truth.size(); ++i) differences.push_back(noisy[i] - truth[i]);
  EXPECT_NEAR(mean_of(differences), 10.0, 4 * 3 / std::sqrt(static_cast<double>(truth.size())));
  EXPECT_NEAR(deviation_of(differences), 3.0, 0.5);
  EXPECT_THAT(first_colors(run("  - {sensor: Rig/Camera, color: {bias: 1000}}\n", "", "0.02")), Each(255));
}

TEST_F(NoisyRuns, LoseDepthsPixelByPixel) {
  const std::string wall = "  - {name: Wall, box: {size: [40, 0.2, 40]}, fixed: true, position: [0.25, -3, 1]}\n";
  const std::string before = rig(behaviour("C", "all"), "", "0.02") + wall;
  const auto depths = [&](const std::string& noise) { return first_depths(record_run(before + noise)); };
  const std::vector<float> truth = depths("");
  const std::vector<float> noisy = depths("noise:\n  - {sensor: Rig/Camera, depth: {stddev: 0.05}, dropout: 0.3}\n");
  std::vector<double> differences;
  std::size_t found = 0, lost = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (!std::isfinite(truth[i])) {
      EXPECT_FALSE(std::isfinite(noisy[i]));
      continue;
    }
    ++found;
    if (!std::isfinite(noisy[i])) ++lost;
    if (std::isfinite(noisy[i])) differences.push_back(noisy[i] - truth[i]);
  }
  ASSERT_GT(found, 100u);
  EXPECT_NEAR(static_cast<double>(lost), 0.3 * static_cast<double>(found),
              4 * std::sqrt(0.3 * 0.7 * static_cast<double>(found)));
  EXPECT_NEAR(deviation_of(differences), 0.05, 0.02);
}

TEST_F(NoisyRuns, KeepACaptureAsItWasRead) {
  const Trace trace =
      run("  - {sensor: Rig/Camera, color: {stddev: 3}, depth: {stddev: 0.1}, dropout: 0.5}\n", "", "0.1");
  const std::size_t arrived = trace.find_channel("/Rig/Camera/image")->messages();
  EXPECT_EQ(arrived, trace.find_channel("/Rig/Camera/depth")->messages());
  EXPECT_EQ(arrived, 20u) << "a camera that measures depth loses pixels, not pictures";
}

}  // namespace
}  // namespace rehearse
