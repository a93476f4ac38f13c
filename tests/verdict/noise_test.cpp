// Noise and faults: on every fixture with contacts, irrelevant perturbations stay within tolerance on the levels
// controller and plant, and small faults of the plant are far above it. Prints a table of both.
#include <rehearse/session.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/check/noise_floor.h"
#include "support/printed_by_name.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// A line of the table: the largest differences of velocities, in m/s or rad/s, whichever is larger.
struct Row {
  std::string fixture, fault;
  double noise = 0.0, difference = 0.0;
  double over_noise() const { return difference / noise; }
};

/// Prints the rows of all tests of this process after the last one.
class Table : public ::testing::Environment {
 public:
  static std::vector<Row>& rows() {
    static std::vector<Row> all;
    return all;
  }
  void TearDown() override {
    if (rows().empty()) return;
    fmt::print("\n{:<18} {:>10}  {:<34} {:>10}  {:>10}\n", "fixture, plant", "noise", "fault", "differs by",
               "over noise");
    for (const Row& row : rows())
      fmt::print("{:<18} {:>10.2g}  {:<34} {:>10.2g}  {:>10.2g}\n", row.fixture, row.noise, row.fault, row.difference,
                 row.over_noise());
    fmt::print("differences of velocities [m/s, rad/s] over {} s; the last bit of 1 counts as the least noise\n",
               NOISE_SECONDS);
  }
};
const ::testing::Environment* const table = ::testing::AddGlobalTestEnvironment(new Table);

struct Fixture {
  const char* name;  // of the scenario
  /// True if any contact slips, so that friction matters: without slipping, 20 % less friction has no effect. Empty: 1
  /// % less has none, and 20 % less lets one slip.
  std::optional<bool> slips = true;
  /// True if a mass matters: drives without a limit move what they carry as before, whatever it weighs.
  bool weighs = true;
  /// The link that becomes heavier; empty: the heaviest. An arm with position-controlled joints moves as before.
  const char* link = nullptr;
  double share = 1.0;        // of the time
  double least_ratio = 1e6;  // a fault over the noise
};

class Noise : public ::testing::TestWithParam<Fixture> {
 protected:
  Scenario scenario() const {
    auto loaded = Scenario::load(fs::path(FIXTURES_DIR) / "scenarios" / fmt::format("{}.yaml", GetParam().name));
    EXPECT_TRUE(loaded) << to_string(loaded.errors());
    loaded->duration = NOISE_SECONDS * GetParam().share;
    return *std::move(loaded);
  }
  Trace loaded(const fs::path& file) const {
    auto trace = Trace::load(file);
    EXPECT_TRUE(trace) << to_string(trace.errors());
    return *std::move(trace);
  }
  Trace recorded(const Scenario& scenario) const {
    const auto run = record(scenario, folder_ / "run.mcap");
    EXPECT_TRUE(run && !run->failure) << to_string(run ? Diagnostics{*run->failure} : run.errors());
    return loaded(folder_ / "run.mcap");
  }
  Comparison plant(const Scenario& scenario, const Trace& recording) const {
    const auto run = run_plant(scenario, recording, folder_ / "fault.mcap");
    EXPECT_TRUE(run) << to_string(run.errors());
    EXPECT_EQ(run->from_the_start, "");
    CompareOptions what;
    what.stages = {Stage::physics, Stage::sensors, Stage::renderer};
    return compare(recording, loaded(folder_ / "fault.mcap"), scenario.tolerances, what);
  }

  const test::TemporaryFolder folder_;
};

double largest_speed(const Comparison& comparison) {
  double largest = 0.0;
  for (const ChannelComparison& channel : comparison.channels)
    for (const SeriesComparison& series : channel.series)
      if (series.unit == "m/s" || series.unit == "rad/s") largest = std::max(largest, series.largest);
  return largest;
}

Model& own_model(ScenarioBody& body) {
  auto copy = std::make_shared<Model>(*body.model);
  Model& model = *copy;
  body.model = std::move(copy);
  return model;
}

/// Reduces the friction of every contact.
Scenario with_less_friction(Scenario scenario, double share) {
  scenario.solver.friction *= 1.0 - share;
  for (ScenarioBody& body : scenario.bodies)
    for (Link& link : own_model(body).links)
      for (std::optional<double>* friction : {&link.surface.friction, &link.surface.second_friction})
        if (*friction) **friction *= 1.0 - share;
  return scenario;
}

/// True if the link can move: its body is free, or there is a joint between it and a fixed link.
bool moves(const ScenarioBody& body, std::size_t index) {
  for (int link = static_cast<int>(index); link >= 0; link = body.model->links[link].parent) {
    const JointType joint = body.model->links[link].joint.type;
    const bool root = body.model->links[link].parent < 0;
    if (root ? !body.fixed : joint != JointType::fixed && joint != JointType::track) return true;
  }
  return false;
}

/// The link to which a gram matters least, or the link of that name.
std::pair<std::size_t, std::size_t> heaviest_link(const Scenario& scenario, const char* name) {
  std::pair<std::size_t, std::size_t> heaviest;
  double mass = 0.0;
  for (std::size_t b = 0; b < scenario.bodies.size(); ++b) {
    const ScenarioBody& body = scenario.bodies[b];
    if (body.kinematic) continue;
    for (std::size_t i = 0; i < body.model->links.size(); ++i) {
      const Link& link = body.model->links[i];
      if (!moves(body, i) || link.inertial.mass <= mass || (name && link.name != name)) continue;
      mass = link.inertial.mass;
      heaviest = {b, i};
    }
  }
  return heaviest;
}

Scenario with_a_heavier_link(Scenario scenario, std::pair<std::size_t, std::size_t> which) {
  own_model(scenario.bodies[which.first]).links[which.second].inertial.mass += 0.001;
  return scenario;
}

TEST_P(Noise, IsWithinToleranceAndFarBelowFaults) {
  const Scenario scenario = this->scenario();
  const Trace recording = recorded(scenario);
  NoiseOptions options;
  options.closed = false;
  options.scratch = folder_ / "perturbed";
  options.program = SIMULATOR;
  const auto noise = measure_noise(scenario, recording, {rehearse::record, run_plant}, options);
  ASSERT_TRUE(noise) << to_string(noise.errors());
  int made = 0;
  for (const Perturbation& perturbation : noise->perturbations) {
    EXPECT_FALSE(perturbation.beyond) << perturbation.name << ": " << to_string(*perturbation.beyond);
    made += perturbation.not_made.empty() ? 1 : 0;
    if (!perturbation.not_made.empty())
      fmt::print("{}: {}: not made: {}\n", scenario.name, perturbation.name, perturbation.not_made);
  }
  EXPECT_GE(made, options.patterns);

  const double speed_noise = std::max(noise->of_unit("m/s"), noise->of_unit("rad/s"));
  const auto heaviest = heaviest_link(scenario, GetParam().link);
  const Link& link = scenario.bodies[heaviest.first].model->links[heaviest.second];
  const auto find = [&](const std::string& fault, const Scenario& faulty) {
    const Comparison found = plant(faulty, recording);
    EXPECT_FALSE(found.within) << fault << " was not found";
    const Row row{scenario.name, fault, speed_noise, largest_speed(found)};
    EXPECT_GE(row.over_noise(), GetParam().least_ratio) << fault;
    Table::rows().push_back(row);
  };
  const std::string heavier = fmt::format("1 g more of {:g} kg, {}", link.inertial.mass, link.name);
  if (GetParam().weighs)
    find(heavier, with_a_heavier_link(scenario, heaviest));
  else
    EXPECT_TRUE(plant(with_a_heavier_link(scenario, heaviest), recording).within) << heavier << " matters after all";
  const std::optional<bool>& slips = GetParam().slips;
  if (slips.value_or(false))
    find("friction 1 % less", with_less_friction(scenario, 0.01));
  else
    EXPECT_TRUE(plant(with_less_friction(scenario, 0.01), recording).within) << "something slips after all";
  if (slips.value_or(true)) return;
  EXPECT_TRUE(plant(with_less_friction(scenario, 0.2), recording).within) << "something slips after all";
}

// sr1_minimum is sr1_standing with cameras: pictures take long, so most of its seconds are left to the other. In
// mesh_arm fingers hold the block whatever it weighs: the forces on it differ, beside those with which the fingers
// press.
INSTANTIATE_TEST_SUITE_P(
    Of, Noise,
    ::testing::Values(Fixture{"camera_follower", false, false}, Fixture{"drop_box"},
                      Fixture{"mesh_arm", true, true, "Block", 1.0, 5e2}, Fixture{"parent_and_child"},
                      Fixture{"playback", false, false}, Fixture{"quadruped"}, Fixture{"room", std::nullopt},
                      Fixture{"rover", true, false}, Fixture{"sr1_minimum", false, true, nullptr, 0.3},
                      Fixture{"sr1_squat", false}, Fixture{"sr1_standing", false}, Fixture{"tank"}),
    test::by_name);

}  // namespace
}  // namespace rehearse
