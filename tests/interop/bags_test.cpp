// Parts of ROS 2 bags against libraries that we did not write.
#include <gmock/gmock.h>

#include "node.h"

namespace rehearse::test {
namespace {

using testing::HasSubstr;

class InteropBags : public NodeTest {
 protected:
  /// A folder for this test, with two MCAP files by @mcap/core and their metadata.yaml.
  fs::path split_bag() {
    const fs::path folder = file_.string() + ".bag";
    fs::remove_all(folder);
    fs::create_directories(folder);
    for (const char* form : {"zstd", "lz4"}) {
      EXPECT_EQ(node("write_forms.mjs", form).status, 0);
      fs::rename(file_, folder / (std::string(form) + ".mcap"));
    }
    EXPECT_EQ(run("printf 'rosbag2_bagfile_information:\\n  version: 5\\n  storage_identifier: mcap\\n  "
                  "relative_file_paths:\\n    - zstd.mcap\\n    - lz4.mcap\\n' > " +
                  quoted(folder / "metadata.yaml"))
                  .status,
              0);
    return folder;
  }
};

TEST_F(InteropBags, StandardTypesAreThoseOfHumble) {
  const Output output = run("node " + quoted(fs::path(INTEROP_DIR) / "check_standard_types.mjs") + " " +
                            quoted(fs::path(SOURCE_DIR) / "harness/src/logs/bag/standard_types.cpp"));
  EXPECT_EQ(output.status, 0) << output.text;
  EXPECT_EQ(output.text,
            "125 types; not in the package: control_msgs/DynamicJointState control_msgs/InterfaceValue "
            "control_msgs/JointControllerState control_msgs/JointJog\n");
}

TEST_F(InteropBags, AFolderOfTheirFilesBecomesAFileThatTheyRead) {
  const fs::path folder = split_bag();
  const Output filtered = run(quoted(REHEARSE_COMMAND) + " filter " + quoted(folder) + " -o " + quoted(file_));
  ASSERT_EQ(filtered.status, 0) << filtered.text;
  const Output compared = compare_with_cat();
  EXPECT_EQ(compared.status, 0) << compared.text;
  EXPECT_EQ(compared.text, "216 messages, 2 channels decoded\n");
  fs::remove_all(folder);
}

TEST_F(InteropBags, EveryFrameOfAViewersFileIsConnectedWithTheWorld) {
  const fs::path run_file = file_.string() + ".run.mcap";
  const Output recorded =
      run(quoted(REHEARSE_COMMAND) + " record " + quoted(fs::path(FIXTURES_DIR) / "scenarios/room.yaml") +
          " --duration 0.3 -o " + quoted(run_file));
  ASSERT_EQ(recorded.status, 0) << recorded.text;
  const Output exported = run(quoted(REHEARSE_COMMAND) + " export " + quoted(run_file) + " --viewer " + quoted(file_));
  ASSERT_EQ(exported.status, 0) << exported.text;
  const Output frames = node("check_frames.mjs");
  EXPECT_EQ(frames.status, 0) << frames.text;
  EXPECT_THAT(frames.text, HasSubstr("Scout/Depth"));
  EXPECT_THAT(frames.text, HasSubstr("0 unconnected\n"));
  fs::remove(run_file);
}

}  // namespace
}  // namespace rehearse::test
