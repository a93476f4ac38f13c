// Contacts between the bodies of a world, in an order that is the scenario's alone. Private to the world library.
#pragma once

#include <ode/ode.h>

#include <memory>
#include <vector>

#include "contact_surface.h"
#include "simulated_body.h"
#include "touches.h"

namespace rehearse {

/// Finds the contacts of the bodies where they are now and adds a contact joint for each to `group`, at most
/// `max_contacts` a pair of shapes. Pairs are visited body by body and shape by shape in the order they were made, of
/// each body its own first; ODE's spaces would visit them in the
/// order in which shapes last moved, and the solver's result depends on the order of its rows.
/// `touches` keeps those of links that feel; `pairs` becomes the links that touch, ascending, each pair once.
void add_contacts(dWorldID world, dJointGroupID group, const std::vector<std::unique_ptr<SimulatedBody>>& bodies,
                  const ContactLaw& law, int max_contacts, Touches& touches, std::vector<LinkPair>& pairs);

}  // namespace rehearse
