// Recordings of three ticks, made by hand: a joint, a link, sensors, a controller, pictures; any value can be changed.
#pragma once

#include <gtest/gtest.h>
#include <rehearse/cdr.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/trace.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "picture/picture.h"
#include "support/temporary_folder.h"

namespace rehearse::testing {

inline constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

using test::TemporaryFolder;

/// All values of one tick.
struct SmallTick {
  std::int64_t tick = 0;
  std::uint64_t state_hash = 1;
  std::uint64_t output_hash = 1;
  bool result = true;
  double q = 0.5;                                      // [rad]
  double wheel = 3.0;                                  // [rad], of a joint that may turn without end
  std::array<double, 3> position{10.0, 0.0, 0.7};      // [m]
  std::array<double, 4> rotation{0.0, 0.0, 0.0, 1.0};  // x, y, z, w
  double force = 650.0;                                // [N]
  double input_q = 0.5;                                // [rad], of all joints that are read
  double u = 12.0;                                     // [N·m]
  Image image{4, 2, std::vector<std::uint8_t>(24, 100)};
  std::vector<float> depth{1.0F, 2.0F, 3.0F, 4.0F};
  std::vector<float> ranges{1.0F, std::numeric_limits<float>::infinity(), 2.0F};  // [m]
  std::optional<std::vector<msg::Contact>> contacts = std::nullopt;               // not recorded unless given
  // of the knee [N·m]; not recorded unless given
  std::optional<double> applied = std::nullopt;
  std::vector<double> input_dq = {};  // [rad/s], of the joints that are read; empty: none
};

struct SmallTrace {
  std::vector<SmallTick> ticks{{0}, {1}, {2}};
  /// Makes this number of equal ticks.
  void lengthen(std::int64_t count) {
    while (std::ssize(ticks) < count) ticks.push_back({std::ssize(ticks)});
  }
  std::vector<msg::Event> events;
  std::optional<std::vector<msg::ContactChange>> contact_changes;  // not recorded unless given
  mcap::StringMap limits;                                          // of /Robot/joints
  bool has_helper = false;                                         // a second controller
  std::vector<std::string> left_out;                               // topics
  std::vector<std::string> joint_names{"KNEE", "WHEEL"};
  std::vector<std::string> joints_read{"KNEE"};  // by the controller
  std::string scenario = "rehearse: 1\n";
  mcap::StringMap provenance{{"trace_version", "1"}, {"rehearse", "0.1.0"}};
  mcap::StringMap outcome{{"ticks", "3"}, {"complete", "true"}};

  void write(const std::filesystem::path& file) const;
  Trace load(const std::filesystem::path& file) const {
    write(file);
    auto trace = Trace::load(file);
    EXPECT_TRUE(trace) << to_string(trace.errors());
    return *trace;
  }
};

/// Writes the messages of a SmallTrace.
class SmallWriter {
 public:
  SmallWriter(const SmallTrace& trace, const std::filesystem::path& file)
      : trace_(trace), writer_(*mcap::Writer::create(file)) {}

  template <class T>
  std::uint16_t declare(const std::string& topic, mcap::StringMap metadata = {}) {
    std::uint16_t& channel = channels_[topic];
    if (channel == 0)
      channel = writer_->add_channel(writer_->add_schema(T::type_name, "ros2msg", msg::schema_text<T>()), topic, "cdr",
                                     std::move(metadata));
    return channel;
  }
  template <class T>
  void write(const std::string& topic, std::uint64_t time, const T& message, mcap::StringMap metadata = {}) {
    for (const std::string& left_out : trace_.left_out)
      if (left_out == topic) return;
    const std::uint16_t channel = declare<T>(topic, std::move(metadata));
    CdrWriter cdr;
    msg::encode(message, cdr);
    ASSERT_TRUE(writer_->write(channel, time, time, cdr.bytes()));
  }
  mcap::Writer& file() { return *writer_; }

 private:
  const SmallTrace& trace_;
  std::unique_ptr<mcap::Writer> writer_;
  std::map<std::string, std::uint16_t> channels_;
};

inline void write_tick(SmallWriter& to, const SmallTrace& trace, const SmallTick& tick) {
  const std::uint64_t time = static_cast<std::uint64_t>(tick.tick) * 1'000'000;
  const msg::Header header{msg::Time::from_ns(time), "world"};
  const mcap::StringMap joint_units{
      {"unit:KNEE/q", "rad"}, {"unit:WHEEL/q", "rad"}, {"unit:KNEE/u", "N·m"}, {"wrap:WHEEL/q", "true"}};
  mcap::StringMap of_state = joint_units;
  of_state.insert(trace.limits.begin(), trace.limits.end());
  std::vector<double> efforts;
  if (tick.applied) efforts = {*tick.applied, 0.0};
  to.write("/Robot/joints", time, msg::JointState{header, trace.joint_names, {tick.q, tick.wheel}, {}, efforts},
           of_state);
  to.write("/Robot/BASE/pose", time,
           msg::PoseStamped{header,
                            {{tick.position[0], tick.position[1], tick.position[2]},
                             {tick.rotation[0], tick.rotation[1], tick.rotation[2], tick.rotation[3]}}},
           {{"unit:position", "m"}, {"unit:orientation", "quaternion"}});
  to.write("/Robot/Foot/wrench", time, msg::WrenchStamped{header, {{0.0, 0.0, tick.force}, {}}},
           {{"unit:force", "N"}, {"unit:torque", "N·m"}});
  msg::LaserScan scan;
  scan.ranges = tick.ranges;
  to.write("/Robot/Laser/scan", time, scan, {{"unit:ranges", "m"}});
  msg::CompressedImage image{header, "png", encode_png(tick.image)};
  to.write("/Robot/Eye/image", time, image, {{"unit", "pixels"}});
  msg::Image depth{header, 2, 2, "32FC1", 0, 8, std::vector<std::uint8_t>(16)};
  std::memcpy(depth.data.data(), tick.depth.data(), 16);
  to.write("/Robot/Eye/depth", time, depth, {{"unit", "m"}});
  const std::vector<double> positions(trace.joints_read.size(), tick.input_q);
  to.write("/Robot/Pd/input/joints", time, msg::JointState{header, trace.joints_read, positions, tick.input_dq, {}},
           joint_units);
  if (tick.contacts)
    to.write("/Robot/Pd/input/FOOT/contacts", time, msg::Contacts{header, *tick.contacts},
             {{"unit:position", "m"}, {"unit:force", "N"}, {"unit:depth", "m"}});
  to.write("/Robot/Pd/output/joints", time, msg::JointState{header, {"KNEE"}, {}, {}, {tick.u}}, joint_units);
  std::vector<bool> results{tick.result};
  if (trace.has_helper) {
    to.write("/Robot/Helper/input/joints", time, msg::JointState{header, {"WHEEL"}, {tick.wheel}, {}, {}}, joint_units);
    to.write("/Robot/Helper/output/joints", time, msg::JointState{header, {"WHEEL"}, {}, {}, {1.0}}, joint_units);
    results.push_back(true);
  }
  to.write("/tick", time,
           msg::Tick{header.stamp, tick.tick, tick.state_hash, tick.state_hash, tick.output_hash, results});
}

inline void SmallTrace::write(const std::filesystem::path& file) const {
  SmallWriter writer(*this, file);
  ASSERT_TRUE(writer.file().add_attachment("scenario.yaml", "application/yaml", std::as_bytes(std::span(scenario))));
  ASSERT_TRUE(writer.file().add_metadata("rehearse", provenance));
  std::size_t written = 0;  // events
  const auto write_events = [&](std::int64_t until) {
    for (; written < events.size() && events[written].tick <= until; ++written)
      writer.write("/events", events[written].stamp.to_ns(), events[written]);
  };
  for (const SmallTick& tick : ticks) {
    write_tick(writer, *this, tick);
    write_events(tick.tick);
  }
  if (contact_changes) writer.declare<msg::ContactChange>("/contacts");
  for (const msg::ContactChange& change : contact_changes.value_or(std::vector<msg::ContactChange>()))
    writer.write("/contacts", change.stamp.to_ns(), change);
  write_events(std::numeric_limits<std::int64_t>::max());
  ASSERT_TRUE(writer.file().add_metadata("rehearse.outcome", outcome));
  ASSERT_TRUE(writer.file().close());
}

}  // namespace rehearse::testing
