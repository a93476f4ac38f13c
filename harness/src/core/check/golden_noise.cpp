#include "golden_noise.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

namespace rehearse {

Result<GoldenNoise> GoldenNoise::of(const Trace& golden, std::vector<std::string>& remarks) {
  GoldenNoise noise;
  const std::filesystem::path file = noise_file_of(golden.file());
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return noise;
  noise.golden_ = REHEARSE_TRY(Trace::load(golden.file()));
  auto found = load_noise_floor(file);
  if (found)
    noise.floor_ = *std::move(found);
  else
    remarks.push_back("the measured noise can't be read: " + to_string(found.errors()[0]));
  return noise;
}

std::optional<double> GoldenNoise::estimated_horizon() const {
  return golden_ ? rehearse::estimated_horizon(*golden_) : std::nullopt;
}

void GoldenNoise::judge_tolerances(const Scenario& scenario, CheckReport& report) const {
  if (!floor_) return;
  std::vector<const Comparison*> comparisons;
  if (report.plant_comparison) comparisons.push_back(&*report.plant_comparison);
  if (report.comparison) comparisons.push_back(&*report.comparison);
  for (std::string& remark : noise_remarks(*floor_, *golden_, comparisons)) report.remarks.push_back(std::move(remark));
  if (scenario.horizon && floor_->horizon() && *scenario.horizon >= *floor_->horizon())
    report.remarks.push_back(
        fmt::format("the scenario's horizon, {:g} s, is not before {:g} s, when a perturbed run left the tolerances",
                    *scenario.horizon, *floor_->horizon()));
}

}  // namespace rehearse
