// Makes a cnoid::Body from a Model, and copies readings into its devices: converts types of the engine to the
// controllers' types.
#pragma once

#include <rehearse/io.h>
#include <rehearse/model.h>
#include <cnoid/Body>

#include <string>

namespace rehearse {

/// A new body with links, joints, limits, inertias and devices of the model. All is at rest, with the root where the
/// model puts it. `name`: name of the body in the scenario. `fixed`: the root link doesn't move.
cnoid::BodyPtr make_cnoid_body(const Model& model, const std::string& name, bool fixed);

/// Joint displacements and link poses of the observation, everything else at rest.
void set_initial_state(cnoid::Body& body, const Model& model, const BodyObservation& observation);

/// Copies a reading into the controller's device: values, picture and points, or ranges. Doesn't notify.
/// `delivered_at`: time of delivery of a picture or scan [s].
using FeedFunction = void (*)(cnoid::Device& target, const Device& device, const DeviceReading& reading,
                              double delivered_at);
FeedFunction device_feed(const Device& device);

}  // namespace rehearse
