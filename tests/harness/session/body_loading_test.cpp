// Models that controllers load, and what their bodies have of a model file.
#include <rehearse/body.h>
#include <cnoid/BodyLoader>
#include <cnoid/LeggedBodyHelper>

#include <cmath>
#include <regex>
#include <sstream>

#include "core/host/body_loading.h"
#include "core/host/cnoid_body.h"
#include "runs.h"
#include "support/files.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;

class BodyLoading : public RunTest {
 protected:
  static std::string arm() { return std::string(FIXTURES_DIR) + "/models/six_joint_arm.urdf"; }
  static std::string run_of_the_arm(const std::string& file) {
    return "rehearse: 1\nduration: 0.5\nsolver: {method: direct}\nbodies:\n  - {name: Arm, model: " + arm() +
           ", joints: {J2: 0.4, J3: 0.6}, controllers: [" + behaviour("C", "computed_torque " + file) + "]}\n";
  }
};

/// The model that a controller loads, and inverse dynamics, agree with the simulated robot.
TEST_F(BodyLoading, GivesAControllerTheEffortsOfAMotion) {
  const Trace trace = record_run(run_of_the_arm(arm()));
  ASSERT_FALSE(summary_.failure) << summary_.failure->message;
  for (const char* joint : {"J1", "J2", "J3", "J4", "J5", "J6"}) {
    const std::string speed = "Arm/" + std::string(joint) + "/dq";
    EXPECT_NEAR(trace.at(speed, 0.3), 0.5 * std::sin(4.0 * 0.3), 0.005) << joint;
    EXPECT_NEAR(trace.at(speed, 0.4), 0.5 * std::sin(4.0 * 0.4), 0.005) << joint;
  }
}

TEST_F(BodyLoading, PutsTheFileIntoTheRecording) {
  const Trace trace = record_run(run_of_the_arm(arm()));
  const mcap::StringMap* files = trace.find_metadata("rehearse.files");
  ASSERT_NE(files, nullptr);
  EXPECT_EQ(files->begin()->first, "Arm/C: six_joint_arm.urdf");
}

TEST_F(BodyLoading, ReportsAFileThatCantBeLoaded) {
  record_run(run_of_the_arm("nowhere.urdf"));
  ASSERT_TRUE(summary_.failure);
  EXPECT_THAT(summary_.failure->message, HasSubstr("it wrote: nowhere.urdf: error: "));
}

TEST_F(BodyLoading, OfABodyFileHasItsInformationMaterialsAndLoops) {
  write("walker.body",
        "format: ChoreonoidBody\nformat_version: 2.0\nname: Walker\nlinks:\n"
        "  - {name: BASE, joint_type: free, material: Sole, elements: [&box {type: RigidBody, mass: 1, inertia: [1, 0, "
        "0, "
        "0, 1, 0, 0, 0, 1]}]}\n"
        "  - {name: LEG, parent: BASE, joint_type: revolute, joint_id: 0, joint_axis: Y, translation: [0, 0, 1], "
        "elements: [*box]}\n"
        "foot_links:\n  - {link: LEG, sole_center: [0.1, 0, -0.2]}\n"
        "extra_joints:\n  - {link1_name: BASE, link2_name: LEG, joint_type: ball, translation_in_link1: [0, 0, 1.5]}\n"
        "team: blue\n");
  register_body_loader();
  std::ostringstream os;
  cnoid::BodyLoader loader;
  loader.setMessageSink(os);
  const cnoid::BodyPtr body = loader.load(path("walker.body").string());
  ASSERT_TRUE(body) << os.str();
  EXPECT_EQ(body->modelName(), "Walker");
  EXPECT_EQ(body->info<std::string>("team"), "blue");
  EXPECT_FALSE(body->info()->contains("links"));
  EXPECT_EQ(body->rootLink()->materialName(), "Sole");
  EXPECT_EQ(body->link("LEG")->materialName(), "Default");
  const cnoid::LeggedBodyHelper legged(body);
  ASSERT_EQ(legged.numFeet(), 1);
  EXPECT_EQ(legged.centerOfSoleLocal(0), cnoid::Vector3(0.1, 0, -0.2));
  ASSERT_EQ(body->numExtraJoints(), 1);
  EXPECT_EQ(body->extraJoint(0)->type(), cnoid::ExtraJoint::Ball);
  EXPECT_EQ(body->extraJoint(0)->linkName(1), "LEG");
  EXPECT_TRUE(body->extraJoint(0)->point(0).isApprox(cnoid::Vector3(0, 0, 1.5)));
  EXPECT_TRUE(body->extraJoint(0)->point(1).isApprox(cnoid::Vector3(0, 0, 0.5)));
}

/// A .yaml file around a body in VRML has the keys that VRML has no words for.
TEST_F(BodyLoading, OfAYamlFileHasItsInformation) {
  for (const char* name : {"hopper.yaml", "hopper.yml"}) {
    const std::string text = test::read_file(std::string(FIXTURES_DIR) + "/models/hopper.yaml");
    write(name, std::regex_replace(text, std::regex("hopper.wrl"), FIXTURES_DIR "/models/hopper.wrl"));
    const Result<Model> model = load_model(path(name));
    ASSERT_TRUE(model.ok()) << to_string(model.errors());
    const cnoid::BodyPtr body = make_cnoid_body(*model, "Hopper", false);
    ASSERT_TRUE(body->info()->findListing("footLinks")->isValid()) << name;
    EXPECT_EQ(body->info()->findListing("footLinks")->at(0)->toString(), "FOOT");
    EXPECT_EQ(body->info()->findListing("standardPose")->at(0)->toDouble(), -20.0);
  }
}

/// Anchors of the links may be used outside them.
TEST_F(BodyLoading, ReadsInformationThatRefersToTheLinks) {
  write("a.body",
        "format: ChoreonoidBody\nformatVersion: 1.0\nname: A\nlinks:\n-\n  name: &root BASE\n  jointType: free\n"
        "  mass: 1\n  inertia: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nlinkGroup:\n  - *root\n");
  const Result<Model> model = load_body(path("a.body"));
  ASSERT_TRUE(model.ok()) << to_string(model.errors());
  const cnoid::BodyPtr body = make_cnoid_body(*model, "A", false);
  ASSERT_TRUE(body->info()->findListing("linkGroup")->isValid());
  EXPECT_EQ(body->info()->findListing("linkGroup")->at(0)->toString(), "BASE");
  EXPECT_FALSE(body->info()->contains("links"));
}

}  // namespace
}  // namespace rehearse
