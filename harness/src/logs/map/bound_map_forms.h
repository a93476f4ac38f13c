// The forms of maps whose keys are read into members.
#pragma once

#include "core/kinds/kind.h"
#include "core/scenario/bound_form.h"
#include "log_map.h"

namespace rehearse {

/// The clocks of a map, and of its sources.
const Words<LogClock>& clock_words();

const BoundForm<LogMap>& bound_map_form();
const BoundForm<TickSource>& bound_tick_form();
const BoundForm<MappedController>& bound_map_controller_form();
const BoundForm<JointSource>& bound_joint_source_form();
const BoundForm<JointRename>& bound_joint_rename_form();
/// Of numbers for devices.
const BoundForm<DeviceSource>& bound_number_source_form(const LogInput& input);
const BoundForm<DeviceSource>& bound_camera_source_form();
const BoundForm<DeviceSource>& bound_range_source_form();
const BoundForm<JoySource>& bound_joystick_source_form();
const BoundForm<JoyAxis>& bound_axis_source_form();
const BoundForm<RootSource>& bound_root_source_form();
const BoundForm<CommandSource>& bound_command_source_form();
const BoundForm<StateSource>& bound_state_source_form();

}  // namespace rehearse
