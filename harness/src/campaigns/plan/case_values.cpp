#include "case_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/mcap/hashing.h"
#include "core/scenario/normal_quantile.h"
#include "csv_text.h"
#include "model/names.h"
#include "model/text.h"

namespace rehearse {
namespace {

/// The share of a standard normal distribution below x.
double normal_share(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

/// Computed from the nearer tail, where shares have all their digits.
double truncated_normal(const Variation& variation, double probability) {
  const double low = (variation.low - variation.mean) / variation.stddev;
  const double high = (variation.high - variation.mean) / variation.stddev;
  const bool mirrored = low > 0.0;
  const double from = normal_share(mirrored ? -high : low), to = normal_share(mirrored ? -low : high);
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
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found != names_.end()) return static_cast<std::size_t>(found - names_.begin());
    return error(fmt::format("no parameter before it is named '{}'", name), name_hint(name, names_, "parameters"));
  }
  bool is_replayed(std::size_t) const override { return false; }
  bool has_replay() const override { return false; }
  Result<std::vector<std::size_t>> find_links(std::string_view) override {
    return error("a linked value has no contacts");
  }
  std::int64_t first_tick() const override { return 0; }
  double time_at(std::int64_t) const override { return 0.0; }
  double value(std::size_t series, std::int64_t, CommandSide) override { return values_[series]; }
  bool touching(const std::vector<std::size_t>&, const std::vector<std::size_t>&, std::int64_t) override {
    return false;
  }
  bool differs_at(std::int64_t) override { return false; }
  bool said(std::string_view, std::int64_t) override { return false; }

 private:
  std::vector<std::string> names_;
  std::vector<double> values_;
};

}  // namespace

Result<std::shared_ptr<const CaseValues>> CaseValues::make(const Scenario& scenario, std::uint64_t seed) {
  const std::shared_ptr<CaseValues> made(new CaseValues(scenario, seed));
  for (std::size_t i = 0; i < made->variations().size(); ++i) {
    const Variation& variation = made->variations()[i];
    made->lists_.push_back(variation.values);
    if (variation.distribution == Distribution::from_file)
      if (auto read = made->read_column(variation, made->lists_.back()); !read) return read.errors();
    if (variation.distribution == Distribution::linked)
      if (auto parsed = made->parse_link(i); !parsed) return parsed.errors();
  }
  return std::shared_ptr<const CaseValues>(made);
}

Result<void> CaseValues::read_column(const Variation& variation, std::vector<std::string>& rows) const {
  const std::filesystem::path file = std::filesystem::path(scenario_.file).parent_path() / variation.file;
  const auto table = read_csv(file);
  if (!table) return table.errors();
  const std::vector<std::string>& heading = table->front();
  const auto column = std::find(heading.begin(), heading.end(), variation.column);
  if (column == heading.end())
    return at(variation.place, error(fmt::format("{} has no column '{}'", variation.file, variation.column),
                                     name_hint(variation.column, heading, "columns")));
  const auto index = static_cast<std::size_t>(column - heading.begin());
  for (std::size_t row = 1; row < table->size(); ++row) {
    if (index >= (*table)[row].size() || (*table)[row][index].empty())
      return error_in(file.string(), fmt::format("row {} has no value in column '{}'", row, variation.column));
    rows.push_back((*table)[row][index]);
  }
  if (rows.empty()) return error_in(file.string(), "there are no values below the first line");
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
  const Variation& variation = variations()[index];
  const double random = uniform_number(seed_, number, variation.name);
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
      const auto text = scenario_.varied_text(with_links(values));
      if (!text) return text.errors();
      const auto varied = Scenario::load_text(*text, scenario_.file);
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

double uniform_number(std::uint64_t seed, std::int64_t number, std::string_view name) {
  static_assert(std::endian::native == std::endian::little);
  const std::uint64_t key[2] = {seed, static_cast<std::uint64_t>(number)};
  const std::uint64_t hash = hash_bytes(name.data(), name.size(), hash_bytes(key, sizeof key));
  return (static_cast<double>(hash >> 12) + 0.5) / static_cast<double>(1ull << 52);
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

void steer(Variation& variation, const SteeredParameter& steered) {
  if (variation.distribution == Distribution::log_uniform) {
    const double half = std::numbers::sqrt3 * steered.stddev;
    variation.low = std::max(variation.low, std::exp(steered.mean - half));
    variation.high = std::min(variation.high, std::exp(steered.mean + half));
    return;
  }
  variation.distribution = Distribution::normal;
  variation.mean = steered.mean;
  variation.stddev = steered.stddev;
}

}  // namespace rehearse
