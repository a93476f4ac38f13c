// One file per mistake: fixtures/broken/urdf_NAME.urdf, and the loader's message about it.
#include <rehearse/urdf.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace rehearse {
namespace {

struct Mistake {
  const char* name;
  int line;             // 0: of the whole file
  const char* message;  // a regular expression that the message must match
};

/// Refused, each with this one error.
const std::vector<Mistake> errors = {
    {"loop_axis_zero", 7, "the axis of a <loop_joint> is zero"},
    {"loop_of_one_link", 7, "loop_joint 'loop' connects a link to itself"},
    {"loop_of_unknown_type", 7, "unknown type 'screw' of a <loop_joint>"},
    {"loop_on_unknown_link", 7, "loop_joint 'loop' names 'leg', which isn't a link"},
    {"loop_without_end", 7, "a <loop_joint> without <link2>"},
    {"attribute_twice", 3, "an attribute of this tag isn't well-formed XML, or there are two of one name"},
    {"attribute_without_quotes", 3, "an attribute of this tag isn't well-formed XML"},
    {"axis_zero", 7, "the axis of joint 'hinge' is zero"},
    {"blank", 0, "the file is empty"},
    {"box_of_one_number", 5, "size of <box> is '1', not three numbers"},
    {"comment_only", 0, "the file is empty"},
    {"contact_without_value", 5, "<lateral_friction> has no attribute 'value'"},
    {"cylinder_without_length", 5, "<cylinder> has no attribute 'length'"},
    {"damping_negative", 7, "joint 'hinge' has a negative damping, friction or armature"},
    {"empty", 0, "the file is empty"},
    {"end_tag_missing", 4, "the element that begins here isn't closed by its own end tag"},
    {"gazebo_direction_of_two", 5, "<fdir1> contains '1 0', not three numbers"},
    {"gazebo_flag_of_text", 5, "<selfCollide> contains 'perhaps'"},
    {"gazebo_friction_of_text", 5, "<mu1> contains 'slippery', not a number"},
    {"geometry_unknown", 8, "unknown geometry <cone>"},
    {"git_lfs_pointer", 1, "this is a git-lfs pointer, not the file it stands for"},
    {"inertial_without_mass", 10, "<inertial> of link 'arm' has no <mass>"},
    {"joint_type_unknown", 4, "unknown joint type 'hinge'"},
    {"joint_without_child", 4, "joint 'hinge' has no <child>"},
    {"joint_without_name", 4, "<joint> has no name"},
    {"joint_without_type", 4, "a joint without a type"},
    {"link_name_not_utf8", 2, "the name 'w.rld' of <link> isn't plain UTF-8 text"},
    {"link_without_name", 4, "<link> has no name"},
    {"loop", 10, "a loop: joint 'back' makes link 'left' its own ancestor"},
    {"mass_negative", 11, "link 'arm' has negative mass"},
    {"mass_zero", 9, "link 'arm' moves but has no mass"},
    {"merge_conflict", 4, "a merge conflict is left in the file"},
    {"mesh_absent", 5, "the mesh 'meshes/absent.stl' can't be used: there is no 'absent.stl' in "},
    {"mesh_empty_file", 5, "'meshes/empty.obj' can't be used: it is empty"},
    {"mesh_face_beyond_its_vertices", 5, "line 5: a face refers to vertex 4, and there are 3"},
    {"mesh_from_the_web", 5, "'https://example.org/arm.stl' can't be used: nothing is read from https://"},
    {"mesh_git_lfs_pointer", 5, "it is a git-lfs pointer, not the mesh it stands for"},
    {"mesh_not_finite", 5, "a vertex of it isn't finite"},
    {"mesh_of_another_case", 5, "there is no 'Triangle.STL' in .*; there is 'triangle.stl'"},
    {"mesh_of_unknown_format", 5, "'meshes/triangle.ply' can't be used: .ply isn't a format that is read"},
    {"mesh_of_unknown_package", 5, "'package://nowhere/meshes/arm.stl' can't be used: there is no package 'nowhere'"},
    {"mesh_package_alone", 5, "package:// is not followed by a name and a path"},
    {"mesh_scale_of_two", 5, "scale of <mesh> is '1 1', not three numbers"},
    {"mesh_scale_zero", 5, "the scale of a <mesh> is '1 0 1', with a factor of 0"},
    {"mesh_that_is_a_directory", 5, "its name has no extension that states its format"},
    {"mesh_truncated_dae", 5, "'meshes/truncated.dae' can't be used: assimp reports: "},
    {"mesh_truncated_glb", 5, "it is truncated: 200 bytes, fewer than its header states"},
    {"mesh_truncated_obj", 5, "line 5: a face has fewer than three corners; the file may be truncated"},
    {"mesh_truncated_stl", 5, "it is truncated: 2 triangles need 184 bytes, and it has 134"},
    {"mesh_vrml", 5, "'meshes/triangle.wrl' can't be used: it has no triangles"},
    {"mesh_without_file", 5, "<mesh> has no filename"},
    {"mesh_without_triangles", 5, "it has no triangles"},
    {"mimic_of_a_fixed", 12, "joint 'right' mimics 'left', which doesn't move"},
    {"mimic_of_a_track", 12, "joint 'right' mimics 'left', but 'left' is a track"},
    {"mimic_of_an_unknown", 12, "joint 'right' mimics 'middle', which is not a joint"},
    {"mimic_of_itself", 7, "joint 'hinge' mimics itself"},
    {"mimic_without_joint", 12, "<mimic> has no joint"},
    {"moving_without_mass", 9, "link 'arm' moves but has no mass"},
    {"nested_100000_deep", 3, "elements are nested deeper than 90 levels"},
    {"no_links", 0, "the robot has no links"},
    {"not_xml", 1, "this is not XML: it begins with"},
    {"number_infinite", 11, "value of <mass> is 'inf', not a number"},
    {"number_overflow", 11, "value of <mass> is '1e400', not a number"},
    {"number_with_comma", 7, "xyz of <origin> is '0 0,5 0', not three numbers"},
    {"number_with_unit", 7, "lower of <limit> is '-90deg', not a number"},
    {"origin_of_two", 7, "xyz of <origin> is '0 0.5', not three numbers"},
    {"own_parent", 5, "a loop: joint 'knot' makes link 'arm' its own ancestor"},
    {"parent_without_link", 5, "<parent> has no link"},
    {"planar", 4, "planar joints aren't supported"},
    {"quaternion_of_three", 7, "quat_xyzw of <origin> is '0 0 1', not four numbers"},
    {"quaternion_zero", 7, "quat_xyzw of <origin> is zero"},
    {"rotation_as_quaternion_and_angles", 7, "an <origin> has both quat_xyzw and rpy"},
    {"safety_controller_of_text", 8, "k_velocity of <safety_controller> is 'some', not a number"},
    {"sdf", 2, "the file's element is <sdf>"},
    {"spherical", 4, "spherical joints aren't supported"},
    {"sphere_negative", 4, "<collision> has a shape of negative size"},
    {"two_geometries", 8, "a second <geometry> in one <collision>"},
    {"two_inertials", 14, "a second <inertial> in one <link>"},
    {"two_joints_of_one_name", 10, "a second joint with the name 'weld', after the one in line 6"},
    {"two_links_of_one_name", 4, "a second link with the name 'world', after the one in line 3"},
    {"two_parents", 14, "link 'hand' has two parents: joint 'hand_weld' in line 10 and joint 'second_weld'"},
    {"two_robots", 4, "the file continues after </robot>"},
    {"two_roots", 4, "3 root links: 'world', 'arm', 'leg'"},
    {"track_of_a_fixed_joint", 20, "joint 'right' can't be a track: it is fixed"},
    {"track_of_text", 20, "<pseudo_continuous_track> contains 'perhaps', not true or false"},
    {"track_on_nothing", 20, "a track on 'middle', which is neither a joint nor a link below one"},
    {"track_without_reference", 20, "a track names no joint"},
    {"undefined_link", 4, "joint 'weld' has the child 'arm', which is not a link"},
    {"utf16", 0, "the file is UTF-16"},
    {"web_page", 1, "a document type isn't allowed here"},
    {"xacro", 5, "this is a xacro file that hasn't been expanded"},
    {"zero_byte", 3, "a zero byte: this is not a text file"},
};

/// Two errors of one mistake: joints that follow each other.
const std::vector<Mistake> mimic_circle = {
    {"mimic_in_a_circle", 7, "joint 'left' mimics itself, by way of 'right'"},
    {"mimic_in_a_circle", 12, "joint 'right' mimics itself, by way of 'left'"},
};

/// Loaded with this one repair; refused when strict.
const std::vector<Mistake> repairs = {
    {"spring_negative", 7, "the spring of joint 'hinge' has a stiffness of -5; it is left out"},
    {"inertia_not_positive_definite", 9,
     "the inertia of moving link 'arm' isn't positive definite; it gets the nearest that is, with the principal "
     "moments "
     "0.003, 1 and 3 kg·m² instead of -1, 1 and 3"},
    {"inertia_zero", 9,
     "moving link 'arm' has mass but no inertia; it gets the inertia of 1 kg spread over a ball of 0.062 m radius"},
    {"inertial_without_inertia", 9,
     "moving link 'arm' has mass but no inertia; it gets the inertia of 1 kg spread over"},
    {"color_of_three", 6, "rgba '1 0 0' gets an alpha of 1"},
    {"inertia_without_ixy", 12, "the inertia of link 'arm' lacks products; they are taken for 0"},
    {"limit_lower_above_upper", 7,
     "joint 'hinge' has a lower limit of 1 above its upper limit of -1; they are exchanged"},
    {"two_inertias", 13, "a second <inertia> in one <inertial>; the first counts"},
    {"two_limits", 8, "a second <limit> in one <joint>; the first counts"},
    {"two_origins", 8, "a second <origin> in one <joint>; the first counts"},
    {"geometry_of_two", 7, "a second shape in one <geometry>; each is taken"},
    {"robot_without_name", 1, "the robot has no name; it gets that of its file, 'urdf_robot_without_name'"},
    {"light_named_like_a_sensor", 6, "a second device with the name 'lamp', after the one in line 5"},
    {"two_lights_of_one_id", 6, "light 'right' has the id 0 of light 'left' in line 5"},
    {"two_sensors_of_one_id", 6, "sensor 'right' has the id 0 of sensor 'left' in line 5"},
    {"two_sensors_of_one_name", 6, "a second sensor with the name 'gyro', after the one in line 5"},
    {"two_materials", 7, "a second <material> in one <visual>; the first counts"},
    {"two_sensors_in_one_place", 6,
     "a second sensor 'gyro' of the same kind at the same place, after the one in line 5"},
    {"color_of_bytes", 6, "rgba '255 0 0 1' is brought into 0 to 1"},
    {"contact_restitution_of_two", 6, "<restitution> is 2; it is left out"},
    {"effort_negative", 7, "the effort limit of joint 'hinge' is negative; it is unlimited"},
    {"free_root_without_mass", 3, "root link 'base' has no mass; it is fixed to the world"},
    {"gazebo_friction_negative", 5, "<mu1> is -1; it is left out"},
    {"gazebo_stiffness_zero", 5, "<kp> is 0; it is left out"},
    {"limit_missing", 4, "revolute joint 'hinge' has no <limit>; it is unlimited"},
    {"limit_without_effort", 7, "the limit of joint 'hinge' has no effort; it is unlimited"},
    {"limit_without_velocity", 7, "the limit of joint 'hinge' has no velocity; it is unlimited"},
    {"material_of_two_colors", 4, "material 'paint' has another colour in line 3; from here on this colour applies"},
    {"material_without_anything", 6, "a material with neither name nor colour is left out"},
    {"material_without_name", 6, "a material without a name; its colour is used in this place only"},
    {"mesh_scale_of_one", 5, "the scale of a <mesh> is '0.001'; it is taken for 0.001 0.001 0.001"},
    {"mesh_scale_of_four", 5, "the scale of a <mesh> is '1 2 3 1'; it is taken for 1 2 3"},
    {"world_undeclared", 3, "the parent of joint 'hinge' is a link 'world' that isn't declared; it is added"},
};

/// Loaded as they are, or without a sensor or shape, with this one warning, strict or not.
const std::vector<Mistake> warnings = {
    {"geometry_empty", 5, "<collision> has no shape; it is left out"},
    {"geometry_missing", 4, "<collision> has no shape; it is left out"},
    {"geometry_with_origin", 7, "<origin> in a <geometry> isn't a shape; it is left out"},
    {"geometry_plane", 6, "a <plane> is left out"},
    {"camera_near_beyond_far", 10, "<near> is 10, not below <far>, which is 0.1"},
    {"camera_of_half_a_pixel", 9, "<width> is 64.5, not a whole number"},
    {"camera_of_no_width", 9, "<width> is 0; it must be above 0 and at most 8192"},
    {"camera_rate_zero", 6, "<update_rate> is 0; it must be above 0"},
    {"camera_sees_behind_itself", 8, "<horizontal_fov> is 3.2; it must be above 0 and at most 3.1"},
    {"camera_too_wide", 9, "<width> is 20000; it must be above 0 and at most 8192"},
    {"camera_width_of_text", 9, "<width> contains 'wide', not a number"},
    {"camera_with_two_angles", 8, "there are both <vertical_fov> and <horizontal_fov>"},
    {"camera_without_camera", 5, "camera 'eye' has no <camera>"},
    {"force_direction_unknown", 18, "<measure_direction> contains 'down', not child_to_parent or parent_to_child"},
    {"force_frame_unknown", 18, "<frame> contains 'world', not child, parent or sensor"},
    {"laser_angle_empty", 8, "sensor 'laser' is left out: <min_angle> contains '', not a number"},
    {"laser_angles_backwards", 8, "<min_angle> of <horizontal> is 1, above <max_angle>, which is -1"},
    {"laser_beams_all_alike", 8, "the 11 beams of <horizontal> all have the angle 0"},
    {"laser_beyond_the_zenith", 9, "<max_angle> of <vertical> is 1.7; it must be -1.6 to 1.6"},
    {"laser_in_degrees", 8, "<max_angle> of <horizontal> is 90; it must be -6.3 to 6.3"},
    {"laser_of_half_a_beam", 8, "<samples> is 10.5, not a whole number"},
    {"laser_of_no_beams", 8, "<samples> is 0; it must be above 0 and at most 1000000"},
    {"laser_of_too_many_beams", 7, "a scan has 2000000 beams; 1000000 are the most that are supported"},
    {"laser_range_backwards", 10, "<min> is 10, not below <max>, which is 0.1"},
    {"laser_range_negative", 10, "<min> is -0.1; it must not be below 0"},
    {"laser_range_without_max", 10, "<range> has no <max>"},
    {"laser_rate_zero", 6, "<update_rate> is 0; it must be above 0"},
    {"laser_resolution_zero", 8, "<resolution> is 0; it must be above 0 and at most 1000000"},
    {"laser_without_horizontal", 7, "<scan> has no <horizontal>"},
    {"laser_without_range", 6, "<ray> has no <range>"},
    {"laser_without_ray", 5, "range sensor 'laser' has neither <ray> nor <lidar>"},
    {"laser_without_scan", 6, "<ray> has no <scan>"},
    {"light_attenuation_negative", 6, "<linear> is -0.5; it must not be below 0"},
    {"light_color_of_bytes", 6, "the colour of <diffuse> has a component outside of 0 to 1"},
    {"light_color_of_three", 6, "<diffuse> contains '1 1 0', not four numbers"},
    {"light_cone_in_degrees", 6, "<outer_angle> is 40; it must be above 0 and at most 6.2832"},
    {"light_cone_inside_out", 6, "<inner_angle> is 1, above <outer_angle>, which is 0.5"},
    {"light_cone_without_angle", 6, "<spot> has no <outer_angle>"},
    {"light_direction_of_two", 6, "<direction> contains '0 -1', not three numbers"},
    {"light_direction_zero", 6, "the <direction> of a light is zero"},
    {"light_intensity_negative", 6, "<intensity> is -1; it must not be below 0"},
    {"light_on_unknown_link", 5, "light 'lamp' is left out: it is on 'head', which is not a link"},
    {"light_range_zero", 6, "<range> is 0; it must be above 0"},
    {"light_without_name", 5, "<light> has no name"},
    {"light_without_spot", 5, "light 'lamp' has no <spot>"},
    {"optical_camera_near_beyond_far", 7, "near is 20, not below far, which is 10"},
    {"optical_camera_of_half_a_pixel", 7, "width of <image> is 64.5, not a whole number"},
    {"optical_camera_of_no_width", 7, "width of <image> is 0; it must be above 0 and at most 8192"},
    {"optical_camera_rate_zero", 4, "update_rate of <sensor> is 0; it must be above 0"},
    {"optical_camera_without_angle", 7, "<image> has no attribute 'hfov'"},
    {"optical_laser_angles_backwards", 7, "min_angle of <horizontal> is 1, above max_angle, which is -1"},
    {"optical_laser_in_degrees", 7, "the angles of <horizontal> are -90 and 90; they must be -6.3 to 6.3"},
    {"optical_laser_without_samples", 7, "<horizontal> has no attribute 'samples'"},
    {"sensor_id_negative", 5, "the id -1 isn't a whole number"},
    {"sensor_on_nothing", 5, "sensor 'gyro' is on no link"},
    {"sensor_on_unknown_link", 5, "sensor 'gyro' is left out: it is on 'head', which is not a link"},
    {"sensor_on_unknown_joint", 4, "sensor 'force' is left out: it is on 'hinge', which is not a joint"},
    {"sensor_pose_of_three", 5, "<pose> contains '0 0 1', not six numbers"},
    {"sensor_without_name", 5, "<sensor> has no name"},
    {"sensor_without_parent", 4, "sensor 'imu' is on no link"},
    {"two_cameras_in_a_sensor", 7, "sensor 'eye' has a second <camera>"},
    {"center_of_mass_in_millimetres", 9, "the centre of mass of link 'arm' is far outside its shapes: 500 m"},
    {"contact_of_two_shapes", 9,
     "contact sensor 'skin' names 2 of 3 collision shapes; contacts of all shapes of link 'world' count"},
    {"contact_of_unknown_shape", 9, "names the collision shape 'side', which link 'world' doesn't have"},
    {"contact_without_shapes", 5, "contact sensor 'skin' measures nothing: link 'world' has no collision shape"},
    {"force_direction_reversed", 18, "sensor 'force' is to measure the wrench of the parent link on its child"},
    {"force_frame_that_turns", 16, "sensor 'force' measures along the axes of its own link 'arm'"},
    {"gazebo_friction_on_a_joint", 15, "<gazebo> sets properties of links for joint 'hinge'"},
    {"gazebo_on_unknown_link", 4, "<gazebo> refers to 'leg', which is neither a link nor a joint"},
    {"gazebo_static_with_joints", 16, "<static> fixes the root link to the world; the joints move nevertheless"},
    {"holder_condition_unknown", 7, "<condition> contains 'magnet', not distance, collision or name"},
    {"holder_without_target", 7, "a holder that holds by name has no <target>"},
    {"rotor_direction_zero", 7, "the <direction> of a rotor is zero"},
    {"rotor_of_no_joint", 7, "a rotor of 'knee', which isn't a joint that moves"},
    {"spring_of_no_joint", 7, "a spring of 'world', which isn't a joint that moves"},
    {"inertia_in_grams", 9, "link 'arm' has the inertia of a body many metres wide: its radius of gyration is 50 m"},
    {"inertia_of_no_body", 9, "no body has the inertia of link 'arm'"},
    {"inertia_tiny", 9, "the inertia of moving link 'arm' is that of 1 kg within 1e-05 m"},
    {"joint_far_away", 10, "joint 'mount' is 150 m away from the origin of its parent link"},
    {"limit_excludes_zero", 7, "joint 'hinge' can't be at 0: its range is 0.5 to 1"},
    {"limit_in_degrees", 7, "joint 'hinge' has limits of -90 and 90 rad, which look like degrees"},
    {"limit_lower_is_upper", 7, "joint 'hinge' can't move: its lower and upper limits are both 0.5"},
    {"limit_without_range", 7, "joint 'hinge' can't move: its lower and upper limits are both 0"},
    {"material_with_texture", 6, "the <texture> 'wood.png' of a material isn't drawn"},
    {"mass_of_a_feather", 19, "link 'feather' has 0.0001 kg and another has 1 kg"},
    {"material_unknown", 6, "material 'gold' has no colour anywhere in the file"},
    {"mesh_taken_from_above", 5,
     "package 'nowhere' doesn't contain the file; it is taken from meshes/triangle.stl, a guess"},
    {"mesh_without_its_materials", 5, "'meshes/painted.obj': its file 'painted.mtl' can't be read"},
    {"mesh_without_its_texture", 5, "its texture 'photo.png' can't be used: it isn't there, beside the mesh"},
    {"sensor_of_old_gazebo", 5, "<sensor:camera> is the form of a sensor in Gazebo before 2012"},
    {"version_of_tomorrow", 2, "the file is of URDF version '2.0'; it is read as 1.1"},
    {"sphere_of_no_size", 4, "<collision> has a shape of size 0; it is left out"},
};

const std::filesystem::path folder = FIXTURES_DIR "/broken";

std::string path_of(const Mistake& mistake) {
  return (folder / ("urdf_" + std::string(mistake.name) + ".urdf")).string();
}

Diagnostics of_severity(const Diagnostics& all, Severity severity) {
  Diagnostics some;
  std::ranges::copy_if(all, std::back_inserter(some),
                       [&](const Diagnostic& diagnostic) { return diagnostic.severity == severity; });
  return some;
}

/// Checks that there is one finding, and that it is that of the mistake.
void expect_only(const Diagnostics& found, const Mistake& mistake) {
  ASSERT_EQ(found.size(), 1u) << path_of(mistake) << "\n" << to_string(found);
  EXPECT_EQ(found[0].file, path_of(mistake));
  EXPECT_EQ(found[0].line, mistake.line) << to_string(found);
  EXPECT_THAT(found[0].message, testing::ContainsRegex(mistake.message)) << path_of(mistake);
}

TEST(BrokenUrdf, IsRefusedWithTheLineAndTheReason) {
  for (const Mistake& mistake : errors) {
    const Result<Model> result = load_urdf(path_of(mistake));
    ASSERT_FALSE(result) << path_of(mistake);
    expect_only(result.errors(), mistake);
  }
}

TEST(BrokenUrdf, ACircleOfMimicsIsToldAtEachOfItsJoints) {
  const Result<Model> result = load_urdf(path_of(mimic_circle[0]));
  ASSERT_FALSE(result);
  ASSERT_EQ(result.errors().size(), 2u) << to_string(result.errors());
  for (std::size_t i = 0; i < 2; ++i) expect_only({result.errors()[i]}, mimic_circle[i]);
}

TEST(BrokenUrdf, IsRepairedByNameWhereThatIsSafe) {
  for (const Mistake& mistake : repairs) {
    const Result<Model> result = load_urdf(path_of(mistake));
    ASSERT_TRUE(result) << to_string(result.errors());
    expect_only(of_severity(result->report, Severity::repair), mistake);
  }
}

TEST(BrokenUrdf, IsNotRepairedWhenStrict) {
  for (const Mistake& mistake : repairs) {
    const Result<Model> result = load_urdf(path_of(mistake), {.strict = true});
    ASSERT_FALSE(result) << path_of(mistake);
    expect_only(result.errors(), mistake);
    EXPECT_THAT(result.errors()[0].hint, testing::EndsWith("strict loading repairs nothing"));
  }
}

TEST(BrokenUrdf, IsWarnedOfWhereItCanBeMeant) {
  for (const Mistake& mistake : warnings) {
    const Result<Model> result = load_urdf(path_of(mistake), {.strict = true});
    ASSERT_TRUE(result) << to_string(result.errors());
    expect_only(of_severity(result->report, Severity::warning), mistake);
  }
}

TEST(BrokenUrdf, EveryFileIsInATable) {
  std::set<std::string> known;
  for (const auto* table : {&errors, &mimic_circle, &repairs, &warnings}) {
    for (const Mistake& mistake : *table) known.insert(path_of(mistake));
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(!name.starts_with("urdf_") || known.contains(entry.path().string())) << name;
  }
}

}  // namespace
}  // namespace rehearse
