// Convex parts of meshes, for contacts of concave meshes that move. Private to the engine.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/model.h>

#include "convex_hull.h"
#include "hull_store.h"

namespace rehearse {

/// The largest number of convex parts of an object.
inline constexpr std::size_t max_convex_parts = 16;
/// A hull that fills at most this share more than its mesh counts as the mesh's shape.
inline constexpr double tolerated_excess = 0.05;

/// The hulls of each object of a mesh, with notes about objects whose hull fills more than `tolerated_excess` over the
/// object's volume.
Result<ConvexHulls> judged_hulls(const MeshData& mesh);

/// The convex parts of each object of a mesh: its hull, if that fills at most `tolerated_excess` more than the object.
/// Otherwise planes cut the object, each where the hulls of both sides fill the least: planes of faces at concave
/// edges, and planes across the axes. It ends when all hulls together fill at most `tolerated_excess` more than the
/// object, or no cut reduces their volume, or there are max_convex_parts. An object that isn't closed has no volume:
/// each cut then has to empty a hundredth of its hull. Notes state the number of parts and their excess volume. The
/// result's bits depend on the mesh alone.
Result<ConvexHulls> convex_parts(const MeshData& mesh);

/// convex_parts() if the contact is `parts`, else judged_hulls(). A result that `store` has isn't computed again; it
/// keeps those of meshes for which that takes longer than reading a file.
Result<ConvexHulls> contact_hulls(const MeshData& mesh, MeshContact contact, const HullStore& store);

/// True if the hulls of all objects fill at most `excess` more than the objects, all of which are closed.
bool is_convex(const MeshData& mesh, double excess);

}  // namespace rehearse
