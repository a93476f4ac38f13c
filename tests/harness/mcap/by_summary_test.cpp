// Opening a file by the summary at its end.
#include "file_forms.h"
#include "mcap_files.h"

#include <gmock/gmock.h>

#include <cstring>

using namespace rehearse;
using namespace rehearse::test;
using testing::HasSubstr;

namespace {

constexpr mcap::ReaderOptions by_summary{.opening = mcap::Opening::by_summary};

/// Two channels, some chunks, an attachment, metadata.
Buffer file_with(const FileForm& form = {}) {
  mcap::WriterOptions options;
  options.chunk_size = 200;
  const Buffer whole = written(options, [](mcap::Writer& writer) {
    const auto schema = writer.add_schema("test/msg/Text", "ros2msg", "string text\n");
    const auto numbers = writer.add_channel(schema, "/numbers", "cdr");
    const auto pictures = writer.add_channel(0, "/pictures", "png", {}, mcap::pictures);
    EXPECT_TRUE(writer.add_attachment("scenario.yaml", "application/yaml", bytes_of("rehearse: 1\n")));
    for (std::uint64_t i = 0; i < 30; ++i)
      EXPECT_TRUE(writer.write(i % 7 == 0 ? pictures : numbers, i, i, bytes_of("number " + std::to_string(i))));
    EXPECT_TRUE(writer.add_metadata("provenance", {{"seed", "0"}}));
  });
  return in_form(whole, form);
}

/// All information about a file that is available without a pass.
void expect_the_same_is_known(const mcap::Reader& a, const mcap::Reader& b) {
  const auto chunk = [](const mcap::Chunk& c) {
    return std::tuple(c.offset, c.start_time, c.end_time, c.compression, c.stored_size, c.size);
  };
  EXPECT_EQ(a.profile(), b.profile());
  EXPECT_EQ(a.library(), b.library());
  EXPECT_EQ(a.schemas(), b.schemas());
  EXPECT_EQ(a.channels(), b.channels());
  ASSERT_EQ(a.attachments().size(), b.attachments().size());
  for (std::size_t i = 0; i < a.attachments().size(); ++i) {
    EXPECT_EQ(a.attachments()[i].name, b.attachments()[i].name);
    EXPECT_EQ(text_of(a.attachments()[i].data), text_of(b.attachments()[i].data));
    EXPECT_EQ(a.attachments()[i].offset, b.attachments()[i].offset);
  }
  ASSERT_EQ(a.metadata().size(), b.metadata().size());
  for (std::size_t i = 0; i < a.metadata().size(); ++i) EXPECT_EQ(a.metadata()[i].values, b.metadata()[i].values);
  ASSERT_EQ(a.chunks().size(), b.chunks().size());
  for (std::size_t i = 0; i < a.chunks().size(); ++i) EXPECT_EQ(chunk(a.chunks()[i]), chunk(b.chunks()[i]));
  EXPECT_EQ(a.statistics().has_value(), b.statistics().has_value());
}

/// The offset of the first record of this kind.
std::size_t offset_of(const Buffer& bytes, std::uint8_t opcode) {
  std::size_t found = 0;
  for_each_record(bytes, [&](const mcap::Record& record) {
    if (record.opcode == opcode) found = record.offset;
    return found == 0;
  });
  EXPECT_NE(found, 0u);
  return found;
}

}  // namespace

TEST(McapBySummary, KnowsTheSameAsByTheWalk) {
  const Buffer bytes = file_with();
  const auto reader = std::move(*mcap::Reader::open_bytes(bytes, "a", by_summary));
  const auto walked = std::move(*mcap::Reader::open_bytes(bytes, "a"));
  EXPECT_TRUE(reader->opened_by_summary());
  EXPECT_FALSE(walked->opened_by_summary());
  EXPECT_GT(walked->chunks().size(), 3u);
  expect_the_same_is_known(*reader, *walked);
}

TEST(McapBySummary, AMessageIsFoundWithoutTheWalk) {
  const Buffer bytes = file_with();
  const auto reader = std::move(*mcap::Reader::open_bytes(bytes, "a", by_summary));
  EXPECT_TRUE(reader->message_at({reader->chunks()[0].offset, 0, true}));
  EXPECT_TRUE(reader->opened_by_summary());
}

TEST(McapBySummary, APassWalksFirst) {
  const Buffer bytes = file_with();
  const auto walked = std::move(*mcap::Reader::open_bytes(bytes, "a"));
  for (const auto pass : {rehearse::test::pass_over, pass_in_order}) {
    const auto reader = std::move(*mcap::Reader::open_bytes(bytes, "a", by_summary));
    const Pass seen = pass(*reader);
    EXPECT_TRUE(seen.end) << to_string(seen.end.errors());
    EXPECT_EQ(seen.messages, pass(*walked).messages);
    EXPECT_FALSE(reader->opened_by_summary());
    expect_the_same_is_known(*reader, *walked);
  }
}

TEST(McapBySummary, APassFindsTheDamageThatTheSummaryHides) {
  Buffer bytes = file_with();
  bytes[offset_of(bytes, 0x09) + 60] ^= std::byte{1};  // in the attachment
  const auto reader = std::move(*mcap::Reader::open_bytes(bytes, "a", by_summary));
  EXPECT_TRUE(reader->opened_by_summary());
  EXPECT_TRUE(reader->damage().empty());
  const Pass pass = pass_over(*reader);
  ASSERT_FALSE(pass.end);
  EXPECT_THAT(to_string(pass.end.errors()), HasSubstr("the CRC of the attachment"));
}

TEST(McapBySummary, WalksAFileWhoseSummaryDoesNotSayAll) {
  for (const FileForm& form :
       {FileForm{.summary = false}, FileForm{.repeated_schemas = false}, FileForm{.repeated_channels = false},
        FileForm{.statistics = false}, FileForm{.chunk_indexes = false}, FileForm{.attachment_indexes = false},
        FileForm{.metadata_indexes = false}}) {
    const Buffer bytes = file_with(form);
    const auto reader = std::move(*mcap::Reader::open_bytes(bytes, "a", by_summary));
    EXPECT_FALSE(reader->opened_by_summary());
    expect_the_same_is_known(*reader, *std::move(*mcap::Reader::open_bytes(bytes, "a")));
    EXPECT_TRUE(pass_over(*reader).end);
  }
}

TEST(McapBySummary, NeedsNeitherOffsetsNorCrcsNorMessageIndexes) {
  const Buffer bytes = file_with({.message_indexes = false, .crcs = false, .summary_offsets = false});
  EXPECT_TRUE(std::move(*mcap::Reader::open_bytes(bytes, "a", by_summary))->opened_by_summary());
}

TEST(McapBySummary, WalksAFileWhoseEndIsDamaged) {
  const Buffer whole = file_with();
  const std::size_t data_end = offset_of(whole, 0x0f);
  Buffer bytes = whole;
  for (std::size_t i = data_end; i < whole.size(); ++i) {
    bytes[i] ^= std::byte{4};
    const auto reader = std::move(*mcap::Reader::open_bytes(bytes, "a", by_summary));
    const bool stated_crc = i >= data_end + 9 && i < data_end + 13;  // only a pass can tell
    EXPECT_EQ(reader->opened_by_summary(), stated_crc) << "byte " << i - data_end << " behind DataEnd";
    EXPECT_FALSE(pass_over(*reader).end);
    bytes[i] = whole[i];
  }
}

TEST(McapBySummary, WalksAFileThatIsCut) {
  const Buffer whole = file_with();
  for (std::size_t size = 8; size < whole.size(); ++size) {
    const Buffer cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    const auto reader = std::move(*mcap::Reader::open_bytes(cut, "a", by_summary));
    EXPECT_FALSE(reader->opened_by_summary());
    EXPECT_FALSE(reader->damage().empty());
  }
}

TEST(McapBySummary, WalksAFileWhoseIndexesPointElsewhere) {
  const Buffer whole = file_with({.crcs = false});
  const auto opens_with = [&](std::uint8_t opcode, std::size_t field, std::uint64_t value) {
    Buffer bytes = whole;
    std::memcpy(&bytes[offset_of(whole, opcode) + 9 + field], &value, sizeof value);
    return std::move(*mcap::Reader::open_bytes(bytes, "a", by_summary))->opened_by_summary();
  };
  const auto place = [&](std::uint8_t opcode) { return static_cast<std::uint64_t>(offset_of(whole, opcode)); };
  EXPECT_TRUE(opens_with(0x08, 16, place(0x06)));
  for (const std::uint64_t nowhere : {std::uint64_t{0}, std::uint64_t{9}, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    EXPECT_FALSE(opens_with(0x08, 16, nowhere)) << "the chunk's offset";
    EXPECT_FALSE(opens_with(0x08, 24, nowhere)) << "its length";
    EXPECT_FALSE(opens_with(0x0a, 0, nowhere)) << "the attachment's offset";
    EXPECT_FALSE(opens_with(0x0a, 8, nowhere)) << "its length";
    EXPECT_FALSE(opens_with(0x0d, 0, nowhere)) << "the metadata's offset";
    EXPECT_FALSE(opens_with(0x0b, 0, nowhere)) << "the count of messages";
    EXPECT_FALSE(opens_with(0x02, 0, nowhere)) << "the summary's beginning";
  }
}
