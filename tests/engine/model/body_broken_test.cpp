// One file per mistake: fixtures/broken/body_NAME.body, and the loader's message about it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/body.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace rehearse {
namespace {

const std::string folder = FIXTURES_DIR "/broken/";

struct Mistake {
  const char* name;
  int line;             // 0: of the whole file
  const char* message;  // that the message begins with
};

/// Refused, with this error first.
const std::vector<Mistake> errors = {
    {"a_list", 1, "the file isn't a mapping of keys and values"},
    {"alias_unknown", 6, "it can't be read as YAML: the referenced anchor is not defined"},
    {"angle_unit_unknown", 1, "the unit of angles 'grad' isn't known"},
    {"another_format", 1, "the format is 'SomebodysBody'"},
    {"box_of_two", 9, "size isn't a list of 3 numbers"},
    {"camera_format_unknown", 8, "the format 'INFRARED' of Camera 'EYE' isn't known"},
    {"camera_of_half_a_pixel", 8, "width of a camera is 0.5 pixels"},
    {"camera_too_wide", 8, "the field of view of Camera 'EYE' is 3.49066 rad"},
    {"element_of_another_type", 8, "a node of the type 'Transform' is under the key 'Shape'"},
    {"element_of_text", 8, "an element isn't a mapping of keys and values"},
    {"element_type_unknown", 8, "the element type 'Hologram' isn't known"},
    {"element_without_type", 8, "an element has no type"},
    {"empty", 1, "the file isn't a mapping of keys and values"},
    {"extra_joint_on_nothing", 8, "an extra joint is on 'TIP', which is not a link"},
    {"extra_joint_unknown", 8, "the type of an extra joint is 'spring'"},
    {"extrusion_of_a_point", 9, "an Extrusion needs two points of its spine and two of its section"},
    {"face_beyond_its_vertices", 9,
     "a geometry can't be used: a face refers to a vertex that isn't there; there are 3"},
    {"geometry_unknown", 9, "the geometry type 'Torus' isn't known"},
    {"git_lfs_pointer", 1, "it is a git-lfs pointer, not the file that it stands for"},
    {"inertia_of_three", 7, "inertia isn't a list of 9 numbers"},
    {"joint_axis_unknown", 7, "the joint axis 'W' isn't known"},
    {"joint_axis_zero", 7, "the joint axis is zero"},
    {"joint_id_fraction", 7, "the jointId is 0.5"},
    {"joint_range_backwards", 7, "joint_range begins at 90 and ends at -90"},
    {"joint_range_of_three", 7, "joint_range is neither a number nor a list of two"},
    {"joint_type_unknown", 7, "the joint type 'hinge' isn't known"},
    {"laser_in_radians_of_a_turn", 8, "the yaw of a range sensor is 6.98132 rad in 7 beams"},
    {"link_type_unknown", 6, "links can't contain a node of the type 'Rope'"},
    {"link_without_name", 5, "a link has no name"},
    {"links_empty", 4, "the body has no link"},
    {"links_of_text", 4, "links isn't a mapping of keys and values"},
    {"loop", 7, "a loop: joint 'ARM' makes link 'ARM' its own ancestor"},
    {"mass_negative", 7, "the mass of link 'ARM' is -1 kg"},
    {"mass_of_text", 7, "mass is 'heavy', and a number is expected"},
    {"mass_zero", 7, "link 'ARM' moves but has no mass"},
    {"mesh_absent", 8, "the mesh 'meshes/absent.stl' can't be used: there is no 'absent.stl' in "},
    {"mesh_git_lfs_pointer", 8,
     "the mesh 'meshes/pointer.stl' can't be used: it is a git-lfs pointer, not the mesh it stands for"},
    {"mesh_node_unknown", 8, "the mesh '../models/meshes/wheel.wrl' can't be used: it has no node 'RIM_OF_ANOTHER'"},
    {"mesh_of_unknown_format", 8, "the mesh 'meshes/triangle.ply' can't be used: .ply isn't a format that is read"},
    {"no_format", 1, "it isn't a Choreonoid body: the format is missing"},
    {"no_links", 1, "the file has no links"},
    {"no_version", 1, "the format version is missing"},
    {"not_yaml", 4, "it can't be read as YAML: this '[' isn't closed"},
    {"parent_missing", 7, "link 'ARM' has no parent"},
    {"parent_unknown", 7, "joint 'ARM' has the parent 'BASF', which is not a link"},
    {"radian_in_version_2", 1, "radian is not allowed from format version 2.0 on"},
    {"resource_anchor_unknown", 8, "the resource 'body_scene.yaml' has no anchor 'SPOUT'"},
    {"resource_without_uri", 8, "a Resource has no uri"},
    {"resource_yaml_absent", 8, "the resource 'absent.yaml' can't be used: there is no 'absent.yaml' in"},
    {"root_unknown", 0, "the root link 'WAIST' is not a link"},
    {"rotation_axis_zero", 6, "the axis of a rotation is zero"},
    {"rotation_of_three", 6, "a rotation isn't a list of 4 numbers"},
    {"rules_of_text", 7, "collision_detection_rules isn't a list"},
    {"scale_zero", 9, "a factor of the scale is 0"},
    {"sphere_negative", 9, "the radius of a geometry is -1 m"},
    {"sub_body_absent", 7, "the sub-body 'absent.body' can't be used: there is no 'absent.body' in"},
    {"sub_body_of_itself", 7,
     "the sub-body 'body_sub_body_of_itself.body' can't be used: its sub-bodies contain each other"},
    {"sub_body_without_uri", 7, "a SubBody has no uri"},
    {"translation_of_text", 6, "a translation is 'here', and a number is expected"},
    {"translation_of_two", 6, "a translation isn't a list of 3 numbers"},
    {"two_links_of_one_name", 8, "a second link with the name 'ARM', after the one in line 7"},
    {"variable_unknown", 8, "the resource '${MY_PARTS}/wheel.stl' can't be used: there is no folder for ${MY_PARTS}"},
    {"version_of_tomorrow", 1, "the format version 2.1 isn't known"},
    {"visual_in_collision", 10, "a Visual is within a Collision"},
};

/// Loaded, with this warning.
const std::vector<Mistake> warnings = {
    {"axis_of_a_slider", 7, "the axis of a sliding joint has the length 2; it is made 1"},
    {"body_handler", 7, "the body handler 'WalkingHandler' is code of Choreonoid's; it is left out"},
    {"box_flat", 9, "a Box is flat; it gets a thickness of 0.001 m"},
    {"camera_fisheye", 8, "Camera 'EYE' is left out: it has a FISHEYE lens, and only NORMAL is drawn"},
    {"camera_without_format", 8, "Camera 'EYE' has no format; it is left out, as in Choreonoid"},
    {"degrees_at_the_start_of_a_radian_file", 7, "the displacement 90 rad of a joint looks like degrees"},
    {"degrees_below_in_radian_file", 7, "the limit -90 rad of a joint looks like degrees"},
    {"degrees_in_radian_file", 7, "the limit 90 rad of a joint looks like degrees"},
    {"inertia_not_symmetric", 7, "the inertia isn't symmetric; the mean of both sides is taken"},
    {"joint_id_gap", 0, "the jointIds have gaps: 1 ids up to 1; controllers see joints without effect"},
    {"joint_id_twice", 8, "the jointId 0 of link 'HAND' appears twice; controllers see the first link"},
    {"key_misspelt", 7, "the key 'joinType' of a link isn't read"},
    {"key_twice", 9, "the key 'type' appears twice; the last one counts"},
    {"moving_without_mass", 7, "link 'ARM' has no mass: it gets 1 kg and the inertia 1 1 1, as in Choreonoid"},
    {"number_with_unit", 7, "mass is '1.0kg'; it is read as 1"},
    {"plugin_device", 8, "AGXWireDevice needs AGX Dynamics; it is left out"},
    {"rotation_in_degrees", 6, "a rotation by 90 rad looks like degrees"},
    {"two_devices_of_one_name", 9, "a second device has the name 'FORCE'; it gets 'FORCE_2'"},
    {"velocity_range_uneven", 7, "the range of velocity is -90 to 180: controllers see both limits, drives keep to 90"},
};

std::string path_of(const Mistake& mistake) { return folder + "body_" + mistake.name + ".body"; }

void expect_told(const Diagnostics& findings, Severity severity, const Mistake& mistake) {
  const auto is_told = [&](const Diagnostic& finding) {
    return finding.severity == severity && finding.line == mistake.line && finding.file == path_of(mistake) &&
           finding.message.starts_with(mistake.message);
  };
  EXPECT_TRUE(std::ranges::any_of(findings, is_told)) << path_of(mistake) << "\n" << to_string(findings);
}

TEST(BrokenBody, IsRefusedWithTheLineAndTheReason) {
  for (const Mistake& mistake : errors) {
    const Result<Model> result = load_body(path_of(mistake));
    ASSERT_FALSE(result) << path_of(mistake);
    expect_told({result.errors().front()}, Severity::error, mistake);
  }
}

TEST(BrokenBody, IsWarnedOfWhereItCanBeMeant) {
  for (const Mistake& mistake : warnings) {
    const Result<Model> result = load_body(path_of(mistake), {.strict = true});
    ASSERT_TRUE(result) << to_string(result.errors());
    expect_told(result->report, Severity::warning, mistake);
    const auto count = std::ranges::count_if(
        result->report, [](const Diagnostic& finding) { return finding.severity == Severity::warning; });
    EXPECT_EQ(count, 1) << to_string(result->report);
  }
}

TEST(BrokenBody, MayLackItsMeshesIfThatIsAllowed) {
  for (const char* name : {"mesh_absent", "mesh_git_lfs_pointer", "mesh_of_unknown_format"}) {
    const Result<Model> result = load_body(path_of({name, 0, ""}), {.allow_missing_meshes = true});
    ASSERT_TRUE(result) << to_string(result.errors());
    EXPECT_TRUE(result->links[0].visuals.empty());
    EXPECT_THAT(to_string(result->report), testing::HasSubstr("can't be used; its shape is left out"));
  }
}

TEST(BrokenBody, NamesTheOptionForAnUnknownVariable) {
  const Result<Model> result = load_body(folder + "body_variable_unknown.body");
  EXPECT_THAT(to_string(result.errors()), testing::HasSubstr("--variable MY_PARTS=DIR"));
  const Result<Model> given = load_body(folder + "body_variable_unknown.body", {.packages = {{"MY_PARTS", folder}}});
  EXPECT_THAT(to_string(given.errors()), testing::HasSubstr("package 'MY_PARTS' was given as"));
}

TEST(BrokenBody, EveryFileIsInATable) {
  std::set<std::string> known;
  for (const auto* table : {&errors, &warnings})
    for (const Mistake& mistake : *table) known.insert(path_of(mistake));
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool is_body = name.starts_with("body_") && name.ends_with(".body");
    EXPECT_TRUE(!is_body || known.contains(entry.path().string())) << name;
  }
}

}  // namespace
}  // namespace rehearse
