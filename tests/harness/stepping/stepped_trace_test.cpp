// A recording at any of its ticks: its values, their changes, and the replayed commands.
#include <rehearse/mcap.h>

#include <algorithm>
#include <cmath>

#include "session/runs.h"
#include "viewing/stepping/tick_view.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::int64_t changed_from = 70;  // where HingePdChanged gives something else

class Stepped : public RunTest {
 protected:
  /// The wheel, away from its rest position, under HingePd, for 100 ticks.
  void record_hinge() {
    recorded_ = record_run(
        "rehearse: 1\nduration: 0.1\ncameras: none\nbodies:\n  - name: Rig\n    model: rig.urdf\n"
        "    joints: {SHOULDER: 0.3}\n    controllers: [{name: C, library: HingePd}]\n");
  }
  std::unique_ptr<SteppedTrace> opened(const SteppingOptions& options = {}, const std::string& file = "run.mcap") {
    auto trace = SteppedTrace::open(path(file), options);
    if (trace) return *std::move(trace);
    ADD_FAILURE() << to_string(trace.errors());
    return nullptr;
  }
  static SteppingOptions changed() {
    SteppingOptions options;
    options.libraries["C"] = "HingePdChanged";
    return options;
  }
  static std::size_t series(SteppedTrace& trace, const std::string& name) {
    const auto found = trace.find_series(name);
    EXPECT_TRUE(found.ok()) << name;
    return found ? *found : 0;
  }
  static const ViewChannel* channel(const TickView& view, const std::string& topic) {
    for (const ViewChannel& channel : view.channels)
      if (channel.topic == topic) return &channel;
    return nullptr;
  }
  Trace recorded_;
};

TEST_F(Stepped, HasTheValuesOfEachTickInAnyOrder) {
  record_hinge();
  const auto trace = opened();
  ASSERT_NE(trace, nullptr);
  EXPECT_EQ(trace->first_tick(), 0);
  EXPECT_EQ(trace->last_tick(), 99);
  EXPECT_EQ(trace->last_replayed(), 99);
  EXPECT_THAT(trace->remarks(), IsEmpty());
  const std::vector<double> q = recorded_.values("Rig/SHOULDER/q");
  const std::size_t id = series(*trace, "Rig/SHOULDER/q");
  for (const std::int64_t tick : {99, 0, 50, 49, 48, 98, 1, 2, 99})
    EXPECT_TRUE(identical(trace->value(id, tick, CommandSide::recorded), q[static_cast<std::size_t>(tick)])) << tick;
}

TEST_F(Stepped, KnowsTicksByTheirTime) {
  record_hinge();
  const auto trace = opened();
  EXPECT_EQ(trace->tick_at(0.0), 0);
  EXPECT_EQ(trace->tick_at(0.05), 50);
  EXPECT_EQ(trace->tick_at(0.0509), 50);
  EXPECT_EQ(trace->time_at(50), 0.05);
}

TEST_F(Stepped, ShowsATickWithWhatChanged) {
  record_hinge();
  const auto trace = opened();
  const TickView view = trace->view(50);
  EXPECT_EQ(view.tick, 50);
  EXPECT_EQ(view.time, 0.05);
  EXPECT_TRUE(view.is_replayed);
  EXPECT_THAT(view.differences, IsEmpty());
  const ViewChannel* input = channel(view, "/Rig/C/input/joints");
  ASSERT_NE(input, nullptr);
  EXPECT_EQ(input->kind, ViewChannel::Kind::input);
  EXPECT_EQ(input->owner, "Rig/C");
  EXPECT_EQ(input->part, "joints");
  EXPECT_TRUE(input->is_joints);
  const std::vector<double> q = recorded_.values("Rig/C/input/SHOULDER/q");
  const auto value = std::ranges::find_if(input->values, [](const ViewValue& v) { return v.element == "SHOULDER/q"; });
  ASSERT_NE(value, input->values.end());
  EXPECT_EQ(value->value, q[50]);
  ASSERT_TRUE(value->before);
  EXPECT_EQ(*value->before, q[49]);
  EXPECT_TRUE(value->changed());
  EXPECT_EQ(value->unit, "rad");
  EXPECT_FALSE(value->replayed);
  const ViewChannel* sensor = channel(view, "/Rig/Gyro/imu");
  ASSERT_NE(sensor, nullptr);
  EXPECT_EQ(sensor->kind, ViewChannel::Kind::sensor);
  EXPECT_EQ(channel(view, "/tf"), nullptr) << "for viewers";
}

TEST_F(Stepped, TheFirstTickHasNothingBefore) {
  record_hinge();
  const TickView view = opened()->view(0);
  ASSERT_FALSE(view.channels.empty());
  for (const ViewChannel& shown : view.channels)
    for (const ViewValue& value : shown.values) EXPECT_FALSE(value.before) << value.series;
}

TEST_F(Stepped, HasWhatAChangedControllerGivesNow) {
  record_hinge();
  const auto trace = opened(changed());
  ASSERT_EQ(trace->remarks().size(), 1u);
  EXPECT_THAT(trace->remarks()[0].message, HasSubstr("the library of Rig/C isn't the one that was recorded"));
  EXPECT_TRUE(trace->differs());
  EXPECT_THAT(trace->differences(changed_from - 1), IsEmpty());
  EXPECT_FALSE(trace->differs_at(changed_from - 1));
  EXPECT_TRUE(trace->differs_at(changed_from));
  ASSERT_THAT(trace->differences(changed_from), SizeIs(1));
  const Divergence found = trace->differences(changed_from)[0];
  EXPECT_EQ(found.channel, "/Rig/C/output/joints");
  EXPECT_EQ(found.element, "SHOULDER/u");
  EXPECT_EQ(found.tick, changed_from);

  // the same as in a replay
  ReplayOptions options;
  options.libraries["C"] = "HingePdChanged";
  const auto report = replay_run(options);
  ASSERT_TRUE(report.ok());
  ASSERT_TRUE(report->first);
  Divergence judged = found;
  judged.tolerance = report->first->tolerance;
  EXPECT_EQ(to_string(*report->first), to_string(judged));

  const std::size_t command = series(*trace, "output/SHOULDER/u");
  EXPECT_TRUE(trace->is_replayed(command));
  EXPECT_FALSE(trace->is_replayed(series(*trace, "Rig/SHOULDER/q")));
  EXPECT_EQ(trace->value(command, 80, CommandSide::recorded), recorded_.values("Rig/C/output/SHOULDER/u")[80]);
  EXPECT_EQ(trace->value(command, 80, CommandSide::replayed), trace->differences(80).at(0).actual);
  EXPECT_EQ(trace->value(command, 60, CommandSide::replayed), trace->value(command, 60, CommandSide::recorded));
  const TickView view = trace->view(80);
  const ViewChannel* output = channel(view, "/Rig/C/output/joints");
  ASSERT_NE(output, nullptr);
  ASSERT_TRUE(output->values.at(0).replayed);
  EXPECT_EQ(*output->values[0].replayed, trace->differences(80).at(0).actual);
  EXPECT_GT(output->values[0].ulps, 0u);
}

TEST_F(Stepped, GoesToWhereItBeginsToDifferFromBothSides) {
  record_hinge();
  const auto trace = opened(changed());
  EXPECT_EQ(trace->happening(0, Direction::forwards), changed_from);
  EXPECT_EQ(trace->happening(99, Direction::backwards), changed_from);
  EXPECT_EQ(trace->happening(changed_from, Direction::forwards), std::nullopt);
  EXPECT_EQ(trace->happening(changed_from, Direction::backwards), std::nullopt);
}

TEST_F(Stepped, DiffersWhereAControllerWritesAnotherLine) {
  record_run(rig_with("lines none last"));
  SteppingOptions options;
  options.controllers["Rig/C"] = {"Behaviours", "lines none other", true, false, {}};
  const auto trace = opened(options);
  EXPECT_FALSE(trace->differs_at(1));
  EXPECT_TRUE(trace->differs_at(2));
  ASSERT_THAT(trace->differences(2), SizeIs(1));
  EXPECT_EQ(trace->differences(2)[0].channel, "/events");
  EXPECT_THAT(trace->differences(2)[0].note, HasSubstr("other words"));
}

TEST_F(Stepped, ReplaysOnlyAsFarAsIsAskedFor) {
  record_hinge();
  SteppingOptions options = changed();
  options.last_tick = 75;
  const auto trace = opened(options);
  EXPECT_EQ(trace->last_replayed(), 75);
  EXPECT_FALSE(trace->view(76).is_replayed);
  EXPECT_TRUE(std::isnan(trace->value(series(*trace, "output/SHOULDER/u"), 76, CommandSide::replayed)));
}

TEST_F(Stepped, SaysWhichTickIsTheLast) {
  record_hinge();
  SteppingOptions options;
  options.last_tick = 100;
  const auto trace = SteppedTrace::open(path("run.mcap"), options);
  ASSERT_FALSE(trace.ok());
  EXPECT_THAT(to_string(trace.errors()), HasSubstr("there is no tick 100: the last is 99 (0.099 s)"));
}

TEST_F(Stepped, ALibraryThatIsGoneLeavesWhatWasRecorded) {
  record_hinge();
  setenv("REHEARSE_CONTROLLER_PATH", folder_.path().c_str(), 1);
  const auto trace = opened();
  ASSERT_NE(trace, nullptr);
  EXPECT_FALSE(trace->last_replayed());
  EXPECT_THAT(to_string(trace->remarks()),
              HasSubstr("the controllers can't be replayed: all shown values are recorded ones"));
  EXPECT_FALSE(has_error(trace->remarks()));
  const TickView view = trace->view(50);
  EXPECT_FALSE(view.is_replayed);
  EXPECT_NE(channel(view, "/Rig/C/output/joints"), nullptr);
}

TEST_F(Stepped, ALibraryThatIsAskedForHasToBeThere) {
  record_hinge();
  SteppingOptions options;
  options.libraries["C"] = path("none.so").string();
  EXPECT_FALSE(SteppedTrace::open(path("run.mcap"), options).ok());
}

TEST_F(Stepped, ACutRecordingIsThereUpToItsEnd) {
  record_run(rig(behaviour("C", "feel"), "cameras: none\n", "4"));
  std::filesystem::resize_file(path("run.mcap"), std::filesystem::file_size(path("run.mcap")) / 2);
  const auto trace = opened();
  ASSERT_NE(trace, nullptr);
  ASSERT_FALSE(trace->remarks().empty());
  EXPECT_THAT(trace->remarks()[0].message, HasSubstr("truncated at byte"));
  EXPECT_EQ(trace->remarks()[0].severity, Severity::warning);
  EXPECT_LT(trace->last_tick(), 3999);
  ASSERT_GT(trace->last_tick(), 100);
  EXPECT_EQ(trace->last_replayed(), trace->last_tick());
  EXPECT_THAT(trace->view(trace->last_tick()).differences, IsEmpty());
}

TEST_F(Stepped, AFileWithoutTicksIsRefused) {
  write("empty.mcap", "");
  EXPECT_FALSE(SteppedTrace::open(path("empty.mcap")).ok());
  EXPECT_FALSE(SteppedTrace::open(path("none.mcap")).ok());
  auto writer = mcap::Writer::create(path("bag.mcap"));
  ASSERT_TRUE(writer.ok());
  ASSERT_TRUE((*writer)->close().ok());
  const auto bag = SteppedTrace::open(path("bag.mcap"));
  ASSERT_FALSE(bag.ok());
  EXPECT_THAT(to_string(bag.errors()), HasSubstr("not a recording of Rehearse"));
}

TEST_F(Stepped, AControllerThatFailsLeavesTheTicksBehindAsRecorded) {
  record_hinge();
  // the same names, and a different library that throws in tick 7
  SteppingOptions options;
  options.controllers["Rig/C"] = {"Behaviours", "fail throw control 7", true, false, {}};
  const auto trace = opened(options);
  ASSERT_NE(trace, nullptr);
  ASSERT_TRUE(trace->failure());
  EXPECT_EQ(trace->last_replayed(), 6);
  EXPECT_FALSE(trace->view(7).is_replayed);
  const auto said = trace->messages(7);
  ASSERT_FALSE(said.empty());
  EXPECT_THAT(said[0].text, HasSubstr("no gait for this slope"));
  EXPECT_EQ(said[0].where, ViewMessage::Where::replayed);
}

TEST_F(Stepped, KnowsContactsAtEachTick) {
  record_run(
      "rehearse: 1\nduration: 0.4\nbodies:\n  - {name: Floor, box: {size: [4, 4, 0.2]}, fixed: true, position: [0, 0, "
      "-0.1]}\n  - {name: Box, box: {size: [0.2, 0.2, 0.2]}, mass: 1, position: [0, 0, 0.2]}\n");
  const auto trace = opened();
  ASSERT_NE(trace, nullptr);
  const auto lands = trace->happening(0, Direction::forwards);
  ASSERT_TRUE(lands);
  EXPECT_GT(*lands, 100) << "0.1 m take 0.14 s";
  const auto links = trace->find_links("Box");
  ASSERT_TRUE(links.ok());
  EXPECT_TRUE(trace->touching(*links, {}, *lands));
  EXPECT_FALSE(trace->touching(*links, {}, *lands - 1));
  ASSERT_THAT(trace->contacts(*lands), SizeIs(1));
  EXPECT_TRUE(trace->contacts(*lands)[0].began);
  EXPECT_THAT(trace->contacts(0), IsEmpty());

  const auto expression = Expression::parse("contact(Box, Floor)", *trace);
  ASSERT_TRUE(expression.ok());
  std::vector<TickSpanFound> spans;
  find_spans(*expression, *trace, 0, trace->last_tick(), [&](const TickSpanFound& span) {
    spans.push_back(span);
    return true;
  });
  ASSERT_FALSE(spans.empty());
  EXPECT_EQ(spans[0].first, *lands);
  EXPECT_EQ(find_tick(*expression, *trace, 0, Direction::forwards), lands);
  EXPECT_EQ(find_tick(*expression, *trace, *lands, Direction::forwards),
            spans.size() > 1 ? std::optional(spans[1].first) : std::nullopt);
}

TEST_F(Stepped, ASearchCanBeInterrupted) {
  record_hinge();
  const auto trace = opened();
  const auto expression = Expression::parse("tick > 90", *trace);
  ASSERT_TRUE(expression.ok());
  int asked = 0;
  EXPECT_EQ(find_tick(*expression, *trace, 0, Direction::forwards, [&] { return ++asked > 10; }), std::nullopt);
  EXPECT_EQ(asked, 11);
}

TEST_F(Stepped, SaysWhichSeriesAreNear) {
  record_run(
      "rehearse: 1\nduration: 0.3\nbodies:\n  - {name: Floor, box: {size: [4, 4, 0.2]}, fixed: true, position: [0, 0, "
      "-0.1]}\n  - {name: Box, box: {size: [0.2, 0.2, 0.2]}, mass: 1, position: [0, 0, 0.2]}\n");
  const auto trace = opened();
  EXPECT_TRUE(trace->find_series("Box/Box/position/z").ok());
  const auto none = trace->find_series("Box/Box/positon/z");
  ASSERT_FALSE(none.ok());
  EXPECT_THAT(none.errors()[0].hint, HasSubstr("did you mean"));
}

TEST_F(Stepped, GivesTheLatestPictureAtOrBeforeATick) {
  record_run(rig("", ""));
  const auto trace = opened();
  ASSERT_NE(trace, nullptr);
  ASSERT_FALSE(trace->picture_topics().empty());
  const auto late = trace->picture("Camera", 19);
  ASSERT_TRUE(late.ok()) << to_string(late.errors());
  EXPECT_LE(late->tick, 19);
  EXPECT_EQ(late->extension, "png");
  EXPECT_FALSE(late->bytes.empty());
  const auto same = trace->picture("Camera", late->tick);
  ASSERT_TRUE(same.ok());
  EXPECT_EQ(same->tick, late->tick);
  const auto before = trace->picture("Camera", late->tick - 1);
  if (before) {
    EXPECT_LT(before->tick, late->tick);
  }
  EXPECT_FALSE(trace->picture("Cammera", 19).ok());
}

/// A replay of a behaviour with options other than the recorded ones.
SteppingOptions as(const std::string& behaviour) {
  SteppingOptions options;
  options.controllers["Rig/C"] = {"Behaviours", behaviour, true, false, {}};
  return options;
}

TEST_F(Stepped, HasVariablesThatOnlyTheReplayedControllersSet) {
  record_run(rig(behaviour("C", "lines quietly famous"), "cameras: none\n", "0.005"));
  const auto trace = opened(as("variables 0.25"));
  ASSERT_NE(trace, nullptr);
  const std::size_t phase = series(*trace, "variable/phase"), even = series(*trace, "Rig/C/variable/even");
  EXPECT_EQ(trace->value(phase, 4, CommandSide::recorded), 1.0);
  EXPECT_TRUE(std::isnan(trace->value(phase, 3, CommandSide::recorded)));
  EXPECT_EQ(trace->value(phase, 2, CommandSide::recorded), 0.5);
  EXPECT_EQ(trace->value(even, 3, CommandSide::recorded), 2.0);  // the latest
  const TickView view = trace->view(3);
  ASSERT_NE(channel(view, "/Rig/C/variable/phase"), nullptr);
  EXPECT_EQ(channel(view, "/Rig/C/variable/even"), nullptr);  // not set in that tick
}

TEST_F(Stepped, ShowsVariablesAsTheyWereAndAsTheyAreNow) {
  record_run(rig(behaviour("C", "variables 0.25"), "cameras: none\n", "0.005"));
  const auto trace = opened(as("variables 0.5"));
  ASSERT_NE(trace, nullptr);
  const std::size_t phase = series(*trace, "variable/phase");
  EXPECT_TRUE(trace->is_replayed(phase));
  EXPECT_EQ(trace->value(phase, 4, CommandSide::recorded), 1.0);
  EXPECT_EQ(trace->value(phase, 4, CommandSide::replayed), 2.0);
  const TickView view = trace->view(4);
  const ViewChannel* shown = channel(view, "/Rig/C/variable/phase");
  ASSERT_NE(shown, nullptr);
  ASSERT_THAT(shown->values, SizeIs(1));
  EXPECT_EQ(shown->values[0].value, 1.0);
  EXPECT_EQ(shown->values[0].replayed, 2.0);
  EXPECT_FALSE(channel(view, "/Rig/C/variable/even")->values[0].replayed) << "it is the same";
}

}  // namespace
}  // namespace rehearse
