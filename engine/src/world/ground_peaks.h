// Contacts of the peaks of a heightmap with the faces of shapes. Private to the world library.
//
// ODE collides a shape with the planes of the ground's triangles: it finds where the shape's corners are below the
// ground, not where a peak of the ground is inside a face. A plate would sink onto a peak up to its corners.
#pragma once

#include <ode/ode.h>

#include <span>

#include "simulated_body.h"

namespace rehearse {

/// Writes a contact for each peak or ridge point of the ground inside the other shape, in the form of dCollide, at most
/// room.size(). `ground_first`: of the two shapes of the contact. Returns the number of contacts.
int touch_peaks(const BodyShape& ground, const BodyShape& other, bool ground_first, std::span<dContactGeom> room);

}  // namespace rehearse
