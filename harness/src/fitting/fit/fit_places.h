// The numbers of a scenario that are fitted: their paths, nominal values and bounds. Internal.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/fit.h>
#include <rehearse/scenario.h>

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

struct FitPlace {
  std::string path, unit;
  double nominal = 0.0;
  double low = 0.0, high = 0.0;
  bool has_usual_bounds = false;       // neither the request nor the scenario states them
  std::optional<double> mean, stddev;  // of `normal` in `vary:`: what is known before
  double step = 0.0;                   // of finite differences, at least; 0: it follows from the value
  bool is_delay = false;               // its best value is searched before the iterations

  double range() const { return high - low; }
  /// The step of a central difference at a value.
  double step_at(double value) const;
};

class FitPlaces {
 public:
  static Result<FitPlaces> find(const std::filesystem::path& scenario, const std::vector<FitRequest>& requests);

  std::size_t size() const { return places_.size(); }
  const FitPlace& operator[](std::size_t i) const { return places_[i]; }
  const Scenario& nominal() const { return scenario_; }
  /// The text of the scenario with these numbers, without keys of campaigns. NaN: the number as it is stated.
  Result<std::string> text_with(const Eigen::VectorXd& numbers) const;
  Result<Scenario> scenario_with(const Eigen::VectorXd& numbers) const;

 private:
  Scenario scenario_;  // its variations are the places
  std::vector<FitPlace> places_;
};

}  // namespace rehearse
