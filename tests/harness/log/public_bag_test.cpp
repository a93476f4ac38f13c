// A bag of ROS 2 that others recorded: cmake -DREHEARSE_PUBLIC_BAG=DIR, where DIR is a folder of rosbag2 with the
// velocities that a person sent to turtlesim, geometry_msgs/msg/Twist on /turtle1/cmd_vel in a database. Its messages
// are read here a second time, by SQLite and their known layout alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/gtest.h>
#include <rehearse/logs.h>
#include <rehearse/replay.h>
#include <rehearse/trace.h>
#include <rehearse/urdf.h>
#include <sqlite3.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "logs/map/map_draft.h"
#include "logs/robot_log/log_replay.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const bool bags_are_read = (read_rosbag2_logs(), true);

struct Velocity {
  std::int64_t time = 0;  // [ns]
  double linear_x = 0.0, angular_z = 0.0;
};

std::vector<Velocity> velocities_in(const fs::path& database) {
  std::vector<Velocity> velocities;
  sqlite3* opened = nullptr;
  sqlite3_stmt* rows = nullptr;
  EXPECT_EQ(sqlite3_open_v2(database.c_str(), &opened, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
  EXPECT_EQ(sqlite3_prepare_v2(opened, "SELECT timestamp, data FROM messages ORDER BY timestamp", -1, &rows, nullptr),
            SQLITE_OK);
  while (sqlite3_step(rows) == SQLITE_ROW) {
    constexpr int header = 4, twist = header + 6 * static_cast<int>(sizeof(double));
    EXPECT_GE(sqlite3_column_bytes(rows, 1), twist);
    const auto* payload = static_cast<const char*>(sqlite3_column_blob(rows, 1));
    Velocity& read = velocities.emplace_back();
    read.time = sqlite3_column_int64(rows, 0);
    std::memcpy(&read.linear_x, payload + header, sizeof(double));
    std::memcpy(&read.angular_z, payload + twist - sizeof(double), sizeof(double));
  }
  sqlite3_finalize(rows);
  sqlite3_close(opened);
  return velocities;
}

class PublicBag : public ::testing::Test {
 protected:
  void SetUp() override {
    if (bag_.empty()) GTEST_SKIP() << "there is no bag: -DREHEARSE_PUBLIC_BAG=DIR";
    setenv("REHEARSE_CONTROLLER_PATH", TEST_CONTROLLERS, 1);
  }

  const fs::path bag_ = PUBLIC_BAG;
  const fs::path model_ = fs::path(FIXTURES_DIR) / "models/scout.urdf";
  const test::TemporaryFolder folder_;
};

TEST_F(PublicBag, DrivesARobot) {
  const auto log = mcap::Reader::open(bag_);
  ASSERT_TRUE(log.ok()) << to_string(log.errors());
  const auto model = load_urdf(model_);
  ASSERT_TRUE(model.ok()) << to_string(model.errors());
  const auto map = draft_map(**log, *model);
  ASSERT_TRUE(map.ok()) << to_string(map.errors());
  EXPECT_THAT(*map, HasSubstr("joystick: /turtle1/cmd_vel    # unsure"));
  LogReplayOptions options;
  options.controller = "TwistDriver";
  options.model = model_;
  options.map = folder_ / "map.yaml";
  std::ofstream(options.map) << *map;
  const auto report = replay_log(bag_, folder_ / "run.mcap", options);
  ASSERT_TRUE(report.ok()) << to_string(report.errors());

  fs::path database;
  for (const auto& entry : fs::directory_iterator(bag_))
    if (entry.path().extension() == ".db3") database = entry.path();
  const std::vector<Velocity> sent = velocities_in(database);
  ASSERT_GT(sent.size(), 100u);
  EXPECT_EQ(report->start, sent.front().time);
  EXPECT_NEAR(report->duration, static_cast<double>(sent.back().time - sent.front().time) * 1e-9, 2 * 0.001);
  ASSERT_EQ(report->topics.size(), 1u);
  EXPECT_EQ(report->topics[0].messages, static_cast<std::int64_t>(sent.size()));

  const auto run = Trace::load(folder_ / "run.mcap");
  ASSERT_TRUE(run.ok()) << to_string(run.errors());
  bool turned = false;
  std::size_t latest = 0;
  for (std::int64_t tick = 0; tick < report->ticks; ++tick) {
    const std::int64_t now = report->start + tick * 1'000'000;
    while (latest + 1 < sent.size() && sent[latest + 1].time <= now) ++latest;
    ASSERT_EQ(run->at("Scout/TwistDriver/output/LEFT_WHEEL/dq", static_cast<double>(tick) * 0.001),
              sent[latest].linear_x - 0.25 * sent[latest].angular_z)
        << tick;
    turned = turned || sent[latest].angular_z != 0.0;
  }
  EXPECT_TRUE(turned);
  const auto again = replay(folder_ / "run.mcap");
  ASSERT_TRUE(again.ok()) << to_string(again.errors());
  EXPECT_TRUE(again->equal());
}

}  // namespace
}  // namespace rehearse
