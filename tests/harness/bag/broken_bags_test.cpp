// fixtures/broken/bag_*: one file or folder per kind of unusable bag, and the message about it.
#include <rehearse/mcap.h>

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "support/printed_by_name.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path broken = fs::path(FIXTURES_DIR) / "broken";

struct BrokenBag {
  std::string file;
  std::string message;  // after the name of the folder of broken files
};
const std::vector<BrokenBag>& broken_bags() {
  static const std::vector<BrokenBag> table{
      {"bag_no_database.db3", "bag_no_database.db3: error: it can't be read: SQLite reports: "},
      {"bag_without_tables.db3",
       "bag_without_tables.db3: error: the database has no table 'topics' (expected a .db3 file of rosbag2)"},
      {"bag_without_data.db3", "bag_without_data.db3: error: the table 'messages' has no column 'data'"},
      {"bag_of_ros1.bag",
       "bag_of_ros1.bag: error: a bag of ROS 1 of another version than 2.0: it begins with \"#ROSBAG V1.2\""},
      {"bag_of_text.zst",
       "bag_of_text.zst: error: the content decompressed by zstd is neither MCAP nor a database of rosbag2"},
      {"bag_missing_file",
       "bag_missing_file/metadata.yaml:17:7: error: it names the file 'bag_missing_file_0.mcap', which isn't in the "
       "folder"},
      {"bag_no_files", "bag_no_files/metadata.yaml:16:24: error: it names no file in 'relative_file_paths'"},
      {"bag_unknown_storage",
       "bag_unknown_storage/metadata.yaml:3:23: error: the storage 'my_plugin' can't be read (expected mcap or "
       "sqlite3; ros2 bag convert writes one of these)"},
      {"bag_unknown_compression",
       "bag_unknown_compression/metadata.yaml:16:23: error: the compression_format 'bz2' is unknown (expected zstd)"},
      {"bag_negative_count", "bag_negative_count/metadata.yaml:15:22: error: the message_count of a topic is '-2'"},
      {"bag_of_a_scenario", "bag_of_a_scenario/metadata.yaml:1:1: error: it has no map 'rosbag2_bagfile_information'"},
      {"bag_not_yaml", "bag_not_yaml/metadata.yaml:1:30: error: it can't be read as YAML: this '['"},
      {"bag_without_metadata",
       "bag_without_metadata: error: can't read the trace: it is a directory without metadata.yaml, and with no logs "
       "of "
       "rosbag2 (name a file in it"},
  };
  return table;
}

class BrokenBags : public testing::TestWithParam<BrokenBag> {};

TEST_P(BrokenBags, AreRefusedWithTheirFileAndTheReason) {
  const auto log = mcap::Reader::open(broken / GetParam().file);
  ASSERT_FALSE(log.ok());
  EXPECT_THAT(to_string(log.errors()), HasSubstr((broken / GetParam().message).string()));
}

INSTANTIATE_TEST_SUITE_P(Files, BrokenBags, testing::ValuesIn(broken_bags()),
                         [](const auto& entry) { return fs::path(entry.param.file).stem().string(); });

TEST(BrokenBagFiles, EachStandsInTheTable) {
  const auto opens = [](const std::string& name) {  // the doctor reports these
    return name == "bag_unknown_serialization.db3" || name == "bag_wrong_counts";
  };
  for (const auto& entry : fs::directory_iterator(broken)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("bag_") || opens(name)) continue;
    EXPECT_TRUE(std::ranges::any_of(broken_bags(), [&](const BrokenBag& bag) { return bag.file == name; })) << name;
  }
}

}  // namespace
}  // namespace rehearse
