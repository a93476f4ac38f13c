// One file per mistake: fixtures/broken/mjcf_NAME.xml, and the reader's message about it.
#include <rehearse/body.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace rehearse {
namespace {

struct Mistake {
  const char* name;
  int line;
  const char* message;  // a part of it
  const char* hint;     // a part of it
};

const std::vector<Mistake> errors = {
    {"actuator_of_a_tendon", 8, "a motor actuator that drives no joint isn't supported", "joint=\"NAME\""},
    {"actuator_of_no_joint", 8, "an actuator drives joint 'hing', which the model lacks", "did you mean 'hinge'?"},
    {"axis_zero", 4, "the axis of joint 'hinge' is zero", "as in 0 0 1"},
    {"ball_joint", 4, "a <joint> of type ball isn't supported", "three hinges, about x, y and z"},
    {"box_of_one_number", 5, "the size of a <geom> of type box is '0.1'", "3 numbers above 0"},
    {"class_twice", 2, "a second class of defaults has the name 'leg'", "a name of its own"},
    {"class_unknown", 5, "the class 'leg' of <geom> isn't there", ""},
    {"class_without_name", 2, "a class of defaults has no name", "class=\"NAME\""},
    {"composite", 6, "<composite> in a body isn't supported", "--allow-unsupported"},
    {"coordinates_global", 2, "coordinate of <compiler> is 'global'", "MuJoCo 2.3.1"},
    {"equality_of_no_joint", 8, "an equality of joint 'elbow', which the model lacks", "hinge"},
    {"equality_weld", 8, "an equality of type weld isn't supported", "joint"},
    {"euler_order_of_two", 2, "eulerseq of <compiler> is 'xy'", "three of x y z X Y Z"},
    {"exclude_of_no_body", 8, "<exclude> names body 'hand', which the model lacks", "arm"},
    {"free_within", 6, "body 'hand' has a free joint within another body", "only bodies of <worldbody> are free"},
    {"friction_negative", 5, "friction of <geom> is negative", "at least 0"},
    {"fromto_without_length", 5, "fromto of <geom> has no length", "two different points"},
    {"geom_type_unknown", 5, "the type of a <geom> is 'cone'", "sphere, capsule"},
    {"include_absent", 2, "the included file 'absent.xml' can't be read", ""},
    {"include_of_itself", 2, "the file includes itself", "include other files"},
    {"inertia_not_positive", 5, "fullinertia of <inertial> isn't positive definite", "ixx iyy izz"},
    {"joint_twice", 6, "a second joint with the name 'hinge', after the one in line 4", ""},
    {"joint_type_unknown", 4, "the type of a <joint> is 'revolute'", "free, hinge or slide"},
    {"keyframe_too_short", 8, "qpos of <key> is '0 0 1'", "at least 7 numbers"},
    {"limited_without_range", 4, "<joint> is limited without a range", "range=\"-1 1\""},
    {"mass_negative", 5, "a <geom> has the mass -1", "0 or more"},
    {"mass_zero", 3, "link 'arm' moves but has no mass", "<inertial>"},
    {"material_unknown", 5, "<geom> has the material 'gold', which <asset> lacks", ""},
    {"mesh_absent", 2, "the mesh 'meshes/absent.stl' can't be used: there is no 'absent.stl' in ", ""},
    {"mesh_unknown", 5, "a <geom> has the mesh 'arm', which <asset> lacks", ""},
    {"not_closed", 3, "the element that begins here isn't closed by its own end tag", ""},
    {"number_of_text", 4, "damping of <joint> is 'much'", "expected numbers"},
    {"orientation_twice", 5, "<geom> has both quat and euler", "give one orientation"},
    {"quat_zero", 5, "quat of <geom> is '0 0 0 0', which is no direction", "a length above 0"},
    {"range_backwards", 4, "range of <joint> is '90 -90'", "the lower limit, then a larger one"},
    {"section_unknown", 8, "unknown section <actuators> of <mujoco>", "actuator"},
    {"sensor_of_no_site", 8, "a gyro sensor is at the site 'imu', which the model lacks", "<site"},
    {"tendon", 8, "<tendon> isn't supported", "allow_unsupported: true"},
    {"world_empty", 1, "the model has no body", "<worldbody><body"},
    {"world_with_joint", 3, "<joint> in <worldbody>, outside a body", "put it into a <body>"},
};

const std::vector<Mistake> warnings = {
    {"attribute_misspelt", 4, "<joint> has no attribute 'dampin'", "did you mean 'damping'"},
    {"friction_of_two_kinds", 5, "a second <geom> of its body has another friction, 0.5; the first counts, 1", ""},
};

const std::filesystem::path folder = FIXTURES_DIR "/broken";

std::string path_of(const Mistake& mistake) {
  return (folder / ("mjcf_" + std::string(mistake.name) + ".xml")).string();
}

void expect_only(const Diagnostics& found, const Mistake& mistake) {
  ASSERT_EQ(found.size(), 1u) << path_of(mistake) << "\n" << to_string(found);
  EXPECT_EQ(found[0].file, path_of(mistake));
  EXPECT_EQ(found[0].line, mistake.line) << to_string(found);
  EXPECT_THAT(found[0].message, testing::HasSubstr(mistake.message)) << path_of(mistake);
  EXPECT_THAT(found[0].hint, testing::HasSubstr(mistake.hint)) << path_of(mistake);
}

TEST(BrokenMjcf, IsRefusedWithTheLineAndTheRemedy) {
  for (const Mistake& mistake : errors) {
    const Result<Model> result = load_model(path_of(mistake));
    EXPECT_FALSE(result) << path_of(mistake);
    if (!result) expect_only(result.errors(), mistake);
  }
}

TEST(BrokenMjcf, IsWarnedOfWhereItCanBeMeant) {
  for (const Mistake& mistake : warnings) {
    const Result<Model> result = load_model(path_of(mistake));
    ASSERT_TRUE(result) << to_string(result.errors());
    Diagnostics found;
    for (const Diagnostic& each : result->report)
      if (each.severity == Severity::warning) found.push_back(each);
    expect_only(found, mistake);
  }
}

TEST(BrokenMjcf, UnsupportedPartsAreLeftOutWithANoteIfThatIsAllowed) {
  for (const char* name : {"actuator_of_a_tendon", "composite", "equality_weld", "tendon", "ball_joint"}) {
    const Result<Model> result = load_model(path_of({name, 0, "", ""}), {.allow_unsupported = true});
    ASSERT_TRUE(result) << to_string(result.errors());
    EXPECT_THAT(to_string(result->report), testing::HasSubstr("note: ")) << name;
    EXPECT_THAT(to_string(result->report), testing::HasSubstr(" is left out")) << name;
  }
}

TEST(BrokenMjcf, EveryFileIsInATable) {
  std::set<std::string> known;
  for (const auto* table : {&errors, &warnings})
    for (const Mistake& mistake : *table) known.insert(path_of(mistake));
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().filename().string().starts_with("mjcf_")) {
      EXPECT_EQ(known.count(entry.path().string()), 1u) << entry.path();
    }
}

}  // namespace
}  // namespace rehearse
