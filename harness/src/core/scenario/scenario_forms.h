// The forms of scenarios: the keys of each map in them.
#pragma once

#include <rehearse/sensor_errors.h>

#include <vector>

#include "core/form/form.h"

namespace rehearse {

// Of the run.
const Form& scenario_form();
const Form& golden_form();
const Form& solver_form();
const Form& record_form();
const Form& look_form();
const Form& light_form();
const Form& pair_form();
const Form& push_form();
const Form& joystick_entry_form();
const Form& tolerance_form();
const Form& expectation_form();
/// A file with tolerances alone.
const Form& tolerances_file_form();

// Of bodies.
const Form& body_form();
const Form& box_form();
const Form& sphere_form();
const Form& cylinder_form();
const Form& heightmap_form();
const Form& checker_form();
const Form& velocity_form();
const Form& rotation_form();
const Form& pose_form();
const Form& controller_form();
const Form& link_form();
const Form& belt_form();
const Form& joint_form();
const Form& weld_form();
const Form& actuator_form();
const Form& sensor_form();  // of sensors without keys of their own
/// The form of the sensors of a kind.
const Form& form_of_sensor(const DeviceKind& kind);
const Form& contact_sensor_form();
const Form& camera_form();
const Form& range_sensor_form();
const Form& sweep_form();

// Of errors.
const Form& noise_form();
/// The quantities of all devices, and those of joints, each once.
const std::vector<MeasuredQuantity>& measured_quantities();
const Form& data_sheet_form();
const Form& spell_form();
/// The errors of a quantity.
const Form& errors_form(const MeasuredQuantity& quantity);
/// An error whose span of time belongs to it.
const Form& timed_error_form(const MeasuredQuantity& quantity);
const Form& fault_form();

// Of campaigns.
const Form& parameter_form();
const Form& normal_form();
const Form& grid_form();
const Form& pass_rate_form();

}  // namespace rehearse
