// A scripted joystick: the controllers' readings, the recording, and the replay.

#include <rehearse/compare.h>
#include <rehearse/mcap.h>

#include "runs.h"

namespace rehearse {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Forward in tick 5, also button A in tick 10, the trigger half way in tick 15.
constexpr const char* three_moves =
    "  - {at: 0.005, axes: {L_STICK_V: -1}}\n"
    "  - {at: 0.01, buttons: {A: true}}\n"
    "  - {at: 0.015, axes: {R_TRIGGER: 0.5}}\n";

class Joysticks : public RunTest {
 protected:
  /// 20 ticks of the rig with these controllers and a joystick.
  static std::string steered(const std::string& controllers, const std::string& entries = three_moves) {
    return rig(controllers, "cameras: none\njoystick:\n" + entries);
  }

  /// The commands of a controller that steers SHOULDER, in each tick.
  static std::vector<double> commands(const Trace& trace, const std::string& controller = "C") {
    return trace.values("Rig/" + controller + "/output/SHOULDER/u");
  }

  /// The effect of three_moves on a controller that steers: 5 ticks of each.
  static std::vector<double> three_moves_read() {
    std::vector<double> values;
    for (const double value : {0.0, -1.0, 9.0, 59.0}) values.insert(values.end(), 5, value);
    return values;
  }

  ReplayReport replayed(const std::string& file = "run.mcap") {
    auto report = replay_run({}, file);
    if (report) return *report;
    ADD_FAILURE() << to_string(report.errors());
    return {};
  }

  /// Copies a trace, except the messages on /joy: removed if `change` is null, else changed by it.
  void copy_trace(const std::string& from, const std::string& to, const std::function<void(msg::Joy&)>& change) const {
    auto reader = *mcap::Reader::open(path(from));
    auto writer = *mcap::Writer::create(path(to));
    std::map<std::uint16_t, std::uint16_t> ids;
    for (const mcap::Attachment& file : reader->attachments())
      ASSERT_TRUE(writer->add_attachment(file.name, file.media_type, file.data).ok());
    for (const mcap::Metadata& facts : reader->metadata())
      ASSERT_TRUE(writer->add_metadata(facts.name, facts.values).ok());
    for (const auto& [id, channel] : reader->channels()) {
      if (!change && channel.topic == "/joy") continue;
      const mcap::Schema& schema = *reader->schema_of(channel);
      ids[id] = writer->add_channel(writer->add_schema(schema.name, schema.encoding, schema.data), channel.topic,
                                    channel.message_encoding, channel.metadata);
    }
    ASSERT_TRUE(reader
                    ->for_each_message([&](const mcap::Message& message) {
                      if (ids.count(message.channel->id) == 0) return true;
                      mcap::Bytes data = message.data;
                      CdrWriter cdr;
                      if (message.channel->topic == "/joy") {
                        CdrReader joy_reader(message.data);
                        msg::Joy joy;
                        EXPECT_TRUE(msg::decode(joy_reader, joy));
                        change(joy);
                        msg::encode(joy, cdr);
                        data = cdr.bytes();
                      }
                      return writer->write(ids[message.channel->id], message.log_time, message.publish_time, data).ok();
                    })
                    .ok());
    ASSERT_TRUE(writer->close().ok());
  }
};

TEST_F(Joysticks, AreReadInTheTickInWhichTheyMove) {
  EXPECT_EQ(commands(record_run(steered(behaviour("C", "steer")))), three_moves_read());
}

TEST_F(Joysticks, AreThereFromAControllersConstructionOn) {
  EXPECT_THAT(said(record_run(steered(behaviour("C", "steer")))), Contains("Rig/C: ready, 8 axes, 11 buttons"));
}

TEST_F(Joysticks, AreThereIfNobodyEverTouchesThem) {
  const Trace trace = record_run(rig(behaviour("C", "steer"), "cameras: none\njoystick: []\n"));
  EXPECT_THAT(said(trace), Contains("Rig/C: ready, 8 axes, 11 buttons"));
  EXPECT_THAT(commands(trace), Each(0.0));
}

TEST_F(Joysticks, AreNotThereIfTheScenarioHasNone) {
  const Trace trace = record_run(rig_with("steer"));
  EXPECT_THAT(said(trace), Contains("Rig/C: not ready, 0 axes, 0 buttons"));
  EXPECT_THAT(commands(trace), Each(0.0));
  EXPECT_EQ(trace.find_channel("/joy"), nullptr);
}

TEST_F(Joysticks, AreFoundByAControllerThatLooksForThemLate) {
  EXPECT_EQ(commands(record_run(steered(behaviour("C", "steer_late")))), three_moves_read());
}

TEST_F(Joysticks, KeepWhatWasReadUntilTheyAreReadAgain) {
  const std::vector<double> read = commands(record_run(steered(behaviour("C", "steer_once"))));
  EXPECT_THAT(std::vector<double>(read.begin(), read.begin() + 5), Each(0.0));
  EXPECT_THAT(std::vector<double>(read.begin() + 5, read.end()), Each(-1.0));
}

TEST_F(Joysticks, AreReadByEachControllerForItself) {
  const Trace trace = record_run(steered(behaviour("Once", "steer_once") + ", " + behaviour("Always", "steer")));
  EXPECT_EQ(commands(trace, "Always"), three_moves_read());
  EXPECT_EQ(commands(trace, "Once").back(), -1.0);
}

TEST_F(Joysticks, AreSharedInTurnsByAParentAndItsChild) {
  const std::string family = "{name: P, library: Behaviours, options: \"share SHOULDER\", children: [" +
                             behaviour("Child", "share RAIL") + "]}";
  const Trace trace = record_run(steered(family,
                                         "  - {at: 0, axes: {L_STICK_V: 1}}\n"
                                         "  - {at: 0.004, buttons: {LOGO: true}}\n"  // pressed for 4 ticks: one edge
                                         "  - {at: 0.008, buttons: {LOGO: false}}\n"
                                         "  - {at: 0.012, buttons: {SELECT: true}}\n"
                                         "  - {at: 0.013, buttons: {SELECT: false}}\n"
                                         "  - {at: 0.016, buttons: {SELECT: true}}\n"));
  std::vector<double> parent, child;  // the child's turn is in ticks 4 to 11, and from 16 on
  for (int tick = 0; tick < 20; ++tick) {
    const bool childs_turn = (tick >= 4 && tick < 12) || tick >= 16;
    parent.push_back(childs_turn ? 0.0 : 1.0);
    child.push_back(childs_turn ? 1.0 : 0.0);
  }
  EXPECT_EQ(commands(trace, "P"), parent);
  EXPECT_EQ(trace.values("Rig/Child/output/RAIL/u"), child);
}

TEST_F(Joysticks, SignalWhatMovedWhenTheyAreRead) {
  const Trace trace = record_run(steered(behaviour("C", "listen"),
                                         "  - {at: 0, axes: {L_TRIGGER: 0.25}}\n"
                                         "  - {at: 0.005, axes: {L_TRIGGER: 0, L_STICK_H: 0.5}, buttons: {B: true}}\n"
                                         "  - {at: 0.01, axes: {L_STICK_H: 0}, buttons: {B: false}}\n"));
  EXPECT_THAT(said(trace), ElementsAre("Rig/C: axis 6 at 0.25, active 1", "Rig/C: axis 0 at 0.5, active 1",
                                       "Rig/C: axis 6 at 0, active 1", "Rig/C: button 1 pressed",
                                       "Rig/C: axis 0 at 0, active 0", "Rig/C: button 1 let go"));
}

TEST_F(Joysticks, LetAControllerFailInASignal) {
  for (const char* failure : {"throw", "abort"}) {
    record_run(steered(behaviour("C", std::string("listen ") + failure) + ", " + behaviour("D", "steer")));
    ASSERT_TRUE(summary_.failure.has_value()) << failure;
    EXPECT_THAT(summary_.failure->message, HasSubstr("in control() at tick 10"));
    EXPECT_EQ(commands(record_run(steered(behaviour("C", "steer")))), three_moves_read()) << "after it";
  }
}

TEST_F(Joysticks, OfInterleavedRunsAreFoundByTheirOwnControllersOnly) {
  const std::string both = behaviour("Early", "steer") + ", " + behaviour("Late", "steer_late");
  const std::vector<std::string> texts{steered(both), steered(both, "  - {at: 0.01, axes: {L_STICK_V: 0.5}}\n"),
                                       rig(both)};
  std::vector<Scenario> scenarios;
  for (const std::string& text : texts) scenarios.push_back(load(text));
  std::vector<std::unique_ptr<Session>> sessions;
  for (const Scenario& scenario : scenarios) {
    auto session = Session::create(scenario, path(std::to_string(sessions.size()) + ".mcap"), {});
    ASSERT_TRUE(session.ok());
    sessions.push_back(std::move(*session));
  }
  for (int tick = 0; tick < 20; ++tick)
    for (const auto& session : sessions) ASSERT_TRUE(*session->step());
  for (const auto& session : sessions) ASSERT_TRUE(session->finish().ok());

  std::vector<double> second(10, 0.0);
  second.insert(second.end(), 10, 0.5);
  const std::vector<std::vector<double>> expected{three_moves_read(), second, std::vector<double>(20, 0.0)};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Trace trace = *Trace::load(path(std::to_string(i) + ".mcap"));
    EXPECT_EQ(commands(trace, "Early"), expected[i]) << "run " << i;
    EXPECT_EQ(commands(trace, "Late"), expected[i]) << "run " << i;
  }
}

TEST_F(Joysticks, AreRecordedInEachTick) {
  const Trace trace = record_run(steered(behaviour("C", "steer"),
                                         "  - {at: 0.005, axes: {L_STICK_V: -0.3}}\n"
                                         "  - {at: 0.015, buttons: {A: true}}\n"));
  const TraceChannel* channel = trace.find_channel("/joy");
  ASSERT_NE(channel, nullptr);
  EXPECT_EQ(channel->type, "sensor_msgs/msg/Joy");
  EXPECT_EQ(channel->messages(), 21u) << "20 ticks, and the state after the last";
  EXPECT_EQ(channel->columns.size(), 19u);
  EXPECT_EQ(trace.at("axes/L_STICK_V", 0.004), 0.0);
  EXPECT_EQ(trace.at("axes/L_STICK_V", 0.005), static_cast<double>(-0.3f)) << "ROS carries single precision";
  EXPECT_EQ(trace.at("buttons/A", 0.014), 0.0);
  EXPECT_EQ(trace.at("buttons/A", 0.015), 1.0);
  EXPECT_EQ(commands(trace)[5], static_cast<double>(-0.3f)) << "and so does the controller read it";
}

TEST_F(Joysticks, AreRecordedWithTheSameBytesAgain) {
  record_run(steered(behaviour("C", "steer")), "a.mcap");
  record_run(steered(behaviour("C", "steer")), "b.mcap");
  EXPECT_GT(bytes("a.mcap").size(), 1000u);
  EXPECT_TRUE(bytes("a.mcap") == bytes("b.mcap"));
}

TEST_F(Joysticks, ArePartOfTheInputsHash) {
  const std::string nothing_else = behaviour("C", "push 1");  // it reads nothing, not even the joystick
  const auto moved = record_run(steered(nothing_else)).integers("input_hash");
  EXPECT_EQ(moved[4], moved[0]);
  EXPECT_NE(moved[5], moved[0]) << "an axis moved";
  EXPECT_NE(moved[10], moved[5]) << "a button was pressed";
  const auto untouched = record_run(rig(nothing_else, "cameras: none\njoystick: []\n")).integers("input_hash");
  EXPECT_EQ(untouched[19], moved[0]);
  EXPECT_NE(record_run(rig(nothing_else)).integers("input_hash")[0], moved[0]);
}

TEST_F(Joysticks, AreReplayedBitForBit) {
  const std::string family = "{name: P, library: Behaviours, options: \"share SHOULDER\", children: [" +
                             behaviour("Child", "share RAIL") + "]}, " + behaviour("C", "steer");
  record_run(steered(family, std::string("  - {at: 0, axes: {L_STICK_V: 0.7}, over: 0.013}\n") +
                                 "  - {at: 0.005, buttons: {SELECT: true, A: true}}\n"));
  const ReplayReport report = replayed();
  EXPECT_TRUE(report.equal()) << (report.first ? to_string(*report.first) : "");
  EXPECT_EQ(report.ticks, 20);
}

TEST_F(Joysticks, AreReplayedAsTheyWereRecordedWhateverTheScriptSays) {
  record_run(steered(behaviour("C", "steer")));
  copy_trace("run.mcap", "moved.mcap", [](msg::Joy& joy) { joy.axes[1] += 0.25f; });
  const ReplayReport report = replayed("moved.mcap");
  EXPECT_EQ(report.ticks_different, 20);
  ASSERT_TRUE(report.first.has_value());
  EXPECT_EQ(report.first->tick, 0);
  EXPECT_EQ(report.first->actual, 0.25);
}

TEST_F(Joysticks, AreNotReplayedIfTheyWereNotRecorded) {
  record_run(steered(behaviour("C", "steer")));
  copy_trace("run.mcap", "bare.mcap", nullptr);
  const auto refused = replay_run({}, "bare.mcap");
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(to_string(refused.errors()),
              HasSubstr("bare.mcap: error: the run has a joystick, but its input was not recorded: there is no /joy "
                        "(record the scenario again)"));
}

TEST_F(Joysticks, AreNotReplayedIfTheyAreOfAnotherMake) {
  record_run(steered(behaviour("C", "steer")));
  copy_trace("run.mcap", "six.mcap", [](msg::Joy& joy) { joy.axes.resize(6); });
  const auto refused = replay_run({}, "six.mcap");
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(to_string(refused.errors()),
              HasSubstr("a message on /joy at 0 ns is not of a joystick with 8 axes and 11 buttons"));
}

TEST_F(Joysticks, AreTheFirstToDifferWhenTheScriptHasChanged) {
  const Trace before = record_run(steered(behaviour("C", "steer")), "before.mcap");
  const Trace after = record_run(steered(behaviour("C", "steer"),
                                         "  - {at: 0.005, axes: {L_STICK_V: -0.75}}\n"
                                         "  - {at: 0.01, buttons: {A: true}}\n"
                                         "  - {at: 0.015, axes: {R_TRIGGER: 0.5}}\n"));
  const Comparison found = compare(before, after, {});
  ASSERT_TRUE(found.first.has_value());
  EXPECT_EQ(found.first->tick, 5);
  EXPECT_EQ(found.first->channel, "/joy");
  EXPECT_EQ(found.first->element, "axes/L_STICK_V");
  EXPECT_EQ(found.first->stage, Stage::inputs);
  EXPECT_EQ(found.first->expected, -1.0);
  EXPECT_EQ(found.first->actual, -0.75);
  EXPECT_THAT(verdict(found), HasSubstr("axes/L_STICK_V is -0.75, expected -1"));
}

TEST_F(Joysticks, AreNoConcernOfABodyOfThatName) {
  const std::string text = "rehearse: 1\nduration: 0.02\ncameras: none\njoystick:\n" + std::string(three_moves) +
                           "bodies:\n  - name: joy\n    model: rig.urdf\n    controllers: [" + behaviour("C", "steer") +
                           "]\n";
  const Trace trace = record_run(text);
  EXPECT_EQ(trace.values("joy/C/output/SHOULDER/u"), three_moves_read());
  EXPECT_TRUE(replayed().equal());
}

}  // namespace
}  // namespace rehearse
