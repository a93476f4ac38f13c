// The cost of a campaign's case, and the gain by a second worker.
#include <rehearse/session.h>
#include <rehearse/sweep.h>

#include <filesystem>
#include <fstream>

#include "pairs.h"
#include "sr1_run.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// One second of SR1 without pictures. The parameter that varies changes its arm so little that all cases cost the
/// same.
fs::path varied_scenario() {
  const fs::path file = Sr1Run::instance().folder() / "varied.yaml";
  std::ofstream(file) << R"(rehearse: 1
duration: 1
cameras: none
bodies:
  - {name: Floor, box: {size: [10, 10, 0.2]}, fixed: true, position: [0, 0, -0.1]}
  - name: SR1
    model: )" FIXTURES_DIR R"(/models/sr1.urdf
    position: [0, 0, 0.7135]
    joints: {RARM_ELBOW: -90 deg}
    controllers: [{name: SR1Minimum, library: SR1MinimumController}]
vary:
  elbow: {path: bodies.SR1.joints.RARM_ELBOW, uniform: [-91, -89]}
)";
  return file;
}

Simulation simulation() { return {record, run_plant, describe_plant, record_from}; }

/// Runs all cases of a new campaign, of which `prepare` made the folder.
class Sweeps {
 public:
  Sweeps(const char* name, std::int64_t cases) : folder_(Sr1Run::instance().folder() / name), cases_(cases) {}
  Campaign prepare() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
    CampaignOptions options;
    options.cases = cases_;
    return must(create_campaign(varied_scenario(), folder_, options, simulation()));
  }
  static void run(Campaign& campaign, std::size_t jobs) {
    SweepOptions options;
    options.jobs = jobs;
    must_succeed(run_cases(campaign, options, simulation()));
  }

 private:
  static void must_succeed(const Result<void>& result) {
    if (result) return;
    std::fputs(to_string(result.errors()).c_str(), stderr);
    std::exit(1);
  }
  fs::path folder_;
  std::int64_t cases_;
};

/// Work: the cases of a campaign, by one worker. Base: as many recordings of the same scenario. A case is recorded,
/// judged and forgotten.
void case_over_record(benchmark::State& state) {
  const Scenario scenario = must(Scenario::load(varied_scenario()));
  constexpr std::int64_t cases = 6;
  Sweeps sweeps("one_worker", cases);
  Pairs pairs(CLOCK_MONOTONIC);
  for (auto _ : Repeated(state)) {
    Campaign campaign = sweeps.prepare();
    std::int64_t runs = cases;
    for (std::int64_t number = 0; number < cases; ++number) runs += campaign.runs_twice(number) ? 1 : 0;
    const auto records = [&] {
      for (std::int64_t i = 0; i < runs; ++i) must(record(scenario, Sr1Run::instance().folder() / "case.mcap"));
    };
    state.SetIterationTime(pairs.measure([&] { Sweeps::run(campaign, 1); }, records));
  }
  pairs.report(state, cases, cases);
}
BENCHMARK(case_over_record)->UseManualTime()->Unit(benchmark::kMillisecond);

/// Work: a campaign with two workers. Base: with one.
void two_workers_over_one(benchmark::State& state) {
  constexpr std::int64_t cases = 24;  // the second runs come after all first ones
  Sweeps two("two_workers", cases), one("one_worker", cases);
  Pairs pairs(CLOCK_MONOTONIC);
  for (auto _ : Repeated(state)) {
    Campaign by_two = two.prepare(), by_one = one.prepare();
    state.SetIterationTime(pairs.measure([&] { Sweeps::run(by_two, 2); }, [&] { Sweeps::run(by_one, 1); }));
  }
  pairs.report(state, cases, cases);
}
BENCHMARK(two_workers_over_one)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rehearse
