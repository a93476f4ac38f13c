// Contacts between the bodies of a world, in an order that depends on the scenario alone. Private to the world library.
#pragma once

#include <ode/ode.h>

#include <memory>
#include <vector>

#include "connections.h"
#include "contact_surface.h"
#include "direct_step.h"
#include "simulated_body.h"
#include "sleep.h"
#include "touches.h"

namespace rehearse {

/// Finds the contacts of the bodies at their current poses. `found` is room for the contacts of two shapes: they have
/// at most its size. Pairs are visited body by body and shape by shape in the order of their creation; for each body,
/// pairs within the body come first. ODE's spaces would visit them in the order in which shapes last moved, and the
/// solver's result depends on the order of its rows. `touches` receives the contacts, and `friction` their points.
/// Links that a connection connects don't touch each other. `pairs` becomes the list of links that touch, ascending,
/// each pair once.
void find_contacts(const std::vector<std::unique_ptr<SimulatedBody>>& bodies, const Connections& connections,
                   std::vector<dContactGeom>& found, Touches& touches, Friction& friction,
                   std::vector<LinkPair>& pairs);

/// Gives each contact to `direct` if that solves it, and else adds a contact joint to `group`. `direct` may be null.
/// The contacts of bodies that sleep get the forces of the last step instead.
void add_contacts(dWorldID world, dJointGroupID group, const ContactLaw& law, const Friction& friction,
                  const Sleep& sleep, Touches& touches, DirectStep* direct);

}  // namespace rehearse
