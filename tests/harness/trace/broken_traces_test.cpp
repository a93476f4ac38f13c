// fixtures/broken/trace_*: one small file per kind of unusable trace, and the message about it.
#include <rehearse/trace.h>

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

struct BrokenTrace {
  std::string file;
  std::string message;
};
const std::vector<BrokenTrace>& broken_traces() {
  static const std::vector<BrokenTrace> table{
      {"trace_empty.mcap", "error: not an MCAP file: it is empty"},
      {"trace_of_text.mcap", "error: not an MCAP file: it doesn't begin with the magic bytes"},
      {"trace_git_lfs_pointer.mcap",
       "error: it is a git-lfs pointer, not the recording that it stands for (run: git lfs pull)"},
      {"trace_truncated.mcap", "error: truncated at byte 2500"},
      {"trace_flipped_bit.mcap", "error: damaged: the chunk at byte 5087 can't be decompressed"},
      {"trace_wrong_chunk_crc.mcap", "error: damaged: the CRC of the chunk at byte 63 doesn't match"},
      {"trace_chunk_of_a_terabyte.mcap",
       "error: damaged: the chunk at byte 63 states 1099511627776 bytes decompressed"},
      {"trace_bomb.mcap", "error: damaged: the chunk at byte 63 can't be decompressed"},
      {"trace_length_of_a_terabyte.mcap", "error: damaged at byte 95: no record that fits into the file begins there"},
      {"trace_undefined_channel.mcap", "error: damaged: a message at byte 32 is of channel 7, which isn't defined"},
      {"trace_redefined_channel.mcap", "error: damaged: channel 1 is defined a second time at byte 95, differently"},
      {"trace_redefined_schema.mcap", "error: damaged: schema 1 is defined a second time at byte 76, differently"},
      {"trace_two_footers.mcap", "error: damaged at byte 137: the file doesn't end with its magic bytes there"},
      {"trace_footer_points_nowhere.mcap",
       "error: damaged: the Footer at byte 108 states a summary at byte 1099511627776, but it begins at byte 0"},
  };
  return table;
}

class BrokenTraces : public testing::TestWithParam<BrokenTrace> {};

TEST_P(BrokenTraces, AreRefusedWithTheirFileAndTheReason) {
  const fs::path file = fs::path(FIXTURES_DIR) / "broken" / GetParam().file;
  const Result<Trace> trace = Trace::load(file);
  ASSERT_FALSE(trace.ok());
  EXPECT_THAT(to_string(trace.errors()), HasSubstr(file.string() + ": " + GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(Files, BrokenTraces, testing::ValuesIn(broken_traces()),
                         [](const auto& entry) { return fs::path(entry.param.file).stem().string(); });

TEST(BrokenTraceFiles, EachStandsInTheTable) {
  for (const auto& entry : fs::directory_iterator(fs::path(FIXTURES_DIR) / "broken")) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("trace_")) continue;
    EXPECT_TRUE(std::ranges::any_of(broken_traces(), [&](const BrokenTrace& broken) { return broken.file == name; }))
        << name;
  }
}

}  // namespace
}  // namespace rehearse
