// The geometry of a pinhole camera: its field of view, and the points behind its pixels. No drawing.
#pragma once

#include <rehearse/io.h>
#include <rehearse/model.h>

#include <Eigen/Core>
#include <vector>

namespace rehearse {

/// Vertical opening angle [rad]. Camera::field_of_view itself in a picture at least as wide as high, else derived from
/// it as the horizontal one: 2 atan(tan(fov / 2) * height / width).
double vertical_field_of_view(const Camera& camera);

/// The point behind each pixel, row by row from the top left, in the camera's device frame [m]: it looks along -z, +y
/// is up. The point is on the ray through the pixel's centre, where depth is drawn (Choreonoid uses the corner, half a
/// pixel aside). For a pixel without a surface, as in Choreonoid: z is +inf; x and y are +inf or -inf, depending on the
/// pixel's side of the centre, and 0 at the centre. `points` is resized to width * height.
void points_from_depth(const Camera& camera, const DepthImage& depth, std::vector<Eigen::Vector3f>& points);

}  // namespace rehearse
