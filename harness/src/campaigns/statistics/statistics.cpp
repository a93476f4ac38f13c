#include <rehearse/campaign_report.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "binomial.h"

namespace rehearse {
namespace {

/// The probability beyond each end of a two-sided interval.
double tail_of(double confidence) { return confidence == 0.95 ? 0.025 : 0.5 - 0.5 * confidence; }

/// The indices of values in ascending order.
std::vector<std::size_t> order_of(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  return order;
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

}  // namespace

Interval exact_interval(std::int64_t passed, std::int64_t all, double confidence) {
  if (all == 0) return {};
  const double tail = tail_of(confidence), some = static_cast<double>(passed), n = static_cast<double>(all);
  return {passed == 0 ? 0.0 : binomial_lower_bound(some, n, tail),
          passed == all ? 1.0 : binomial_upper_bound(some, n, tail)};
}

Interval inverse_interval(std::int64_t failed, std::int64_t all, double confidence) {
  REHEARSE_ASSERT(failed >= 1 && failed <= all, "the work ended with a failure");
  const double tail = tail_of(confidence), some = static_cast<double>(failed), n = static_cast<double>(all);
  // more cases were needed with a smaller probability of a failure, and fewer with a larger one
  const double least = binomial_lower_bound(some, n, tail);
  const double most = failed == all ? 1.0 : binomial_upper_bound(some - 1.0, n - 1.0, tail);
  return {1.0 - most, 1.0 - least};
}

double quantile_of_sorted(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double place = share * static_cast<double>(sorted.size() - 1), part = place - std::floor(place);
  const double below = sorted[static_cast<std::size_t>(place)];
  return part == 0.0 ? below : (1.0 - part) * below + part * sorted[static_cast<std::size_t>(place) + 1];
}

double mcnemar_exact(std::int64_t one_way, std::int64_t other_way) {
  const double fewer = static_cast<double>(std::min(one_way, other_way));
  return std::min(1.0, 2.0 * binomial_at_most(fewer, static_cast<double>(one_way + other_way), 0.5));
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
                            : exact_interval(passed(), judged(), confidence());
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
