// glTF meshes with z up, against their standard: the option that doesn't turn them, and the warning that names it.
#include "mesh_files.h"
#include "urdf_texts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rehearse {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A link with the bracket as its visual shape, and a collision shape.
std::string bracket_on_link(const std::string& file, const std::string& collision) {
  return robot(link("arm",
                    "<inertial><mass value='1'/><inertia ixx='0.5' iyy='0.5' izz='0.5' ixy='0' ixz='0' iyz='0'/></inertial>"
                    "<visual><geometry><mesh filename='" +
                        (arm_meshes / file).string() + "'/></geometry></visual><collision>" + collision +
                        "</collision>"));
}

std::string box_collision(const std::string& center, const std::string& size) {
  return "<origin xyz='" + center + "'/><geometry><box size='" + size + "'/></geometry>";
}

// The bracket's box is 0.096 x 0.04 x 0.096 [m], from (-0.006, -0.02, 0); in its glTF file y is up.
const std::string as_turned = box_collision("0.042 0 0.048", "0.096 0.04 0.096");
const std::string as_in_the_file = box_collision("0.042 0.048 0", "0.096 0.096 0.04");

std::string report_of(const std::string& text, const UrdfOptions& options = {}) {
  return to_string(load(text, options).report);
}

TEST(MeshUp, OfZLeavesTheFilesAxes) {
  const Model model = load(bracket_on_link("bracket.glb", as_in_the_file), {.mesh_z_up = true});
  const auto& mesh = std::get<Mesh>(model.links[0].visuals[0].geometry);
  EXPECT_LT((mesh.data->lower - Eigen::Vector3d(-0.006, 0, -0.02)).norm(), 1e-7);
  EXPECT_LT((mesh.data->upper - Eigen::Vector3d(0.09, 0.096, 0.02)).norm(), 1e-7);
}

TEST(MeshUp, OfZChangesNoOtherFormat) {
  const Model model = load(bracket_on_link("bracket.stl", as_turned), {.mesh_z_up = true});
  const auto& mesh = std::get<Mesh>(model.links[0].visuals[0].geometry);
  EXPECT_LT((mesh.data->lower - Eigen::Vector3d(-0.006, -0.02, 0)).norm(), 1e-7);
}

TEST(MeshUp, IsProposedWhereTheBoxesAgreeOnlyWithoutTheTurn) {
  EXPECT_THAT(
      report_of(bracket_on_link("bracket.glb", as_in_the_file)),
      HasSubstr("the glTF meshes of link 'arm' fit the collision shapes only if z is up in their files (mesh_up: "
                "z of the body in a scenario, or --mesh-up z"));
}

TEST(MeshUp, IsNotProposedWhereTheyAgreeWithItOrNever) {
  EXPECT_THAT(report_of(bracket_on_link("bracket.glb", as_turned)), Not(HasSubstr("glTF")));
  EXPECT_THAT(report_of(bracket_on_link("bracket.glb", box_collision("0 0 0", "0.3 0.3 0.3"))), Not(HasSubstr("glTF")));
  EXPECT_THAT(report_of(bracket_on_link("bracket.stl", as_in_the_file)), Not(HasSubstr("glTF")));
  EXPECT_THAT(report_of(bracket_on_link("bracket.glb", as_in_the_file), {.mesh_z_up = true}), Not(HasSubstr("glTF")));
  const std::string same_file = "<geometry><mesh filename='" + (arm_meshes / "bracket.glb").string() + "'/></geometry>";
  EXPECT_THAT(report_of(bracket_on_link("bracket.glb", same_file)), Not(HasSubstr("glTF")));
}

}  // namespace
}  // namespace rehearse
