// The forms of a body whose keys are read into members.
#pragma once

#include <rehearse/body.h>
#include <rehearse/scenario.h>

#include "bound_form.h"
#include "mesh/heightmap_file.h"

namespace rehearse {

const BoundForm<ScenarioBody>& bound_body_form();
/// The keys of a body that has a model file: a part of the keys of a body.
const BoundForm<UrdfOptions>& model_file_keys();
/// The keys of a body that is a shape of the scenario's own: a part of the keys of a body.
const BoundForm<Surface>& shape_surface_keys();
const BoundForm<ScenarioBody>& bound_velocity_form();
const BoundForm<Checker>& bound_checker_form();
const BoundForm<HeightmapSettings>& bound_heightmap_form();

}  // namespace rehearse
