#include "chance_of_fall.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/hashing.h"

namespace rehearse {
namespace {

constexpr std::size_t most_exact = 14;  // changes whose signs are all counted
constexpr std::uint64_t most_signs = std::uint64_t{1} << most_exact;

/// The changes of a history that aren't 0, and the sums of squares over commits from which a correlation follows.
class Changes {
 public:
  explicit Changes(const std::vector<double>& values) : commits_(static_cast<double>(values.size())) {
    for (std::size_t i = 1; i < values.size(); ++i) {
      if (values[i] == values[i - 1]) continue;
      sizes_.push_back(std::abs(values[i] - values[i - 1]));
      signs_.push_back(values[i] < values[i - 1] ? 1.0 : -1.0);
      places_.push_back(static_cast<double>(i));
    }
  }

  std::size_t count() const { return sizes_.size(); }
  const std::vector<double>& signs() const { return signs_; }

  /// The correlation of the number of the commit with the fall below the first margin, -1 to 1, times a constant.
  double steadiness(const std::vector<double>& signs) const {
    double fall = 0.0, sum = 0.0, squares = 0.0, moments = 0.0;  // over commits, of the fall below the first margin
    for (std::size_t i = 0; i < count(); ++i) {
      fall += signs[i] * sizes_[i];
      const double next = i + 1 < count() ? places_[i + 1] : commits_;
      const double commits = next - places_[i];  // with this fall
      sum += fall * commits;
      squares += fall * fall * commits;
      moments += fall * 0.5 * commits * (places_[i] + next - 1.0 - (commits_ - 1.0));
    }
    return moments / std::sqrt(squares - sum * sum / commits_);
  }

 private:
  double commits_;
  std::vector<double> sizes_, signs_, places_;  // by change; 1: it shrinks the margin; the number of its commit
};

}  // namespace

double chance_of_fall(const std::vector<double>& values) {
  const Changes changes(values);
  if (changes.count() == 0) return 1.0;
  const double observed = changes.steadiness(changes.signs());
  const double least = observed - 1e-9 * std::abs(observed);  // equal ones may differ by rounding
  const bool is_exact = changes.count() <= most_exact;
  const std::uint64_t all = is_exact ? std::uint64_t{1} << changes.count() : most_signs;
  std::uint64_t steady = is_exact ? 0 : 1;  // the observed signs are among them
  std::vector<double> signs(changes.count());
  for (std::uint64_t number = is_exact ? 0 : 1; number < all; ++number) {
    std::uint64_t bits = number;
    for (std::size_t i = 0; i < signs.size(); ++i) {
      if (!is_exact && i % 64 == 0) bits = hash_bytes(&number, sizeof number, i);
      signs[i] = (bits >> i % 64 & 1) != 0 ? 1.0 : -1.0;
    }
    if (changes.steadiness(signs) >= least) ++steady;
  }
  return static_cast<double>(steady) / static_cast<double>(all);
}

}  // namespace rehearse
