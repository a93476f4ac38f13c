// A cnoid::Body from a Model, and its devices fed from readings: where the engine's types become the controllers'.
#pragma once

#include <rehearse/io.h>
#include <rehearse/model.h>
#include <cnoid/Body>

#include <string>

namespace rehearse {

/// A new body: links, joints, limits, inertias and devices of the model, all at rest with the root where the model puts
/// it. `name`: the body's in the scenario. `fixed`: the root link doesn't move.
cnoid::BodyPtr make_cnoid_body(const Model& model, const std::string& name, bool fixed);

/// Joint displacements and link poses of the observation, everything else at rest.
void set_initial_state(cnoid::Body& body, const BodyObservation& observation);

/// The link's pose, with the rotation matrix made from the quaternion.
cnoid::Isometry3 pose_of(const LinkReading& link);

/// Copies a reading into the controller's device: values, picture and points, or ranges. Doesn't notify.
/// `delivered_at`: when a picture or scan was handed over [s].
void feed_device(cnoid::Device& target, const Device& device, const DeviceReading& reading, double delivered_at);

}  // namespace rehearse
