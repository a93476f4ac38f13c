// The shapes that touch, as shapes that are drawn: for pictures of a model's collisions.
#pragma once

#include <rehearse/model.h>

namespace rehearse::tool {

/// The model with its collision shapes in place of its visible ones: hulls, convex parts and triangles of meshes as
/// contacts take them, and all other shapes. Each shape and each part of a mesh has another colour than the one before.
Model with_visible_collisions(const Model& model);

}  // namespace rehearse::tool
