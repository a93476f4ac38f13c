#include "plant_level.h"

#include <fmt/format.h>

#include "base/clock.h"

namespace rehearse {

Result<void> make_folder_of(const std::filesystem::path& file) {
  std::error_code failed;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), failed);
  if (failed)
    return error(fmt::format("the folder {} can't be made: {}", file.parent_path().string(), failed.message()));
  return {};
}

Result<PlantLevel> compare_plant(const Simulation& simulation, const Scenario& scenario, const Trace& golden,
                                 const std::filesystem::path& file, const PlantOptions& options,
                                 const NoiseOfSeries& noise) {
  REHEARSE_TRY(make_folder_of(file));
  auto run = REHEARSE_TRY(simulation.run_plant(scenario, golden, file, options));
  auto trace = REHEARSE_TRY(Trace::outline(file));
  CompareOptions what;
  what.stages = stages_of_plant;
  what.noise_floors = noise;
  if (options.until) what.until = time_of(*options.until, scenario.time_step);
  auto comparison = REHEARSE_TRY(compare(golden.file(), file, scenario.tolerances, what));
  return PlantLevel{std::move(run), std::move(trace), std::move(comparison)};
}

}  // namespace rehearse
