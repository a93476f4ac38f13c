// The forms of maps: the keys of each map in the file.
#pragma once

#include "core/form/form.h"
#include "core/kinds/kind.h"

namespace rehearse {

const Form& map_form();
const Form& map_tick_form();
const Form& map_controller_form();
const Form& joint_source_form();
const Form& joint_rename_form();
/// The form of a source that is the value of the input's key.
const Form& source_form(const LogInput& input);
const Form& camera_source_form();
const Form& range_source_form();
const Form& joystick_source_form();
const Form& axis_source_form();
const Form& root_source_form();
const Form& command_source_form();
const Form& state_source_form();

}  // namespace rehearse
