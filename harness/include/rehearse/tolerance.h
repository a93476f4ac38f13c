// Tolerance: how far a value may be from its golden, and which rule decides that.
//
// A number x passes against its golden g if |x - g| <= max(atol, rtol * scale). The scale is the largest |g| of its
// series; of a vector with elements x, y and z, the largest norm: an axis along which nothing moves is not judged by
// its own noise. A scenario states rules (`tolerances:`); what no rule speaks of has the default of its unit.
//
// A rule may allow for time: with `lead` and `lag`, x passes at time t if it is within that bound of anything between
// the least and the greatest that the golden is from t - lag to t + lead; an orientation, of any that it passes
// through. The span ends where the record does. With both 0, which is the default, only the same tick counts.
//
// Events (contacts, limits, what control() returns, messages) may be off by whole `ticks`.
#pragma once

#include <rehearse/scenario.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <vector>

namespace rehearse {

struct Tolerance {
  double atol = 0.0;         // in the unit of the series
  double rtol = 0.0;         // of the scale
  double lead = 0.0;         // [s]
  double lag = 0.0;          // [s]
  std::optional<int> ticks = std::nullopt;  // events: how far off they may be; none: no rule says
  double pixel_share = 0.0;  // pictures: share of the pixels that may differ by more than is allowed to each, 0 to 1
  double pixel_delta = 0.0;  // pictures: difference of a colour [of 255] that still counts as equal
  /// Pictures: the same share within any square of 16 x 16 pixels. It tells an object that is gone from speckle.
  double pixel_window = 0.25;

  /// The largest difference that passes, for a series of that scale.
  double bound(double scale) const { return std::max(atol, rtol * scale); }
  bool allows_for_time() const { return lead > 0.0 || lag > 0.0; }
};

/// True if the pattern matches the whole name. `*` stands for any text, slashes and nothing included; there is no other
/// special character.
bool matches(std::string_view pattern, std::string_view name);

/// What a series may differ by if no rule speaks of it. By unit:
///
///   rad, m, quaternion (an angle [rad])    1e-9
///   unit vector (each element)             1e-9
///   rad/s, m/s                             1e-7
///   rad/s², m/s²                           1e-4
///   N·m, N                                 1e-4
///   pixels, any other unit, none           0: the same bits
///
/// A last bit that rounds otherwise (another compiler, another maths library) moves a joint by about 1e-16 rad in one
/// step, and contacts let that grow to some 1e-10 rad in two seconds. 1e-9 rad is above that and below any change of a
/// controller that does anything; over a gain of 8000 N·m/rad and a step of 1 ms it makes the others.
Tolerance default_tolerance(std::string_view unit);

/// The last rule that matches the series decides. What it doesn't state, and what no rule matches, is as by default.
Tolerance tolerance_of(std::string_view series, std::string_view unit, const std::vector<ToleranceRule>& rules);

}  // namespace rehearse
