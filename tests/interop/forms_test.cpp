// Files that @mcap/core writes, in each of its forms: Rehearse reads the same values as @mcap/core.
#include <rehearse/mcap.h>
#include <rehearse/trace.h>

#include <gmock/gmock.h>

#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>

#include "node.h"

namespace rehearse::test {
namespace {

class InteropForms : public NodeTest, public testing::WithParamInterface<const char*> {
 protected:
  void write() {
    const Output output = node("write_forms.mjs", GetParam());
    ASSERT_EQ(output.status, 0) << output.text;
  }
  static mcap::Statistics of_108_messages() {
    mcap::Statistics statistics;
    statistics.message_count = 108;
    return statistics;
  }
  static bool lacks(const char* feature) { return std::strstr(GetParam(), feature) != nullptr; }
};

TEST_P(InteropForms, OurCatPrintsWhatTheyFind) {
  write();
  const Output compared = compare_with_cat();
  EXPECT_EQ(compared.status, 0) << compared.text;
  EXPECT_EQ(compared.text, "108 messages, 2 channels decoded\n");
}

TEST_P(InteropForms, OurTraceHasTheirValues) {
  write();
  const auto trace = Trace::load(file_);
  ASSERT_TRUE(trace) << to_string(trace.errors());
  const auto knee = trace->values("robot/KNEE/q");
  ASSERT_EQ(knee.size(), 50u);
  for (std::size_t i = 0; i < knee.size(); ++i) EXPECT_EQ(knee[i], 0.1 * static_cast<double>(2 * i));
  EXPECT_EQ(std::bit_cast<std::uint64_t>(trace->last("other/ANKLE/q")), 0x8000000000000000u);
  EXPECT_EQ(trace->last("robot/KNEE/u"), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(trace->last("robot/ANKLE/u")));
  EXPECT_FALSE(trace->find_series("robot/KNEE/dq"));
}

TEST_P(InteropForms, WeFindEverythingElse) {
  write();
  const auto opened = mcap::Reader::open(file_);
  ASSERT_TRUE(opened) << to_string(opened.errors());
  const mcap::Reader& reader = **opened;
  EXPECT_TRUE(reader.damage().empty()) << to_string(reader.damage());
  EXPECT_EQ(reader.library(), "interop");
  EXPECT_EQ(reader.schemas().size(), 1u);
  ASSERT_EQ(reader.channels().size(), 4u);
  for (const auto& [id, channel] : reader.channels())
    EXPECT_EQ(channel.metadata, (mcap::StringMap{{"note", channel.topic}}));
  EXPECT_EQ(reader.statistics().has_value(), !lacks("useStatistics"));
  EXPECT_EQ(reader.statistics().value_or(of_108_messages()).message_count, 108u);
  ASSERT_EQ(reader.attachments().size(), 1u);
  EXPECT_EQ(reader.attachments()[0].log_time, 5u);
  EXPECT_EQ(reader.attachments()[0].media_type, "text/plain");
  EXPECT_EQ(reader.attachments()[0].data.size(), 5u);
  ASSERT_EQ(reader.metadata().size(), 1u);
  EXPECT_EQ(reader.metadata()[0].values, (mcap::StringMap{{"key", "value"}}));
}

constexpr const char* forms[] = {
    "none",
    "lz4",
    "zstd",
    "unchunked",  //
    "zstd --no-useStatistics",
    "zstd --no-useSummaryOffsets",
    "lz4 --no-repeatSchemas",
    "zstd --no-repeatChannels",
    "none --no-useAttachmentIndex",
    "zstd --no-useMetadataIndex",
    "zstd --no-useMessageIndex",
    "lz4 --no-useChunkIndex",
    "zstd --no-useStatistics --no-useSummaryOffsets --no-repeatSchemas --no-repeatChannels --no-useAttachmentIndex "
    "--no-useMetadataIndex --no-useMessageIndex --no-useChunkIndex",
    "unchunked --no-useStatistics --no-useSummaryOffsets --no-repeatSchemas --no-repeatChannels "
    "--no-useAttachmentIndex "
    "--no-useMetadataIndex"};

std::string name_of(const testing::TestParamInfo<const char*>& form) {
  std::string name;
  for (const char* c = form.param; *c != '\0'; ++c)
    if (std::isalnum(static_cast<unsigned char>(*c))) name += *c;
  return name;
}

INSTANTIATE_TEST_SUITE_P(Forms, InteropForms, testing::ValuesIn(forms), name_of);

}  // namespace
}  // namespace rehearse::test
