#include <rehearse/campaign_report.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/scenario/normal_quantile.h"

namespace rehearse {
namespace {

/// The indices of values in ascending order.
std::vector<std::size_t> order_of(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  return order;
}

/// The ends of parts of the sorted values: a part for each value, or as many as the root of their number, of about
/// equal size. Equal values are in one part.
std::vector<std::size_t> parts_of(const std::vector<double>& values) {
  std::vector<double> sorted = values;
  std::ranges::sort(sorted);
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

/// Ranks from 1 on; equal values have the mean of their ranks.
std::vector<double> ranks_of(const std::vector<double>& values) {
  const std::vector<std::size_t> order = order_of(values);
  std::vector<double> ranks(values.size());
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && values[order[end]] == values[order[begin]]) ++end;
    for (std::size_t i = begin; i < end; ++i) ranks[order[i]] = 0.5 * static_cast<double>(begin + end + 1);
  }
  return ranks;
}

/// The probability of at most `most` successes in n attempts.
double binomial_at_most(std::int64_t most, std::int64_t n, double probability) {
  const double size = static_cast<double>(n), yes = std::log(probability), no = std::log1p(-probability);
  double sum = 0.0;
  for (std::int64_t k = 0; k <= std::min(most, n); ++k) {
    const double some = static_cast<double>(k), rest = size - some;
    // 0 attempts have no logarithm of 0 in their product
    sum += std::exp(std::lgamma(size + 1.0) - std::lgamma(some + 1.0) - std::lgamma(rest + 1.0) +
                    (some > 0.0 ? some * yes : 0.0) + (rest > 0.0 ? rest * no : 0.0));
  }
  return std::min(1.0, sum);
}

/// The probability of a success at which at most `most` successes in n attempts have this probability; 1: none is so
/// large.
double binomial_bound(std::int64_t most, std::int64_t n, double at_most) {
  double low = 0.0, high = 1.0;
  constexpr int halvings = 60;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (binomial_at_most(most, n, middle) > at_most ? low : high) = middle;
  }
  return high;
}

}  // namespace

Interval wilson_interval(std::int64_t passed, std::int64_t all, double confidence) {
  if (all == 0) return {};
  constexpr double usual = 1.959963984540054;  // the normal quantile of 0.975
  const double z = confidence == 0.95 ? usual : normal_quantile(0.5 + 0.5 * confidence);
  const double n = static_cast<double>(all), share = static_cast<double>(passed) / n;
  const double middle = share + z * z / (2.0 * n);
  const double reach = z * std::sqrt(share * (1.0 - share) / n + z * z / (4.0 * n * n));
  const double scale = 1.0 / (1.0 + z * z / n);
  return {passed == 0 ? 0.0 : (middle - reach) * scale, passed == all ? 1.0 : (middle + reach) * scale};
}

Interval inverse_interval(std::int64_t failed, std::int64_t all, double confidence) {
  REHEARSE_ASSERT(failed >= 1 && failed <= all, "the work ended with a failure");
  const double tail = confidence == 0.95 ? 0.025 : 0.5 - 0.5 * confidence;
  // more cases were needed with a smaller probability of a failure, and fewer with a larger one
  const double least = binomial_bound(failed - 1, all, 1.0 - tail);
  const double most = failed == all ? 1.0 : binomial_bound(failed - 1, all - 1, tail);
  return {1.0 - most, 1.0 - least};
}

double quantile_of_sorted(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double place = share * static_cast<double>(sorted.size() - 1), part = place - std::floor(place);
  const double below = sorted[static_cast<std::size_t>(place)];
  return part == 0.0 ? below : (1.0 - part) * below + part * sorted[static_cast<std::size_t>(place) + 1];
}

double mcnemar_exact(std::int64_t one_way, std::int64_t other_way) {
  return std::min(1.0, 2.0 * binomial_at_most(std::min(one_way, other_way), one_way + other_way, 0.5));
}

double CampaignSummary::share() const {
  const double all = static_cast<double>(judged());
  if (until_failures == 0) return static_cast<double>(passed()) / all;  // 0 / 0: NaN
  const double before_last = static_cast<double>(failed() - 1);
  return failed() == 1 ? std::numeric_limits<double>::quiet_NaN() : 1.0 - before_last / (all - 1.0);
}

double CampaignSummary::confidence() const { return claim ? claim->confidence : 0.95; }

Interval CampaignSummary::interval() const {
  return until_failures > 0 ? inverse_interval(failed(), judged(), confidence())
                            : wilson_interval(passed(), judged(), confidence());
}

double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
  REHEARSE_ASSERT(a.size() == b.size(), "both lists have the same length");
  const std::vector<double> x = ranks_of(a), y = ranks_of(b);
  const double mean = 0.5 * static_cast<double>(a.size() + 1);
  double xy = 0.0, xx = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (x[i] - mean) * (y[i] - mean);
    xx += (x[i] - mean) * (x[i] - mean);
    yy += (y[i] - mean) * (y[i] - mean);
  }
  return xy / std::sqrt(xx * yy);
}

double first_order_index(const std::vector<double>& inputs, const std::vector<double>& outputs) {
  REHEARSE_ASSERT(inputs.size() == outputs.size(), "both lists have the same length");
  const std::vector<std::size_t> parts = parts_of(inputs);
  const double n = static_cast<double>(inputs.size()), count = static_cast<double>(parts.size());
  if (n < 2.0 * std::max(count, 1.0)) return std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::size_t> order = order_of(inputs);
  const double mean = std::accumulate(outputs.begin(), outputs.end(), 0.0) / n;
  double within = 0.0, all = 0.0;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const std::size_t begin = part == 0 ? 0 : parts[part - 1], end = parts[part];
    double of_part = 0.0;
    for (std::size_t i = begin; i < end; ++i) of_part += outputs[order[i]] / static_cast<double>(end - begin);
    for (std::size_t i = begin; i < end; ++i) {
      within += (outputs[order[i]] - of_part) * (outputs[order[i]] - of_part);
      all += (outputs[order[i]] - mean) * (outputs[order[i]] - mean);
    }
  }
  if (!(all > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return std::max(0.0, 1.0 - (n - 1.0) / (n - count) * within / all);
}

double cramers_v(const std::vector<std::vector<std::int64_t>>& counts) {
  std::vector<double> of_row, of_column;
  for (const std::vector<std::int64_t>& row : counts) {
    of_row.push_back(static_cast<double>(std::accumulate(row.begin(), row.end(), std::int64_t{0})));
    of_column.resize(std::max(of_column.size(), row.size()));
    for (std::size_t column = 0; column < row.size(); ++column) of_column[column] += static_cast<double>(row[column]);
  }
  const double all = std::accumulate(of_row.begin(), of_row.end(), 0.0);
  double squares = 0.0;  // chi squared over the number of cases
  for (std::size_t row = 0; row < counts.size(); ++row)
    for (std::size_t column = 0; column < counts[row].size(); ++column) {
      const double expected = of_row[row] * of_column[column] / all;
      const double excess = static_cast<double>(counts[row][column]) - expected;
      if (expected > 0.0) squares += excess * excess / expected / all;
    }
  const auto occurring = [](const std::vector<double>& sums) {
    return static_cast<double>(std::ranges::count_if(sums, [](double sum) { return sum > 0.0; }));
  };
  const double degrees = std::min(occurring(of_row), occurring(of_column)) - 1.0;
  return degrees < 1.0 ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(squares / degrees);
}

}  // namespace rehearse
