// The vocabulary of recordings: topics, and the table of kinds.
#include "core/kinds/channel_name.h"

#include <rehearse/mcap.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "support/files.h"

using namespace rehearse;

namespace {

struct Case {
  const char* topic;
  const char* body;
  const char* controller;
  ChannelSide side;
  const char* owner;
  ChannelKind kind;
  Stage stage;
};

class Topics : public testing::TestWithParam<Case> {};

TEST_P(Topics, AreParsedAndWritten) {
  const Case& expected = GetParam();
  const ChannelName name = ChannelName::parse(expected.topic);
  EXPECT_EQ(name.body, expected.body);
  EXPECT_EQ(name.controller, expected.controller);
  EXPECT_EQ(name.side, expected.side);
  EXPECT_EQ(name.owner, expected.owner);
  EXPECT_EQ(name.kind, expected.kind);
  EXPECT_EQ(name.topic(), expected.topic);
  EXPECT_EQ(stage_of(name), expected.stage);
}

constexpr ChannelSide none = ChannelSide::none, input = ChannelSide::input, output = ChannelSide::output;

INSTANTIATE_TEST_SUITE_P(
    OfRecordings, Topics,
    testing::Values(
        Case{"/tick", "", "", none, "", ChannelKind::tick, Stage::controller},
        Case{"/tf", "", "", none, "", ChannelKind::transforms, Stage::physics},
        Case{"/joy", "", "", none, "", ChannelKind::joystick, Stage::inputs},
        Case{"/events", "", "", none, "", ChannelKind::events, Stage::controller},
        Case{"/contacts", "", "", none, "", ChannelKind::contact_changes, Stage::physics},
        Case{"/checkpoint", "", "", none, "", ChannelKind::checkpoint, Stage::physics},
        Case{"/SR1/joints", "SR1", "", none, "", ChannelKind::joints, Stage::physics},
        Case{"/SR1/measured_joints", "SR1", "", none, "", ChannelKind::measured_joints, Stage::sensors},
        Case{"/SR1/WAIST/pose", "SR1", "", none, "WAIST", ChannelKind::pose, Stage::physics},
        Case{"/SR1/WAIST/twist", "SR1", "", none, "WAIST", ChannelKind::twist, Stage::physics},
        Case{"/SR1/LeftForce/wrench", "SR1", "", none, "LeftForce", ChannelKind::wrench, Stage::sensors},
        Case{"/SR1/Gyro/imu", "SR1", "", none, "Gyro", ChannelKind::imu, Stage::sensors},
        Case{"/SR1/Sole/contact", "SR1", "", none, "Sole", ChannelKind::contact, Stage::sensors},
        Case{"/SR1/Laser/scan", "SR1", "", none, "Laser", ChannelKind::scan, Stage::sensors},
        Case{"/SR1/Laser/points", "SR1", "", none, "Laser", ChannelKind::points, Stage::sensors},
        Case{"/SR1/Eye/image", "SR1", "", none, "Eye", ChannelKind::image, Stage::renderer},
        Case{"/SR1/Eye/depth", "SR1", "", none, "Eye", ChannelKind::depth, Stage::renderer},
        Case{"/SR1/Eye/camera_info", "SR1", "", none, "Eye", ChannelKind::camera_info, Stage::renderer},
        Case{"/SR1/Lamp/state", "SR1", "", none, "Lamp", ChannelKind::device_state, Stage::physics},
        Case{"/SR1/Walk/input/joints", "SR1", "Walk", input, "", ChannelKind::joints, Stage::inputs},
        Case{"/SR1/Walk/input/WAIST/accel", "SR1", "Walk", input, "WAIST", ChannelKind::acceleration, Stage::inputs},
        Case{"/SR1/Walk/input/SOLE/contacts", "SR1", "Walk", input, "SOLE", ChannelKind::contacts, Stage::inputs},
        Case{"/SR1/Walk/output/joint_accelerations", "SR1", "Walk", output, "", ChannelKind::joint_accelerations,
             Stage::controller},
        Case{"/SR1/Walk/output/WAIST/wrench", "SR1", "Walk", output, "WAIST", ChannelKind::wrench, Stage::controller},
        Case{"/SR1/Walk/acted/Lamp/state", "SR1", "Walk", ChannelSide::acted, "Lamp", ChannelKind::device_state,
             Stage::physics},
        Case{"/SR1/Walk/variable/phase", "SR1", "Walk", ChannelSide::variable, "phase", ChannelKind::variable,
             Stage::controller}));

INSTANTIATE_TEST_SUITE_P(
    WithOddNames, Topics,
    testing::Values(Case{"/R/head%2F100%25/imu", "R", "", none, "head/100%", ChannelKind::imu, Stage::sensors},
                    Case{"/R/C/output/a%252Fb/pose", "R", "C", output, "a%2Fb", ChannelKind::pose, Stage::controller},
                    Case{"/50%/C/variable/a%2Fb", "50%", "C", ChannelSide::variable, "a/b", ChannelKind::variable,
                         Stage::controller},
                    Case{"/input/output/input/joints", "input", "output", input, "", ChannelKind::joints,
                         Stage::inputs}));

constexpr ChannelKind other = ChannelKind::other;

INSTANTIATE_TEST_SUITE_P(OfOthers, Topics,
                         testing::Values(Case{"", "", "", none, "", other, Stage::physics},
                                         Case{"/", "", "", none, "", other, Stage::physics},
                                         Case{"tick", "", "", none, "", other, Stage::physics},
                                         Case{"/joint_states", "", "", none, "", other, Stage::physics},
                                         Case{"/SR1/tick", "", "", none, "", other, Stage::physics},
                                         Case{"/SR1//pose", "", "", none, "", other, Stage::physics},
                                         Case{"/SR1/WAIST/pose/", "", "", none, "", other, Stage::physics},
                                         Case{"/SR1/WAIST%2f/pose", "", "", none, "", other, Stage::physics},
                                         Case{"/SR1/WAIST%/pose", "", "", none, "", other, Stage::physics},
                                         Case{"/SR1/Walk/side/WAIST/pose", "", "", none, "", other, Stage::physics},
                                         Case{"/SR1/Walk/variable/", "", "", none, "", other, Stage::physics},
                                         Case{"/SR1/Walk/variable/a/b", "", "", none, "", other, Stage::physics},
                                         Case{"/a/b/c/d/e/pose", "", "", none, "", other, Stage::physics},
                                         Case{"/imu", "", "", none, "", other, Stage::sensors},
                                         Case{"/head/camera_info", "", "", none, "", other, Stage::renderer}));

TEST(ChannelName, IsMadeOfItsParts) {
  EXPECT_EQ(ChannelName::of_body("SR1", ChannelKind::joints).topic(), "/SR1/joints");
  EXPECT_EQ(ChannelName::of_owner("SR1", "a/b", ChannelKind::pose).topic(), "/SR1/a%2Fb/pose");
  const ChannelName command = ChannelName::of_controller("SR1/Walk", output, ChannelKind::joints);
  EXPECT_EQ(command.topic(), "/SR1/Walk/output/joints");
  EXPECT_TRUE(command.is_of("SR1/Walk", output));
  EXPECT_FALSE(command.is_of("SR1/Walk", input));
  EXPECT_FALSE(command.is_of("SR1/Wal", output));
  EXPECT_EQ(ChannelName::of_variable("SR1/Walk", "step/phase").topic(), "/SR1/Walk/variable/step%2Fphase");
  EXPECT_EQ(ChannelName::parse("/SR1/joints").label(), "");
}

TEST(ChannelName, GivesSeriesTheirNames) {
  EXPECT_EQ(series_name("/SR1/joints", "KNEE/q"), "SR1/KNEE/q");
  EXPECT_EQ(series_name("/SR1/Walk/variable/phase", "phase"), "SR1/Walk/variable/phase");
  EXPECT_EQ(series_name("/tick", "tick"), "tick");
  EXPECT_EQ(series_name("a/b", "c"), "a/c");
}

TEST(ChannelName, TellsWhichSegmentDistinguishesChannelsOfAKind) {
  EXPECT_EQ(distinguishing_segment("/tick"), "");
  EXPECT_EQ(distinguishing_segment("/SR1/joints"), "SR1");
  EXPECT_EQ(distinguishing_segment("/SR1/a%2Fb/wrench"), "a%2Fb");
  EXPECT_EQ(distinguishing_segment("/SR1/Walk/output/joints"), "");
  EXPECT_EQ(distinguishing_segment("/SR1/Walk/input/WAIST/pose"), "WAIST");
  EXPECT_EQ(distinguishing_segment("/SR1/Walk/variable/phase"), "");
  EXPECT_EQ(distinguishing_segment("/head/left/color/image"), "color");
}

TEST(ChannelName, KnowsTheTopicsOfTheRun) {
  EXPECT_EQ(ChannelName::of_run(ChannelKind::tick).topic(), run_topics::tick);
  EXPECT_EQ(ChannelName::of_run(ChannelKind::transforms).topic(), run_topics::transforms);
  EXPECT_EQ(ChannelName::of_run(ChannelKind::events).topic(), run_topics::events);
  EXPECT_EQ(ChannelName::of_run(ChannelKind::contact_changes).topic(), run_topics::contact_changes);
  EXPECT_EQ(ChannelName::of_run(ChannelKind::checkpoint).topic(), run_topics::checkpoint);
}

TEST(ChannelName, TellsTheStageOfEachElement) {
  EXPECT_EQ(stage_of("/tick", "state_hash"), Stage::physics);
  EXPECT_EQ(stage_of("/tick", "input_hash"), Stage::inputs);
  EXPECT_EQ(stage_of("/tick", "output_hash"), Stage::controller);
  EXPECT_EQ(stage_of("/tf", "Rover/Laser/scan/position/x"), Stage::sensors);
}

TEST(ChannelName, GroupsInChunksTheChannelsThatAReplayReads) {
  const auto group_of = [](std::string_view topic) { return chunk_group_of(ChannelName::parse(topic)).id; };
  for (const char* topic : {"/tick", "/joy", "/SR1/joints", "/SR1/Walk/input/joints", "/SR1/Walk/input/WAIST/pose",
                            "/SR1/Walk/output/joints", "/SR1/Walk/acted/joints"})
    EXPECT_EQ(group_of(topic), mcap::numbers.id) << topic;
  EXPECT_EQ(group_of("/SR1/WAIST/pose"), group_of("/tf"));
  EXPECT_EQ(group_of("/SR1/Gyro/imu"), group_of("/SR1/measured_joints"));
  EXPECT_EQ(group_of("/SR1/Camera/image"), mcap::pictures.id);
  const std::set<int> groups{group_of("/tick"), group_of("/tf"), group_of("/SR1/Gyro/imu"),
                             group_of("/SR1/Camera/image"), group_of("/SR1/Camera/depth")};
  EXPECT_EQ(groups.size(), 5u);
}

TEST(ChannelName, ExcludesSeriesThatItsMessagesCannotHave) {
  EXPECT_TRUE(may_match("/SR1/WAIST/pose", "SR1/WAIST/position/z"));
  EXPECT_TRUE(may_match("/SR1/WAIST/pose", "SR1/WAIST/pose/position/z"));  // of a second channel with that topic
  EXPECT_FALSE(may_match("/SR1/WAIST/pose", "SR1/*/u"));
  EXPECT_FALSE(may_match("/SR1/Gyro/imu", "SR1/WAIST/*"));
  EXPECT_FALSE(may_match("/SR1/Camera/image", "*"));
  EXPECT_TRUE(may_match("/SR1/joints", "SR1/*/u"));  // joints have the names that the messages state
  EXPECT_TRUE(may_match("/odometry", "*"));
}

TEST(ChannelForms, HaveEachSegmentOnce) {
  std::set<std::pair<int, std::string_view>> segments;
  for (const ChannelForm* form : channel_forms())
    EXPECT_TRUE(segments.emplace(static_cast<int>(form->level), form->segment).second) << form->segment;
}

TEST(ChannelForms, HaveWhatTheirReadersNeed) {
  for (const ChannelForm* form : channel_forms()) {
    EXPECT_THAT(form->schema(), testing::Not(testing::IsEmpty())) << form->segment;
    EXPECT_TRUE(!form->has_fixed_elements || (!form->groups.empty() && form->make_rows)) << form->segment;
    EXPECT_TRUE(!form->measurement || form->measurement->encode || form->numbers) << form->segment;
  }
}

TEST(ChannelForms, AreFoundForEachSensor) {
  for (const DeviceKind& kind : device_kinds()) {
    Device device;
    device.kind = kind;
    const std::vector<ChannelKind> kinds = kinds_of(device);
    EXPECT_EQ(kinds.empty(), quantities_of(device).empty() && !std::holds_alternative<Light>(kind))
        << type_name(device);
    EXPECT_EQ(value_elements(device).size(), static_cast<std::size_t>(value_count(device))) << type_name(device);
  }
}

/// The first type of a row is in the page of its file, in a list of code.
void expect_in_page(const DeviceNames& names, const std::string& page) {
  const std::string file = std::string(FIXTURES_DIR) + "/../tools/site/pages/reference/" + page;
  if (!names.first().empty()) {
    EXPECT_THAT(test::read_file(file), testing::HasSubstr("`" + std::string(names.first()) + "`")) << file;
  }
}

/// The types in a scenario stand in tables that are made of the parser's rows.
TEST(ChannelForms, OfDevicesHaveTheirTypesInTheReference) {
  for (const DeviceKind& kind : device_kinds())
    std::visit([](const auto& of_kind) { expect_in_page(of_kind.form().urdf_types, "devices.md"); }, kind);
}

TEST(ChannelForms, NameTheirElements) {
  const auto names = [](ChannelKind kind) {
    std::vector<std::string> all;
    for (const ChannelElement& element : elements_of(kind)) all.push_back(element.name);
    return all;
  };
  EXPECT_THAT(names(ChannelKind::pose), testing::ElementsAre("position/x", "position/y", "position/z", "orientation/x",
                                                             "orientation/y", "orientation/z", "orientation/w"));
  EXPECT_THAT(names(ChannelKind::contact), testing::ElementsAre("count", "force/x", "force/y", "force/z"));
  EXPECT_EQ(elements_of(ChannelKind::wrench)[3].unit, "N·m");
  EXPECT_EQ(unit_of_joint("dq", true), "m/s");
  EXPECT_EQ(unit_of_joint("ddq", false), "rad/s²");
  EXPECT_EQ(unit_of_joint("T", false), "");
}

TEST(Units, AreStatedForAnElementItsGroupOrAll) {
  const mcap::StringMap metadata{{"unit:KNEE/q", "rad"}, {"unit:force", "N"}, {"unit", "m"}};
  EXPECT_EQ(unit_of(metadata, "KNEE/q"), "rad");
  EXPECT_EQ(unit_of(metadata, "force/x"), "N");
  EXPECT_EQ(unit_of(metadata, "contacts/0/force/x"), "N");
  EXPECT_EQ(unit_of(metadata, "forces/x"), "m");
  EXPECT_EQ(unit_of(metadata, ""), "m");
  EXPECT_EQ(unit_of({}, "force/x"), "");
}

/// Units of joints depend on the joint's type, which isn't part of a topic.
void expect_units_of_joints(const mcap::Channel& channel, const ChannelForm& form) {
  for (const auto& [key, unit] : channel.metadata) {
    if (!key.starts_with("unit:")) continue;
    const std::string quantity = key.substr(key.rfind('/') + 1);
    EXPECT_TRUE(unit == unit_of_joint(quantity, false) || unit == unit_of_joint(quantity, true)) << key;
    EXPECT_TRUE(std::ranges::any_of(form.groups, [&](const ElementGroup& group) { return group.name == quantity; }));
  }
}

TEST(Goldens, HaveTheTopicsTypesAndUnitsOfTheTable) {
  std::set<ChannelKind> kinds;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(FIXTURES_DIR) / ".." / "golden")) {
    if (entry.path().extension() != ".mcap") continue;
    const auto reader = mcap::Reader::open(entry.path());
    ASSERT_TRUE(reader) << entry.path();
    for (const auto& [id, channel] : (*reader)->channels()) {
      SCOPED_TRACE(entry.path().filename().string() + " " + channel.topic);
      const ChannelName name = ChannelName::parse(channel.topic);
      ASSERT_NE(name.kind, ChannelKind::other);
      EXPECT_EQ(name.topic(), channel.topic);
      const ChannelForm& form = form_of(name.kind);
      EXPECT_EQ((*reader)->schema_of(channel)->name, form.type);
      kinds.insert(name.kind);
      if (form.level == ChannelForm::Level::body) {
        expect_units_of_joints(channel, form);
        continue;
      }
      mcap::StringMap units;
      for (const auto& [key, unit] : channel.metadata)
        if (key.starts_with("unit")) units[key] = unit;
      EXPECT_EQ(units, unit_metadata(name.kind));
    }
  }
  EXPECT_GE(kinds.size(), 16u);
}

}  // namespace
