// From where a picture of a scene is taken, if nobody says.
#pragma once

#include <rehearse/model.h>

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <vector>

namespace rehearse::tool {

/// A model where it stands.
struct PlacedModel {
  std::shared_ptr<const Model> model;
  std::vector<Eigen::Isometry3d> links;  // world pose of each link
  bool fixed = false;                    // its root never moves
};

struct Viewpoint {
  Eigen::Vector3d eye;     // [m]
  Eigen::Vector3d target;  // [m]
};

/// From the front, the right and above, just so far away that all that matters is in the picture. Floors and walls,
/// that is, bodies that are fixed, rigid and larger than all others together, don't count unless there is nothing else.
/// A given eye or target is kept.
Viewpoint default_viewpoint(const std::vector<PlacedModel>& scene, const Camera& camera,
                            const std::optional<Eigen::Vector3d>& eye, const std::optional<Eigen::Vector3d>& target);

}  // namespace rehearse::tool
