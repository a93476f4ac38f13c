// The default viewpoint for a picture of a scene. Internal.
#pragma once

#include <rehearse/model.h>
#include <rehearse/renderer.h>

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <vector>

namespace rehearse {

/// A model with the poses of its links.
struct PlacedModel {
  std::shared_ptr<const Model> model;
  std::vector<Eigen::Isometry3d> links;  // world pose of each link
  bool fixed = false;                    // its root never moves
};

struct Viewpoint {
  Eigen::Vector3d eye;     // [m]
  Eigen::Vector3d target;  // [m]
};

/// The camera looks from the front, the right and above, at the smallest distance at which all bodies are in the
/// picture. Floors and walls don't count unless there is nothing else. (They are bodies that are fixed, rigid and
/// larger than all others together.) A given eye or target is kept.
Viewpoint default_viewpoint(const std::vector<PlacedModel>& scene, const Camera& camera,
                            const std::optional<Eigen::Vector3d>& eye, const std::optional<Eigen::Vector3d>& target);

/// Adds the visible shapes and the lights of a model to the pictures.
void add_to(Renderer& renderer, const PlacedModel& placed);

}  // namespace rehearse
