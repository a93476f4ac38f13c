// Contacts in the closed loop: the controllers' inputs, the recording, and the replay without physics.

#include <rehearse/cdr.h>
#include <rehearse/compare.h>
#include <rehearse/mcap.h>
#include <rehearse/session.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "runs.h"

namespace rehearse {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A foot with an arm on it (joint SHOULDER), 5 kg in all, which falls by 1 mm within 14 ticks, and then lies still.
constexpr const char* foot_urdf = R"(<?xml version="1.0"?>
<robot name="Rig">
  <link name="FOOT">
    <inertial><mass value="4"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
    <collision><geometry><box size="0.4 0.2 0.1"/></geometry></collision>
  </link>
  <joint name="SHOULDER" type="continuous">
    <parent link="FOOT"/><child link="ARM"/><axis xyz="0 0 1"/>
  </joint>
  <link name="ARM">
    <inertial><mass value="1"/><inertia ixx="0.5" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="0.5"/></inertial>
  </link>
</robot>
)";

class ContactRuns : public RunTest {
 protected:
  ContactRuns() { write("rig.urdf", foot_urdf); }

  static std::string falling_foot(const std::string& controllers, const std::string& duration = "0.3") {
    return "rehearse: 1\nduration: " + duration +
           "\nbodies:\n  - name: Rig\n    model: rig.urdf\n    position: [0, 0, 0.051]\n    controllers: [" +
           controllers + "]\n  - {name: Floor, box: {size: [20, 20, 0.2]}, fixed: true, position: [0, 0, -0.1]}\n";
  }

  /// The scenario with a ContactSensor in the foot.
  Scenario with_sensor(const std::string& text) const {
    Scenario scenario = load(text);
    auto model = std::make_shared<Model>(*scenario.bodies[0].model);
    Device& sensor = model->devices.emplace_back();
    sensor.name = "Sole";
    sensor.kind = ContactSensor{};
    scenario.bodies[0].model = model;
    return scenario;
  }

  Trace record_scenario(const Scenario& scenario) {
    const auto summary = record(scenario, path("run.mcap"), {});
    EXPECT_TRUE(summary.ok()) << to_string(summary.errors());
    auto trace = Trace::load(path("run.mcap"));
    EXPECT_TRUE(trace.ok()) << to_string(trace.errors());
    return *std::move(trace);
  }
};

TEST_F(ContactRuns, GiveAControllerTheContactPointsOfTheStepBefore) {
  const Trace trace = record_run(falling_foot(behaviour("C", "touch FOOT")));
  const std::vector<double> count = trace.values("Rig/C/input/FOOT/contacts/count");
  ASSERT_EQ(count.size(), 300u);
  std::size_t touched = 0;
  while (count[touched] == 0.0) ++touched;
  EXPECT_NEAR(static_cast<double>(touched), 14, 2);
  EXPECT_THAT(said(trace), Contains("Rig/C: tick " + std::to_string(touched) + ": 4 points, pushed up"));
}

TEST_F(ContactRuns, AreRecordedPointByPoint) {
  const Trace trace = record_run(falling_foot(behaviour("C", "touch FOOT"), "0.5"));
  const TraceChannel* contacts = trace.find_channel("/Rig/C/input/FOOT/contacts");
  ASSERT_NE(contacts, nullptr);
  EXPECT_EQ(contacts->type, "rehearse_msgs/msg/Contacts");
  EXPECT_EQ(contacts->messages(), 500u);
  double load = 0.0;
  for (int point = 0; point < 4; ++point) {
    const std::string series = "Rig/C/input/FOOT/contacts/" + std::to_string(point);
    load += trace.last(series + "/force/z");
    EXPECT_NEAR(std::abs(trace.last(series + "/position/x")), 0.2, 1e-3);
    EXPECT_NEAR(trace.last(series + "/normal/z"), 1.0, 1e-6);
    EXPECT_LT(trace.last(series + "/depth"), 1e-3);
    EXPECT_TRUE(std::isnan(trace.values(series + "/force/z").front()));  // the point didn't exist yet
  }
  EXPECT_NEAR(load, 5.0 * 9.80665, 2.0);
  EXPECT_EQ(trace.find_series("Rig/C/input/FOOT/contacts/4/depth"), std::nullopt);
}

TEST_F(ContactRuns, ReplayContactsBitForBit) {
  record_run(falling_foot(behaviour("C", "touch FOOT") + ", " + behaviour("D", "push 0.5")));
  const auto report = replay_run();
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_TRUE(report->equal()) << (report->first ? to_string(*report->first) : to_string(*report->failure));
  EXPECT_EQ(report->ticks, 300);
  EXPECT_NE(Trace::load(path("run.mcap"))->last("Rig/C/output/SHOULDER/u"), 0.0);
}

TEST_F(ContactRuns, ReplayContactsThatAnotherControllerHasRecorded) {
  record_run(falling_foot("{name: A, library: Behaviours, options: \"touch FOOT\", children: [" +
                          behaviour("Child", "touch FOOT") + "]}, " + behaviour("B", "touch FOOT")));
  const auto report = replay_run();
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_TRUE(report->equal());
}

TEST_F(ContactRuns, RefuseToReplayContactsThatWereNotRecorded) {
  record_run(falling_foot(behaviour("C", "push 0")));
  // the same recording, with a scenario whose controller reads contacts
  const std::string wanted = falling_foot(behaviour("C", "touch FOOT"));
  auto reader = mcap::Reader::open(path("run.mcap"));
  auto writer = mcap::Writer::create(path("other.mcap"));
  ASSERT_TRUE(reader.ok() && writer.ok());
  for (const auto& attachment : (*reader)->attachments()) {
    const bool is_scenario = attachment.name == "scenario.yaml";
    const auto data = is_scenario ? std::as_bytes(std::span(wanted)) : std::span<const std::byte>(attachment.data);
    ASSERT_TRUE((*writer)->add_attachment(attachment.name, attachment.media_type, data));
  }
  for (const auto& facts : (*reader)->metadata()) ASSERT_TRUE((*writer)->add_metadata(facts.name, facts.values));
  const auto channel = (*writer)->add_channel(
      (*writer)->add_schema(msg::Tick::type_name, "ros2msg", msg::schema_text<msg::Tick>()), "/tick", "cdr", {});
  CdrWriter tick;
  msg::encode(msg::Tick{}, tick);
  ASSERT_TRUE((*writer)->write(channel, 0, 0, tick.bytes()));
  ASSERT_TRUE((*writer)->close());
  const auto refused = replay_run({}, "other.mcap");
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.errors()[0].message,
              HasSubstr("controller 'Rig/C' reads the contact points of link 'FOOT', which was not recorded"));
}

TEST_F(ContactRuns, ArePartOfTheHashOfInputs) {
  // nothing else is input: the hash changes when, and only when, the contacts do
  const Trace trace = record_run(falling_foot(behaviour("C", "touch FOOT"), "0.02"));
  const TraceChannel* ticks = trace.find_channel("/tick");
  std::size_t hash = 0;
  while (ticks->columns[hash].element != "input_hash") ++hash;
  const std::vector<double> count = trace.values("Rig/C/input/FOOT/contacts/count");
  int touching = 0;
  for (std::size_t tick = 1; tick < count.size(); ++tick) {
    const bool same = ticks->bits(tick, hash) == ticks->bits(tick - 1, hash);
    EXPECT_EQ(same, count[tick] == 0.0) << "tick " << tick;
    touching += count[tick] > 0.0 ? 1 : 0;
  }
  EXPECT_GT(touching, 2);
}

TEST_F(ContactRuns, WatchingChangesNothingInThePhysics) {
  const auto with = record_run(falling_foot(behaviour("C", "touch ARM") + ", " + behaviour("D", "push 0"), "0.1"));
  const auto both = record_run(falling_foot(behaviour("C", "touch FOOT") + ", " + behaviour("D", "push 0"), "0.1"));
  EXPECT_EQ(with.values("Rig/FOOT/position/z"), both.values("Rig/FOOT/position/z"));
  EXPECT_EQ(with.values("Rig/FOOT/orientation/x"), both.values("Rig/FOOT/orientation/x"));
}

TEST_F(ContactRuns, SayThatALinkWithoutShapesTouchesNothing) {
  const Trace trace = record_run(falling_foot(behaviour("C", "touch ARM"), "0.05"));
  EXPECT_THAT(said(trace), ElementsAre("Rig/C: link 'ARM' has no collision shapes: its contact points stay empty"));
  EXPECT_EQ(trace.last("Rig/C/input/ARM/contacts/count"), 0.0);
}

TEST_F(ContactRuns, AreRecordedTwiceWithTheSameBytes) {
  const std::string run = falling_foot(behaviour("C", "touch FOOT"));
  record_run(run, "a.mcap");
  record_run(run, "b.mcap");
  EXPECT_EQ(bytes("a.mcap"), bytes("b.mcap"));
}

TEST_F(ContactRuns, DifferFromOneWithFewerContactsInTheTickWhereItLeaves) {
  const std::string run = falling_foot(behaviour("C", "touch FOOT"), "0.06");
  const Trace golden = record_run(run, "a.mcap");
  const Trace pushed =
      record_run(run + "pushes:\n  - {body: Rig, link: FOOT, force: [0, 0, 500], from: 0.03, until: 0.05}\n", "b.mcap");
  const std::vector<double> count = pushed.values("Rig/C/input/FOOT/contacts/count");
  ASSERT_EQ(count.back(), 0.0);
  const Comparison comparison = compare(golden, pushed, {});
  const auto channel = std::ranges::find_if(comparison.channels,
                                            [](const auto& of) { return of.channel == "/Rig/C/input/FOOT/contacts"; });
  ASSERT_NE(channel, comparison.channels.end());
  EXPECT_EQ(channel->stage, Stage::inputs);
  ASSERT_TRUE(channel->first.has_value());
  EXPECT_EQ(channel->first->tick, 31);  // the first contact caused by the push
  EXPECT_TRUE(channel->worst.has_value());
}

TEST_F(ContactRuns, AContactSensorIsADeviceLikeAnyOther) {
  const Trace trace = record_scenario(with_sensor(falling_foot(behaviour("C", "bump Sole"), "0.1")));
  const std::vector<double> count = trace.values("Rig/Sole/count");
  ASSERT_EQ(count.size(), 100u);  // at every tick but the first, and in the state after the last
  std::size_t touched = 0;
  while (count[touched] == 0.0) ++touched;
  const std::string tick = std::to_string(touched + 1);
  EXPECT_THAT(said(trace), Contains("Rig/C: ContactSensor Sole on FOOT, 4 numbers, 1 devices"));
  EXPECT_THAT(said(trace), Contains("Rig/C: tick " + tick + ": 4 points, pushed up, notified " + tick + " times"));
  EXPECT_EQ(trace.last("Rig/C/output/SHOULDER/u"), trace.values("Rig/Sole/force/z")[98]);
}

TEST_F(ContactRuns, AContactSensorIsRecordedWithItsUnits) {
  const Trace trace = record_scenario(with_sensor(falling_foot(behaviour("C", "push 0"), "0.5")));
  const TraceChannel* contact = trace.find_channel("/Rig/Sole/contact");
  ASSERT_NE(contact, nullptr);
  EXPECT_EQ(contact->type, "rehearse_msgs/msg/ContactForce");
  EXPECT_EQ(contact->metadata.at("unit:force"), "N");
  EXPECT_EQ(trace.last("Rig/Sole/count"), 4.0);
  EXPECT_NEAR(trace.last("Rig/Sole/force/z"), 5.0 * 9.80665, 2.0);
}

TEST_F(ContactRuns, AreRecordedWhereTheyBeginAndEnd) {
  const std::string push = "pushes: [{body: Rig, force: [0, 0, 500], from: 0.1, until: 0.11}]\n";
  const Trace trace = record_run(falling_foot("") + push, "run.mcap");
  const auto& changes = trace.contact_changes();
  ASSERT_EQ(changes.size(), 3u);
  for (const msg::ContactChange& change : changes) {
    EXPECT_EQ(change.link, "Rig/FOOT");
    EXPECT_EQ(change.other, "Floor/Floor");
    EXPECT_EQ(change.stamp.to_ns(), static_cast<std::uint64_t>(change.tick) * 1'000'000);
  }
  EXPECT_TRUE(changes[0].begins);
  EXPECT_NEAR(static_cast<double>(changes[0].tick), 15.0, 1.0);  // 1 mm deep
  EXPECT_FALSE(changes[1].begins);
  EXPECT_GT(changes[1].tick, 100);
  EXPECT_TRUE(changes[2].begins);
}

TEST_F(ContactRuns, AreThereAtTheFirstTickIfItLiesAndNotAgain) {
  std::string lying = falling_foot("");
  lying.replace(lying.find("0.051"), 5, "0.0499");
  const Trace trace = record_run(lying);
  ASSERT_EQ(trace.contact_changes().size(), 1u);
  EXPECT_EQ(trace.contact_changes()[0].tick, 1);
  EXPECT_NE(trace.find_channel("/contacts"), nullptr);
}

TEST_F(ContactRuns, AreTheSameUnderTheRecordedCommandsFromCheckpointToCheckpoint) {
  const std::string text = falling_foot("") + "pushes: [{body: Rig, force: [0, 0, 500], from: 0.1, until: 0.11}]\n";
  const Trace golden = record_run(text, "golden.mcap");
  const Scenario scenario = load(text);
  ASSERT_TRUE(run_plant(scenario, golden, path("plant.mcap"), {}).ok());
  const auto plant = Trace::load(path("plant.mcap"));
  ASSERT_TRUE(plant.ok());
  CompareOptions options;
  options.stages = {Stage::physics, Stage::sensors};
  const Comparison comparison = compare(golden, *plant, {}, options);
  EXPECT_TRUE(comparison.equal) << verdict(comparison) << table(comparison);
  EXPECT_THAT(comparison.equal_channels, Contains("/contacts"));
}

TEST_F(ContactRuns, LimitsOfAJointStandBesideItsNumbersIfTheyAreKept) {
  write("rig.urdf", rig_urdf);
  const std::string text = rig(behaviour("C", "drive effort 5 RAIL"));
  EXPECT_EQ(record_run(text).find_channel("/Rig/joints")->metadata.count("limits:RAIL/q"), 0u);
  std::string kept = text;
  kept.replace(kept.find("    model: rig.urdf"), 19,
               "    joint_limits: true\n    effort_limits: true\n    model: rig.urdf");
  const auto metadata = record_run(kept).find_channel("/Rig/joints")->metadata;
  EXPECT_EQ(metadata.at("limits:RAIL/q"), "-100 100");
  EXPECT_EQ(metadata.at("limits:RAIL/u"), "-1000 1000");
  EXPECT_EQ(metadata.count("limits:SHOULDER/q"), 0u) << "it has none";
}

}  // namespace
}  // namespace rehearse
