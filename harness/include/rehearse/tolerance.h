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

/// What a series may differ by if no rule speaks of it, by its unit. Beside it what was measured: the largest noise
/// (noise_floor.h) of all sample scenarios over ten seconds each, on the plant level, where a difference lives for 0.1 s:
///
///   unit                                    default             noise, and where
///   rad, quaternion (an angle [rad])        1e-9                7e-13   the arm with a grasp
///   m                                       1e-9                3e-13   its fingers
///   unit vector (each element)              1e-9                0       they round with the orientations
///   rad/s                                   1e-7                3e-10   its turntable
///   m/s                                     1e-7                8e-11   its fingers
///   rad/s², m/s²                            1e-4                3e-8    SR1 in free fall
///   N·m                                     1e-3                5e-5    what the grasping arm needs to go by position
///   N                                       1e-4                1e-7    SR1 in free fall
///   range: of a laser [m]                   1e-9, rtol 2^-23    a last bit of single precision, if it is on the edge
///   depth: a distance in a picture [m]      rtol 1e-3, share    1e-4 of it: a step of the depth buffer, 5 m away
///   pixels                                  2 of 255, share     1 of 255
///   camera: matrices of a camera_info       1e-9                7e-13   a URDF whose numbers have 15 digits
///   any other, none                         0: the same bits
///
/// The share of a picture's pixels that may differ by more is 0.0005: edges fall on the next pixel. A command that a
/// controller computes in another arithmetic differs by less than a state does. Between noise and default lie 10 to 10^7,
/// and the smallest faults that were tried (1 g more of 30 kg, 1 % less friction) differ by 10^2 to 10^7 times the default
/// and more.
///
/// In the closed loop noise grows, with contacts a thousandfold a second and more: there the same numbers hold up to the
/// scenario's horizon only.
Tolerance default_tolerance(std::string_view unit);

/// The last rule that matches the series decides. What it doesn't state, and what no rule matches, is as by default.
Tolerance tolerance_of(std::string_view series, std::string_view unit, const std::vector<ToleranceRule>& rules);

}  // namespace rehearse
