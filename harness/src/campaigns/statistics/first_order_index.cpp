// Sobol's first-order index, and the error of its estimate.
#include <rehearse/campaign_report.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

namespace rehearse {
namespace {

/// The ends of parts of sorted values: a part for each value, or as many as the root of their number, of about
/// equal size. Equal values are in one part.
std::vector<std::size_t> parts_of(const std::vector<double>& sorted) {
  std::vector<std::size_t> ends;  // of the runs of equal values
  for (std::size_t i = 1; i <= sorted.size(); ++i)
    if (i == sorted.size() || sorted[i] != sorted[i - 1]) ends.push_back(i);
  const auto most = static_cast<std::size_t>(std::sqrt(static_cast<double>(sorted.size())));
  if (ends.size() <= most) return ends;
  std::vector<std::size_t> parts;
  for (const std::size_t end : ends)
    if (end == sorted.size() || end * most >= (parts.size() + 1) * sorted.size()) parts.push_back(end);
  return parts;
}

/// The outputs in the order of the inputs, and the parts of these.
struct Ordered {
  Ordered(const std::vector<double>& inputs, const std::vector<double>& all_outputs) {
    std::vector<std::size_t> order(inputs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return inputs[a] < inputs[b]; });
    for (const std::size_t i : order) {
      sorted.push_back(inputs[i]);
      outputs.push_back(all_outputs[i]);
    }
    ends = parts_of(sorted);
  }

  std::vector<double> sorted, outputs;  // inputs, and their outputs
  std::vector<std::size_t> ends;        // of the parts
};

/// Steps between neighbours that may be those of the mean, as at both ends of a range that fails: without them few
/// failures, which two thresholds explain, would look like noise.
constexpr std::size_t steps_of_mean = 2;

/// The squares of deviations: from the mean of all, from that of the part, and half of those between neighbours in a
/// part, without the largest between different inputs.
struct Squares {
  explicit Squares(const Ordered& ordered) {
    const std::vector<double>& y = ordered.outputs;
    const double n = static_cast<double>(y.size()), mean = std::accumulate(y.begin(), y.end(), 0.0) / n;
    std::vector<double> steps;
    std::size_t begin = 0;
    for (const std::size_t end : ordered.ends) {
      const double size = static_cast<double>(end - begin);
      const auto first = y.begin() + static_cast<std::ptrdiff_t>(begin);
      const double of_part = std::accumulate(first, first + static_cast<std::ptrdiff_t>(end - begin), 0.0) / size;
      for (std::size_t i = begin; i < end; ++i) {
        within.push_back((y[i] - of_part) * (y[i] - of_part));
        all.push_back((y[i] - mean) * (y[i] - mean));
        if (i == begin) continue;
        const double step = 0.5 * (y[i] - y[i - 1]) * (y[i] - y[i - 1]) * size / (size - 1.0);
        if (ordered.sorted[i] == ordered.sorted[i - 1])
          neighbours += step;  // the mean has none at equal inputs
        else
          steps.push_back(step);
      }
      begin = end;
    }
    std::ranges::stable_sort(steps, std::ranges::greater());
    for (std::size_t i = steps_of_mean; i < steps.size(); ++i) neighbours += steps[i];
  }

  std::vector<double> all, within;
  double neighbours = 0.0;  // the sum, as of so many as there are outputs
};

double sum_of(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

}  // namespace

std::optional<FirstOrderIndex> first_order_index(const std::vector<double>& inputs,
                                                 const std::vector<double>& outputs) {
  REHEARSE_ASSERT(inputs.size() == outputs.size(), "both lists have the same length");
  const Ordered ordered(inputs, outputs);
  const double n = static_cast<double>(inputs.size()), count = static_cast<double>(ordered.ends.size());
  if (n < 2.0 * std::max(count, 1.0)) return std::nullopt;
  const Squares squares(ordered);
  const double all = sum_of(squares.all);
  if (!(all > 0.0)) return std::nullopt;
  const double rest = (n - 1.0) / (n - count) * sum_of(squares.within) / all;
  const double rest_of_neighbours = (n - 1.0) / n * squares.neighbours / all;
  double variance = 0.0;  // of the rest, by the terms of its two sums
  for (std::size_t i = 0; i < squares.all.size(); ++i) {
    const double term = (n - 1.0) / (n - count) * squares.within[i] - rest * squares.all[i];
    variance += term * term / (all * all);
  }
  constexpr double usual = 1.959963984540054;  // the normal quantile of 0.975
  const double reach = usual * std::sqrt(variance);
  const auto share = [](double value) { return std::clamp(value, 0.0, 1.0); };
  return FirstOrderIndex{std::max(0.0, 1.0 - rest),
                         {share(1.0 - rest - reach), share(1.0 - std::min(rest, rest_of_neighbours) + reach)}};
}

}  // namespace rehearse
