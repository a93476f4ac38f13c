// Bodies whose links touch each other, in a run.

#include "runs.h"

namespace rehearse {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Three boxes on hinges in a row; the first and the last overlap if they are `length` long.
std::string row_urdf(double length) {
  std::string urdf = "<?xml version=\"1.0\"?>\n<robot name=\"Row\">\n";
  const std::string shape =
      "<collision><geometry><box size=\"" + std::to_string(length) + " 0.1 0.1\"/></geometry></collision>";
  for (const std::string name : {"A", "B", "C"})
    urdf += "<link name=\"" + name +
            "\"><inertial><mass value=\"1\"/><inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" "
            "izz=\"0.1\"/></inertial>" +
            shape + "</link>\n";
  for (const std::string pair : {"AB", "BC"})
    urdf += "<joint name=\"" + pair + "\" type=\"continuous\"><parent link=\"" + pair[0] + "\"/><child link=\"" +
            pair[1] + "\"/><origin xyz=\"0.2 0 0\"/><axis xyz=\"0 1 0\"/></joint>\n";
  return urdf + "</robot>\n";
}

class SelfCollision : public RunTest {
 protected:
  std::vector<std::string> remarks(double length) {
    write("row.urdf", row_urdf(length));
    const Trace trace = record_run(
        "rehearse: 1\nduration: 0.02\nbodies:\n  - {name: Row, model: row.urdf, fixed: true, self_collision: true}\n");
    said_ = said(trace);
    std::vector<std::string> lines;
    for (const Diagnostic& remark : summary_.remarks) lines.push_back(to_string(remark));
    return lines;
  }

  std::vector<std::string> said_;
};

TEST_F(SelfCollision, TellsWhichLinksAreLeftOut) {
  const std::string text =
      "world: body 'Row': these links overlap when all joints are at zero, so they don't touch each other: 'A' and 'C'";
  EXPECT_THAT(remarks(0.5), ElementsAre("warning: " + text));
  EXPECT_THAT(said_, Contains(text));  // in the recording
}

TEST_F(SelfCollision, TellsNothingWhereNothingOverlaps) { EXPECT_THAT(remarks(0.3), IsEmpty()); }

}  // namespace
}  // namespace rehearse
