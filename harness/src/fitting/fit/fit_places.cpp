#include "fit_places.h"

#include <fmt/format.h>
#include <rehearse/units.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "core/scenario/scenario_variations.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr double share_of_step = 1e-3;   // of a value
constexpr double share_of_range = 1e-5;  // of the bounds' distance, at least
constexpr double tick_share = 0.1;       // of a tick, for delays
constexpr double prior_span = 4.0;       // standard deviations of `normal` that are its bounds
constexpr double usual_factor = 10.0;    // from a stated number to its bounds

/// The unit behind a number of the text; empty: there is none.
std::string unit_behind(const std::string& text, std::size_t end) {
  const std::size_t stop = std::min(text.find_first_of(",]}#\n", end), text.size());
  std::string unit = text.substr(end, stop - end);
  unit.erase(0, std::min(unit.find_first_not_of(' '), unit.size()));
  unit.erase(unit.find_last_not_of(" \r") + 1);
  return factor_of_spelling(unit) ? unit : std::string();
}

/// Takes the bounds of an entry of `vary:`. False: it has none.
bool take_bounds(const Variation& entry, FitPlace& place) {
  if (entry.distribution == Distribution::uniform || entry.distribution == Distribution::log_uniform) {
    place.low = entry.low;
    place.high = entry.high;
    return true;
  }
  if (entry.distribution != Distribution::normal) return false;
  place.mean = entry.mean;
  place.stddev = entry.stddev;
  place.low = std::max(entry.low, entry.mean - prior_span * entry.stddev);
  place.high = std::min(entry.high, entry.mean + prior_span * entry.stddev);
  return true;
}

Result<void> set_bounds(const FitRequest& request, const Variation* entry, const std::string& file, FitPlace& place) {
  if (request.low && request.high) {
    place.low = *request.low;
    place.high = *request.high;
  } else if (entry && entry->integer) {
    return at(entry->place, error(fmt::format("'{}' is varied in whole numbers, which can't be fitted", place.path)));
  } else if (!entry || !take_bounds(*entry, place)) {
    if (place.nominal == 0.0)
      return error_in(file, fmt::format("'{}' is 0, from which no bounds follow", place.path),
                      fmt::format("state them: --vary {}=LOW..HIGH", place.path));
    place.has_usual_bounds = true;
    place.low = std::min(place.nominal / usual_factor, place.nominal * usual_factor);
    place.high = std::max(place.nominal / usual_factor, place.nominal * usual_factor);
  }
  if (place.low >= place.high)
    return error_in(
        file, fmt::format("the bounds of '{}' end at {}, which isn't above their beginning", place.path, place.high));
  return {};
}

}  // namespace

double FitPlace::step_at(double value) const {
  return step > 0.0 ? step : std::max(share_of_step * std::abs(value), share_of_range * range());
}

Result<FitPlaces> FitPlaces::find(const fs::path& file, const std::vector<FitRequest>& requests) {
  const auto stated = REHEARSE_TRY(Scenario::load(file));
  std::string text = stated.text;
  for (const char* key : {"vary", "golden", "plan", "pass_rate", "sometimes"})
    text = REHEARSE_TRY(text_without(text, stated.file, key));
  if (!text.ends_with('\n')) text += '\n';
  text += "vary:\n";
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const std::string& path = requests[i].path;
    if (path.find_first_of("\"\\\n") != std::string::npos)
      return error_in(stated.file, fmt::format("{} is no path of a number", in_quotes(path)));
    text += fmt::format("  number_{}: {{path: \"{}\", uniform: [-1.0e+11, 1.0e+11]}}\n", i, path);
  }
  FitPlaces places;
  auto with_places = Scenario::load_text(std::move(text), file);
  if (!with_places) {  // the lines of the places aren't the user's
    Diagnostics mistakes = with_places.errors();
    for (Diagnostic& mistake : mistakes) mistake.line = mistake.column = 0;
    return mistakes;
  }
  places.scenario_ = *std::move(with_places);
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const Variation& variation = places.scenario_.variations[i];
    FitPlace place;
    place.path = requests[i].path;
    place.nominal = number_in<double>(variation.nominal).value_or(std::numeric_limits<double>::quiet_NaN());
    if (variation.before.empty()) place.unit = unit_behind(places.scenario_.text, variation.end);
    const auto entry =
        std::ranges::find_if(stated.variations, [&](const Variation& v) { return v.path == place.path; });
    REHEARSE_TRY(set_bounds(requests[i], entry == stated.variations.end() ? nullptr : &*entry, stated.file, place));
    place.is_delay = place.path.ends_with(".delay");
    if (place.is_delay)
      place.step =
          tick_share * stated.time_step / factor_of_spelling(place.unit.empty() ? "s" : place.unit).value_or(1.0);
    places.places_.push_back(std::move(place));
  }
  return places;
}

Result<std::string> FitPlaces::text_with(const Eigen::VectorXd& numbers) const {
  std::vector<std::string> values;
  for (const double number : numbers) values.push_back(std::isfinite(number) ? fmt::format("{}", number) : "");
  auto text = REHEARSE_TRY(scenario_.varied_text(values));
  return text_without(text, scenario_.file, "vary");
}

Result<Scenario> FitPlaces::scenario_with(const Eigen::VectorXd& numbers) const {
  auto text = REHEARSE_TRY(text_with(numbers));
  return Scenario::load_text(std::move(text), scenario_.file);
}

}  // namespace rehearse
