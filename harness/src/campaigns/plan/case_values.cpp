#include "case_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "base/names.h"
#include "base/text.h"
#include "core/scenario/normal_quantile.h"
#include "csv_text.h"

namespace rehearse {
namespace {

/// The share of a standard normal distribution below x.
double normal_share(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

/// The shares of a normal distribution below its bounds, from the nearer tail, where shares have all their digits.
struct NormalPart {
  double from = 0.0, to = 1.0;
  bool mirrored = false;  // of the distribution with the opposite sign
};

NormalPart part_within(const Variation& variation) {
  const double low = (variation.low - variation.mean) / variation.stddev;
  const double high = (variation.high - variation.mean) / variation.stddev;
  if (low > 0.0) return {normal_share(-high), normal_share(-low), true};
  return {normal_share(low), normal_share(high), false};
}

double truncated_normal(const Variation& variation, double probability) {
  const auto [from, to, mirrored] = part_within(variation);
  const double share = from + (to - from) * (mirrored ? 1.0 - probability : probability);
  constexpr double least = std::numeric_limits<double>::min();
  const double x = normal_quantile(std::clamp(share, least, 1.0 - std::numeric_limits<double>::epsilon()));
  return variation.mean + variation.stddev * (mirrored ? -x : x);
}

std::string text_of(const Variation& variation, double value) {
  if (!variation.integer) return fmt::format("{}", value);
  return fmt::format("{:.0f}", value);
}

/// The parameters as the series of an expression.
class Parameters final : public ExpressionSource {
 public:
  explicit Parameters(std::vector<std::string> names) : names_(std::move(names)), values_(names_.size()) {}

  void set(std::size_t index, std::string_view text) {
    values_[index] = number_in<double>(text).value_or(std::numeric_limits<double>::quiet_NaN());
  }

  Result<std::size_t> find_series(std::string_view name) override {
    const auto found = std::ranges::find(names_, name);
    if (found != names_.end()) return static_cast<std::size_t>(found - names_.begin());
    return error(fmt::format("no parameter before it is named '{}'", name), name_hint(name, names_, "parameters"));
  }
  Result<std::vector<std::size_t>> find_links(std::string_view) override {
    return error("a linked value has no contacts");
  }
  double time_at(std::int64_t) const override { return 0.0; }
  double value(std::size_t series, std::int64_t, CommandSide) override { return values_[series]; }
  bool touching(const std::vector<std::size_t>&, const std::vector<std::size_t>&, std::int64_t) override {
    return false;
  }

 private:
  std::vector<std::string> names_;
  std::vector<double> values_;
};

}  // namespace

CaseValues::CaseValues(const Scenario& scenario, std::uint64_t seed, const Steering& steering)
    : scenario_(scenario), seed_(seed), own_share_(steering.own_share), steered_(scenario.variations.size()) {
  for (const SteeredParameter& parameter : steering.steered)
    for (std::size_t i = 0; i < steered_.size(); ++i)
      if (variations()[i].name == parameter.name) steered_[i] = steer(variations()[i], parameter);
}

Result<std::shared_ptr<const CaseValues>> CaseValues::make(const Scenario& scenario, std::uint64_t seed,
                                                           std::int64_t cases, const Steering& steering) {
  const std::shared_ptr<CaseValues> made(new CaseValues(scenario, seed, steering));
  for (std::size_t i = 0; i < made->variations().size(); ++i) {
    const Variation& variation = made->variations()[i];
    made->lists_.push_back(variation.values);
    if (variation.distribution == Distribution::from_file)
      REHEARSE_TRY(made->read_column(variation, made->lists_.back()));
    if (variation.distribution == Distribution::linked) REHEARSE_TRY(made->parse_link(i));
  }
  REHEARSE_TRY(made->make_points(cases));
  return std::shared_ptr<const CaseValues>(made);
}

Result<void> CaseValues::read_column(const Variation& variation, std::vector<std::string>& rows) const {
  const std::filesystem::path file = std::filesystem::path(scenario_.file).parent_path() / variation.file;
  const auto table = REHEARSE_TRY(read_csv(file));
  const std::vector<std::string>& heading = table.front();
  const auto column = std::ranges::find(heading, variation.column);
  if (column == heading.end())
    return at(variation.place, error(fmt::format("{} has no column '{}'", variation.file, variation.column),
                                     name_hint(variation.column, heading, "columns")));
  const auto index = static_cast<std::size_t>(column - heading.begin());
  for (std::size_t row = 1; row < table.size(); ++row) {
    if (index >= table[row].size() || table[row][index].empty())
      return error_in(file.string(), fmt::format("row {} has no value in column '{}'", row, variation.column));
    rows.push_back(table[row][index]);
  }
  if (rows.empty()) return error_in(file.string(), "there are no values below the first line");
  return {};
}

Result<void> CaseValues::make_points(std::int64_t cases) {
  const PlanKind kind = claims_of(scenario_).plan;
  std::vector<std::string> names;
  for (const Variation& variation : variations()) {
    const bool is_drawn = variation.distribution <= Distribution::choice;
    place_.push_back(is_drawn ? std::optional(names.size()) : std::nullopt);
    if (!is_drawn) continue;
    names.push_back(variation.name);
    if (kind == PlanKind::sobol && names.size() > PlanPoints::most_sobol_parameters)
      return at(variation.place,
                error(fmt::format("'{}' is one parameter too many for Sobol's sequence, which has {} here",
                                  variation.name, PlanPoints::most_sobol_parameters),
                      "expected plan: random or latin_hypercube, or fewer parameters that are drawn"));
  }
  if (cases == 0) {
    cases = REHEARSE_TRY(round());
  }
  if (kind == PlanKind::latin_hypercube && cases > PlanPoints::most_latin_cases)
    return error_in(scenario_.file,
                    fmt::format("a Latin hypercube of {} cases is too large; it has at most {}", cases,
                                PlanPoints::most_latin_cases),
                    "expected plan: random or sobol, or fewer --cases");
  points_.emplace(kind, seed_, std::move(names), cases);
  return {};
}

Result<void> CaseValues::parse_link(std::size_t index) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < index; ++i) names.push_back(variations()[i].name);
  Parameters parameters(names);
  auto parsed = Expression::parse(variations()[index].expression, parameters);
  const Place& place = variations()[index].place;
  if (!parsed)
    return at(place,
              error(fmt::format("linked '{}': {}", variations()[index].expression, parsed.errors().front().message),
                    parsed.errors().front().hint));
  if (parsed->type() != Expression::Type::number)
    return at(place,
              error(fmt::format("linked '{}' is true or false", variations()[index].expression), "expected a number"));
  links_.emplace(index, *std::move(parsed));
  return {};
}

std::string CaseValues::drawn(std::size_t index, std::int64_t number) const {
  const bool is_own = own_share_ > 0.0 && uniform_number(seed_, number, variations()[index].name + "/own") < own_share_;
  const Variation& variation = variations()[index];
  const double random = place_[index] ? points_->at(*place_[index], number) : 0.0;
  if (steered_[index] && !is_own)
    return text_of(variation, std::clamp(quantile_of(*steered_[index], random), variation.low, variation.high));
  const std::vector<std::string>& list = lists_[index];
  const auto row = static_cast<std::size_t>(number);
  switch (variation.distribution) {
    case Distribution::uniform:
    case Distribution::log_uniform:
    case Distribution::normal: return text_of(variation, quantile_of(variation, random));
    case Distribution::choice: return list[static_cast<std::size_t>(random * static_cast<double>(list.size()))];
    case Distribution::from_file: return list[row % list.size()];
    case Distribution::grid: {
      std::size_t before = 1;
      for (std::size_t i = 0; i < index; ++i)
        if (variations()[i].distribution == Distribution::grid) before *= lists_[i].size();
      return list[row / before % list.size()];
    }
    case Distribution::linked: break;
  }
  return {};
}

std::vector<std::string> CaseValues::of(std::int64_t number) const {
  std::vector<std::string> values;
  for (std::size_t i = 0; i < variations().size(); ++i) values.push_back(drawn(i, number));
  return with_links(std::move(values));
}

std::vector<std::string> CaseValues::with_links(std::vector<std::string> values) const {
  if (links_.empty()) return values;
  std::vector<std::string> names;
  for (const Variation& variation : variations()) names.push_back(variation.name);
  Parameters parameters(names);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (const auto link = links_.find(i); link != links_.end())
      values[i] = text_of(variations()[i], link->second.number(parameters, 0));
    parameters.set(i, values[i].empty() ? variations()[i].nominal : values[i]);
  }
  return values;
}

Result<std::int64_t> CaseValues::round() const {
  double size = 1.0;
  std::int64_t grids = 1, rows = 1;
  for (std::size_t i = 0; i < variations().size(); ++i) {
    const auto count = static_cast<std::int64_t>(lists_[i].size());
    if (variations()[i].distribution == Distribution::from_file) rows = std::max(rows, count);
    if (variations()[i].distribution != Distribution::grid) continue;
    size *= static_cast<double>(count);
    if (size > static_cast<double>(most_cases))
      return at(variations()[i].place,
                error(fmt::format("the grids have {:.3g} or more combinations", size),
                      fmt::format("a campaign has at most {} cases; let some parameters be uniform", most_cases)));
    grids *= count;
  }
  return std::max(grids, rows);
}

/// The values that are most likely to be wrong.
std::vector<std::string> CaseValues::extremes(std::size_t index) const {
  const Variation& variation = variations()[index];
  constexpr std::size_t most = 100;
  std::vector<std::string> values = lists_[index];
  if (values.size() > most) values.resize(most);
  if (variation.distribution <= Distribution::normal)
    values = {text_of(variation, variation.low), text_of(variation, variation.high)};
  return values;
}

Result<void> CaseValues::check_bounds() const {
  Diagnostics wrong;
  for (std::size_t i = 0; i < variations().size(); ++i) {
    for (const std::string& value : extremes(i)) {
      std::vector<std::string> values(variations().size());
      values[i] = value;
      const auto text = REHEARSE_TRY(scenario_.varied_text(with_links(values)));
      const auto varied = Scenario::load_text(text, scenario_.file);
      if (varied) continue;
      const Diagnostic& first = varied.errors().front();
      wrong.push_back(
          at(variations()[i].place,
             error(fmt::format("with '{}' at {}: {}", variations()[i].name, value, first.message), first.hint)));
      break;
    }
  }
  return wrong.empty() ? Result<void>() : Result<void>(wrong);
}

double quantile_of(const Variation& variation, double probability) {
  const double low = variation.low, high = variation.high;
  // all whole numbers from low to high are as likely
  if (variation.distribution == Distribution::uniform && variation.integer) {
    const double first = std::ceil(low), count = std::floor(high) - first + 1.0;
    return std::min(first + std::floor(probability * count), std::floor(high));
  }
  double value = low + (high - low) * probability;
  if (variation.distribution == Distribution::log_uniform)
    value = std::exp(std::log(low) + (std::log(high) - std::log(low)) * probability);
  if (variation.distribution == Distribution::normal) value = truncated_normal(variation, probability);
  if (variation.integer) value = std::round(value);
  return std::clamp(value, low, high);
}

double density_of(const Variation& variation, double value) {
  if (value < variation.low || value > variation.high) return 0.0;
  switch (variation.distribution) {
    case Distribution::log_uniform: return 1.0 / (value * std::log(variation.high / variation.low));
    case Distribution::normal: {
      const double x = (value - variation.mean) / variation.stddev;
      const NormalPart part = part_within(variation);
      const double scale = std::sqrt(2.0 * std::numbers::pi) * variation.stddev * (part.to - part.from);
      return std::exp(-0.5 * x * x) / scale;
    }
    default: return 1.0 / (variation.high - variation.low);
  }
}

SteeredVariation steer(const Variation& variation, const SteeredParameter& steered) {
  SteeredVariation made{variation, variation.distribution == Distribution::log_uniform};
  made.variation.distribution = Distribution::normal;
  made.variation.mean = steered.mean;
  made.variation.stddev = steered.stddev;
  if (made.of_logarithm) {
    made.variation.low = std::log(variation.low);
    made.variation.high = std::log(variation.high);
  }
  return made;
}

double quantile_of(const SteeredVariation& steered, double probability) {
  const double quantile = quantile_of(steered.variation, probability);
  return steered.of_logarithm ? std::exp(quantile) : quantile;
}

double density_of(const SteeredVariation& steered, double value) {
  return steered.of_logarithm ? density_of(steered.variation, std::log(value)) / value
                              : density_of(steered.variation, value);
}

}  // namespace rehearse
