// Makes the collision shapes of a model visible, for pictures.
#pragma once

#include <rehearse/model.h>

namespace rehearse::tool {

/// The model with its collision shapes in place of its visible ones: the hulls, convex parts and triangles of meshes
/// that contacts use, and all other shapes. Each shape and each part of a mesh has another colour than the one before.
Model with_visible_collisions(const Model& model);

}  // namespace rehearse::tool
