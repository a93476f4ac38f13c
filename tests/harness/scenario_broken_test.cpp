// One mistake per file: fixtures/broken/scenario_*.yaml, each with the place and the text of its message.
#include "scenario_files.h"

#include <gmock/gmock.h>

#include <set>

namespace rehearse {
namespace {

struct Broken {
  const char* name;  // fixtures/broken/scenario_NAME.yaml
  int line;          // of the first message
  int column;
  const char* message;  // an extended regular expression found in it, hint included
};

// The test's name in ctest.
void PrintTo(const Broken& broken, std::ostream* out) { *out << broken.name; }

// clang-format off
const Broken all_broken[] = {
    {"not_yaml", 3, 7, "can't be read as YAML"},
    {"tab_indentation", 3, 5, "can't be read as YAML.*there is a tab"},
    {"two_documents", 5, 1, "second document"},
    {"unknown_alias", 5, 10, "can't be read as YAML"},
    {"alias_of_itself", 4, 5, "alias within the node"},
    {"empty", 1, 1, "the scenario is empty.*rehearse: 1"},
    {"a_list", 1, 1, "the scenario is a list.*rehearse: 1"},
    {"no_version", 1, 1, "has no 'rehearse'.*rehearse: 1"},
    {"another_version", 1, 11, "rehearse is 2.*expected 1"},
    {"unknown_key", 2, 1, "unknown key 'durration' in the scenario.*did you mean 'duration'"},
    {"unknown_key_unlike_any", 3, 1, "unknown key 'weather'.*known keys: rehearse, name, golden"},
    {"unknown_key_in_body", 4, 40, "unknown key 'masss' in a body.*'mass'"},
    {"duplicate_key", 3, 1, "'duration' is given twice.*line 2"},
    {"key_that_is_a_list", 5, 1, "a key is a list"},
    {"no_duration", 1, 1, "has no 'duration'"},
    {"duration_of_text", 2, 11, "duration is 'ten seconds'.*expected a number above 0 and at most 86400 \\[s\\]"},
    {"duration_in_quotes", 2, 11, "duration is the text '10'.*expected a number"},
    {"duration_empty", 2, 1, "duration is empty"},
    {"duration_list", 2, 11, "duration is a list.*expected a number"},
    {"duration_zero", 2, 11, "duration is 0.*above 0"},
    {"duration_of_thirty_years", 2, 11, "duration is 1e9.*at most 86400"},
    {"duration_infinite", 2, 11, "duration is '.inf'.*expected a number"},
    {"duration_nan", 2, 11, "duration is 'nan'.*expected a number"},
    {"duration_with_unit", 2, 11, "duration is '10 s'.*expected a number"},
    {"duration_below_a_step", 2, 11, "no tick.*0.001 s"},
    {"negative_step", 3, 12, "time_step is -0.001.*from 1e-05 to 0.1"},
    {"zero_step", 3, 12, "time_step is 0 .*from 1e-05 to 0.1"},
    {"huge_step", 3, 12, "time_step is 1 .*from 1e-05 to 0.1"},
    {"name_with_slash", 3, 7, "name is 'a/b'.*without '/'"},
    {"golden_without_test", 3, 9, "golden is 'SR1'.*Suite.Test"},
    {"seed_negative", 3, 7, "seed is -1.*whole number from 0 to 4294967295"},
    {"seed_fraction", 3, 7, "seed is 1.5.*whole number"},
    {"gravity_of_two", 3, 10, "gravity has 2 elements.*3 numbers"},
    {"gravity_number", 3, 10, "gravity is -9.8.*list of 3 numbers"},
    {"gravity_overflow", 3, 17, "gravity\\[2\\] is '-1e999'.*expected a number"},
    {"options_map", 3, 10, "options is a map.*expected text"},
    {"solver_unknown_method", 3, 18, "method is 'slow'.*quick .* or exact"},
    {"solver_no_iterations", 3, 22, "iterations is 0.*from 1 to 10000"},
    {"solver_erp", 3, 15, "erp is 1.5.*from 0 to 1"},
    {"solver_cfm", 3, 15, "cfm is -1e-5.*from 0"},
    {"solver_over_relaxation", 3, 27, "over_relaxation is 2.*above 0 and below 2"},
    {"solver_friction", 3, 20, "friction is -1.*from 0"},
    {"solver_max_contacts", 3, 24, "max_contacts is 0.*from 1 to 1000"},
    {"solver_list", 3, 9, "the solver is a list.*map"},
    {"record_frames", 3, 18, "frames is 'yes'.*true or false"},
    {"look_text", 3, 7, "the look is 'sunny'.*map"},
    {"look_unknown_key", 3, 8, "unknown key 'sun' in the look.*sky"},
    {"sky_of_four", 3, 13, "sky has 4 elements.*expected 3 numbers"},
    {"sky_of_bytes", 3, 14, "sky\\[0\\] is 140.*from 0 to 1"},
    {"no_bodies", 1, 1, "has no 'bodies'"},
    {"bodies_empty", 3, 9, "empty list"},
    {"bodies_map", 3, 9, "bodies is a map.*list of bodies"},
    {"body_text", 3, 10, "a body is 'Box'.*map"},
    {"body_without_name", 4, 5, "a body has no 'name'"},
    {"body_name_with_slash", 4, 12, "name is 'a/b'.*none of /"},
    {"body_name_with_blank", 4, 12, "name is 'a b'.*without blanks"},
    {"two_bodies_of_one_name", 5, 12, "second body is named 'Box'.*line 4"},
    {"body_without_model", 4, 5, "a body has no 'model'.*box, sphere, cylinder"},
    {"body_with_two_shapes", 4, 40, "both 'sphere' and 'box'"},
    {"missing_model", 4, 24, "there is no model file 'no_such.urdf'.*broken/no_such.urdf"},
    {"model_is_a_directory", 4, 24, "there is no model file"},
    {"model_broken", 4, 24, "model 'urdf_loop.urdf' can't be used"},
    {"model_with_mass", 4, 50, "mass is given for a body with a model"},
    {"box_without_size", 4, 22, "a box has no 'size'"},
    {"box_flat", 4, 33, "size\\[1\\] is 0.*from 1e-06"},
    {"sphere_negative", 4, 34, "radius is -1.*from 1e-06"},
    {"cylinder_without_length", 4, 27, "a cylinder has no 'length'"},
    {"color_of_two", 4, 44, "color has 2 elements.*3 or 4 numbers"},
    {"color_of_bytes", 4, 45, "color\\[0\\] is 255.*from 0 to 1"},
    {"checker_text", 4, 55, "a checker is 'red'.*map"},
    {"checker_without_color", 4, 55, "a checker has no 'color'.*every second square"},
    {"checker_translucent", 4, 63, "color has 4 elements.*expected 3 numbers"},
    {"checker_flat", 4, 80, "size is 0 .*from 1e-06"},
    {"checker_unknown_key", 4, 74, "unknown key 'colour2' in a checker"},
    {"shape_without_mass", 4, 5, "a body has no 'mass'.*fixed: true"},
    {"mass_zero", 4, 44, "mass is 0.*from 1e-09"},
    {"mass_negative", 4, 44, "mass is -2.*from 1e-09"},
    {"fixed_number", 4, 54, "fixed is 1 .*true or false"},
    {"position_text", 4, 57, "position is 'origin'.*list of 3 numbers"},
    {"position_far", 4, 64, "position\\[2\\] is 1e30.*to 1000000"},
    {"rotation_of_two", 4, 57, "rotation has 2 elements.*roll, pitch, yaw"},
    {"rotation_unit", 4, 64, "rotation\\[2\\] is '90 degrees'.*10 deg"},
    {"rotation_axis_alone", 4, 57, "a rotation has no 'angle'"},
    {"rotation_axis_zero", 4, 64, "axis is zero"},
    {"rotation_twice", 4, 57, "rotation is given twice"},
    {"quaternion_zero", 4, 70, "quaternion is zero"},
    {"quaternion_of_three", 4, 70, "quaternion has 3 elements.*4 numbers"},
    {"unknown_joint", 6, 14, "Arm has no joint 'RLEG_NEE'.*did you mean 'RLEG_KNEE'"},
    {"joint_twice", 6, 30, "'RLEG_KNEE' is given twice"},
    {"joint_unit", 6, 25, "RLEG_KNEE is '10 grad'.*an angle"},
    {"joints_too_few", 6, 13, "lists 3 displacements, but Arm has 29 joints"},
    {"joints_text", 6, 13, "joints is 'standing'.*map of NAME"},
    {"dynamics_unknown", 4, 59, "dynamics is 'static'.*forward .* or kinematic"},
    {"velocity_of_a_fixed_body", 7, 15, "velocity is given, but Box is fixed"},
    {"velocity_of_a_kinematic_body", 8, 15, "velocity is given for a kinematic body.*its commands move it"},
    {"velocity_of_two", 7, 24, "linear has 2 elements"},
    {"velocity_number", 7, 15, "a velocity"},
    {"velocity_unknown_key", 7, 16, "lineal.*linear"},
    {"joint_velocities_list", 6, 23, "joint_velocities is a list.*a map of NAME: VELOCITY"},
    {"joint_velocity_of_a_track", 6, 24, "joint 'TRACK_L' of Tank is a track.*no initial velocity"},
    {"joint_velocity_of_nobody", 6, 24, "Tank has no joint 'TURRET_V'.*did you mean 'TURRET_Y'"},
    {"joint_velocity_of_text", 6, 34, "TURRET_Y is 'fast'"},
    {"friction_of_a_model", 6, 15, "friction is given for a body with a model file"},
    {"friction_negative", 7, 15, "friction is -0.5"},
    {"restitution_of_two", 7, 18, "restitution is 2"},
    {"direction_without_mu2", 7, 12, "fdir1 is given without mu2"},
    {"direction_zero", 8, 12, "fdir1 is .*a direction as in"},
    {"lever_arms_number", 3, 13, "lever_arms is 2"},
    {"joint_velocity_of_a_follower", 6, 24, "RIGHT has no initial velocity of its own: it follows LEFT"},
    {"materials_list", 5, 12, "materials is a list.*BODY: MATERIAL"},
    {"material_of_nobody", 5, 13, "no body .*'Bix'.*did you mean 'Box'"},
    {"material_of_no_link", 5, 13, "Box has no link 'lid'"},
    {"pair_of_unknown_material", 7, 22, "nothing is of the material 'wodo'.*known materials: wood"},
    {"pair_of_one", 7, 15, "between is a list.*two materials"},
    {"pair_of_nothing", 7, 5, "a pair has neither 'friction' nor 'restitution'"},
    {"pair_twice", 8, 15, "a second pair of 'wood' and 'wood'"},
    {"pair_friction_negative", 7, 39, "friction is -1"},
    {"missing_meshes_of_a_shape", 4, 69, "allow_missing_meshes is given for a body without a model file"},
    {"default_mass_of_a_shape", 4, 61, "default_mass is given for a body without a model file.*mass is what a shape weighs"},
    {"default_mass_zero", 4, 58, "default_mass is 0.*from 1e-09"},
    {"joint_limits_of_text", 4, 63, "joint_limits is 'sometimes'.*true or false"},
    {"collision_unknown", 4, 60, "collision is 'mesh'.*hull .* or trimesh"},
    {"collision_trimesh_that_moves", 4, 60, "only a fixed body can be touched as a trimesh, but Box moves.*fixed: true"},
    {"self_collision_of_text", 4, 65, "self_collision is 'sometimes'.*true or false"},
    {"joint_that_mimics", 6, 33, "RIGHT can't start at 0.03: it follows LEFT.*give it -0.03"},
    {"joint_that_is_a_track", 6, 32, "joint 'TRACK_L' of Tank is a track.*no initial displacement"},
    {"joint_that_is_a_link", 6, 14, "'WAIST' is a link of Arm"},
    {"joint_of_a_shape", 4, 56, "Box has no joint 'KNEE'.*there are no joints"},
    {"controller_text", 4, 61, "a controller is 'Hold'.*map"},
    {"controller_without_library", 4, 61, "a controller has no 'library'"},
    {"controller_library_empty", 4, 71, "library is the text ''.*a name or a path"},
    {"controller_delay", 4, 84, "delay is '1 tick'.*true or false"},
    {"controller_unknown_key", 4, 77, "unknown key 'option' in a controller.*'options'"},
    {"two_controllers_of_one_name", 4, 88, "second controller of Box is named 'Hold'.*line 4"},
    {"child_named_like_its_parent", 4, 98, "second controller of Box is named 'Hold'"},
    {"grandchildren", 4, 108, "a child controller has children.*one level"},
    {"push_of_nobody", 5, 17, "there is no body 'Bux'.*'Box'"},
    {"push_without_body", 5, 10, "a push has no 'body'"},
    {"packages_list", 4, 52, "packages is a list.*a map of NAME: DIRECTORY"},
    {"packages_empty", 4, 61, "things is the text ''.*the directory of a package"},
    {"packages_of_a_shape", 4, 60, "packages are given for a body without a model file"},
    {"packages_that_differ", 5, 22, "the model '../models/pendulum.urdf' has other packages in a body above"},
    {"push_on_unknown_link", 5, 28, "Box has no link 'Lid'.*known links: Box"},
    {"push_of_nothing", 5, 10, "neither 'force' nor 'torque'"},
    {"push_point_without_force", 5, 45, "'at' without 'force'"},
    {"push_backwards", 5, 58, "until is 0.5.*not after from"},
    {"push_without_end", 5, 10, "a push has no 'until'"},
    {"joystick_map", 5, 11, "joystick is a map.*list of what happens when"},
    {"joystick_entry_text", 5, 12, "a joystick entry is 'forward'.*map"},
    {"joystick_unknown_key", 5, 20, "unknown key 'axis' in a joystick entry.*did you mean 'axes'"},
    {"joystick_without_time", 5, 12, "a joystick entry has no 'at'.*when it begins"},
    {"joystick_backwards", 5, 48, "at is 0.2, which is before the entry above it.*from 0.5"},
    {"joystick_of_nothing", 5, 12, "names no axis and no button.*axes: "},
    {"joystick_button_as_axis", 5, 27, "'L_STICK' is a button.*write it under buttons"},
    {"joystick_axis_misspelt", 5, 27, "there is no axis 'L_STIK_V'.*did you mean 'L_STICK_V'"},
    {"joystick_axis_as_in_cnoid", 5, 27, "there is no axis 'R_TRIGGER_AXIS'.*did you mean 'R_TRIGGER'"},
    {"joystick_axis_8", 5, 27, "there is no axis '8'.*they are 0 to 7"},
    {"joystick_axis_beyond", 5, 38, "L_STICK_V is -1.5.*from -1 to 1"},
    {"joystick_trigger_negative", 5, 38, "L_TRIGGER is -1.*from 0 to 1"},
    {"joystick_axes_list", 5, 26, "axes is a list.*map of AXIS: POSITION"},
    {"joystick_axis_twice", 5, 44, "'1' is named twice at 0.5 s"},
    {"joystick_trigger_as_button", 5, 30, "'R_TRIGGER' is an axis.*write it under axes"},
    {"joystick_unknown_button", 5, 30, "there is no button 'FIRE'.*known buttons: A, B, X"},
    {"joystick_button_number", 5, 33, "A is 1 .*true or false"},
    {"joystick_buttons_list", 5, 29, "buttons is a list.*map of BUTTON: true or false"},
    {"joystick_button_twice", 5, 63, "'A' is named twice at 0.5 s"},
    {"joystick_ramp_negative", 5, 49, "over is -0.1.*from 0"},
    {"joystick_ramp_of_a_button", 5, 46, "'over' without 'axes'"},
    {"cameras_some", 5, 10, "cameras is 'some'.*all, none, or a list"},
    {"camera_unknown", 6, 11, "there is no camera 'Arm/LeftCamra'.*'Arm/LeftCamera'"},
    {"camera_that_is_a_gyro", 6, 11, "there is no camera 'Arm/WaistGyro'.*known cameras: Arm/LeftCamera, Arm/RightCamera"},
    {"camera_of_nobody", 5, 11, "there is no body 'Bix'"},
    {"camera_without_body", 5, 11, "a camera is 'Eye'.*Body/Camera"},
    {"camera_twice", 6, 27, "listed twice"},
    {"noise_a_map", 5, 8, "noise is a map.*expected a list"},
    {"noise_of_nothing", 5, 9, "neither a sensor nor a joint"},
    {"noise_of_sensor_and_joint", 5, 9, "of a sensor and of a joint.*expected one"},
    {"noise_of_nobody", 5, 18, "there is no sensor 'SR1/WaistGyroscope'.*SR1/WaistGyro"},
    {"noise_of_no_joint", 5, 17, "there is no joint 'SR1/KNEE'.*SR1/RLEG_KNEE"},
    {"noise_of_another_quantity", 5, 33, "SR1/WaistGyro doesn't measure 'acceleration'.*angular_velocity"},
    {"noise_of_a_joints_force", 5, 26, "none of them measures 'force'.*displacement, velocity, effort"},
    {"noise_that_says_nothing", 5, 9, "noise that says nothing.*expected a quantity"},
    {"noise_of_no_figure", 5, 51, "the noise of angular_velocity says nothing.*stddev"},
    {"noise_stddev_negative", 5, 60, "stddev is -0.1.*from 0"},
    {"noise_bias_of_two", 5, 58, "bias has 2 elements.*expected 3"},
    {"noise_of_a_number", 5, 51, "is 0.1.*expected a map"},
    {"noise_dropout_above_one", 5, 42, "dropout is 1.5.*from 0 to 1"},
    {"noise_dropout_of_a_joint", 5, 64, "joints have no dropout"},
    {"noise_unknown_key", 5, 33, "unknown key 'drop_out'.*'dropout'"},
    {"tolerance_without_channel", 5, 14, "a tolerance has no 'channel'"},
    {"tolerance_of_nothing", 5, 14, "allows nothing.*atol"},
    {"tolerance_negative", 5, 37, "atol is -1.*from 0"},
    {"tolerance_lead", 5, 37, "lead is -0.001.*from 0 to 1 \\[s\\]"},
    {"tolerance_lag", 5, 36, "lag is 30.*from 0 to 1 \\[s\\]"},
    {"tolerance_ticks", 5, 38, "ticks is 1.5.*whole number from 0 to 1000"},
    {"tolerance_nan", 5, 37, "rtol is '.nan'.*expected a number from 0 to 1"},
    {"tolerance_leading_slash", 5, 24, "channel is '/Box/q'.*without a slash"},
    {"tolerance_pixel_delta", 5, 44, "pixel_delta is 300.*from 0 to 255"},
    {"tolerance_pixel_window", 5, 45, "pixel_window is 1.5.*from 0 to 1"},
    {"horizon_of_text", 5, 10, "horizon is 'soon'.*expected a number from 0 to 86400 \\[s\\]"},
    {"horizon_with_unit", 5, 10, "horizon is '2 s'.*expected a number"},
    {"horizon_negative", 5, 10, "horizon is -1.*from 0"},
    {"horizon_beyond_the_end", 5, 10, "horizon is 1.5, after the end.*up to the duration, 1 s"},
    {"expect_a_map", 5, 9, "expect is a map.*list of what has to be true"},
    {"expect_text", 5, 10, "an expectation is 'stands'.*map"},
    {"expect_unknown_key", 5, 40, "unknown key 'abov'.*did you mean 'above'"},
    {"expect_of_nothing", 5, 10, "an expectation has no 'channel'.*or event or no_event"},
    {"expect_of_two_things", 5, 10, "of two things in one.*one of channel, event and no_event"},
    {"expect_leading_slash", 5, 20, "channel is '/Box/q'.*without a slash"},
    {"expect_event_empty", 5, 18, "event is the text ''.*error"},
    {"expect_without_bound", 5, 10, "without a bound.*above, below, or near and within"},
    {"expect_nan", 5, 47, "above is 'nan'.*a number in the unit of the series"},
    {"expect_infinite", 5, 47, "below is '.inf'.*a number in the unit of the series"},
    {"expect_unit", 5, 47, "above is '10 grad'.*an angle as 10 deg"},
    {"expect_nothing_between", 5, 47, "above is 2, which is not less than below.*less than 1"},
    {"expect_within_without_near", 5, 48, "'within' without 'near'.*near: X"},
    {"expect_near_without_within", 5, 46, "'near' without 'within'.*within: D"},
    {"expect_near_and_above", 5, 71, "'above' beside 'near'.*either"},
    {"expect_within_negative", 5, 59, "within is -0.1.*at least 0"},
    {"expect_no_such_magnitude", 5, 58, "below is 0.*no magnitude is less"},
    {"expect_abs_number", 5, 45, "abs is 1 .*true or false"},
    {"expect_from_after_the_end", 5, 56, "from is 2, after the end of the run.*1 s"},
    {"expect_until_after_the_end", 5, 57, "until is 2, after the end of the run.*1 s"},
    {"expect_until_before_from", 5, 68, "until is 0.2, which is before from.*from 0.5"},
    {"expect_from_negative", 5, 56, "from is -1.*from 0"},
    {"expect_at_and_until", 5, 57, "'until' beside 'at'.*either a moment or a span"},
    {"expect_at_text", 5, 54, "at is 'last'.*a time .*or end"},
    {"expect_at_after_the_end", 5, 54, "at is 3, after the end of the run.*1 s"},
    {"expect_since_after_at", 5, 57, "since is 0.5, which is after at.*up to 0.2"},
    {"expect_since_after_from", 5, 57, "since is 0.5, which is after from.*up to 0.2"},
    {"expect_sometime_at", 5, 60, "'sometime' beside 'at'"},
    {"expect_event_with_bound", 5, 32, "'above' of an event.*from and until say when"},
};
// clang-format on

std::filesystem::path file_of(const std::string& name) { return fixtures / "broken" / ("scenario_" + name + ".yaml"); }

class BrokenScenario : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenScenario, IsRefusedAtItsPlace) {
  const Broken& broken = GetParam();
  const auto result = Scenario::load(file_of(broken.name));
  ASSERT_FALSE(result.ok());
  const Diagnostic& first = result.errors()[0];
  EXPECT_EQ(first.severity, Severity::error);
  EXPECT_EQ(first.file, file_of(broken.name).string());
  EXPECT_EQ(first.line, broken.line) << to_string(first);
  EXPECT_EQ(first.column, broken.column) << to_string(first);
  EXPECT_THAT(to_string(first), ::testing::ContainsRegex(broken.message));
  EXPECT_NE(first.hint, "") << "every message says what would be right";
}

TEST_P(BrokenScenario, HasNoOtherMistake) {
  const auto result = Scenario::load(file_of(GetParam().name));
  ASSERT_FALSE(result.ok());
  for (std::size_t i = 1; i < result.errors().size(); ++i)
    EXPECT_NE(result.errors()[i].file, result.errors()[0].file) << mistakes(result);
}

INSTANTIATE_TEST_SUITE_P(Files, BrokenScenario, ::testing::ValuesIn(all_broken),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

TEST(BrokenScenarios, AreAllInTheTable) {
  std::set<std::string> listed;
  for (const Broken& broken : all_broken) listed.insert(file_of(broken.name).filename().string());
  std::set<std::string> present;
  for (const auto& entry : std::filesystem::directory_iterator(fixtures / "broken")) {
    const std::string name = entry.path().filename().string();
    if (name.rfind("scenario_", 0) == 0 && entry.path().extension() == ".yaml") present.insert(name);
  }
  EXPECT_EQ(present, listed);
}

}  // namespace
}  // namespace rehearse
