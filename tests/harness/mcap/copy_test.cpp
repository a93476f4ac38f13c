#include <gmock/gmock.h>

#include "core/mcap/copy.h"
#include "mcap_files.h"

using namespace rehearse;
using namespace rehearse::test;
using mcap::copy_with_metadata;
using testing::ElementsAre;
using testing::HasSubstr;

namespace {

std::vector<std::string> metadata_of(const TempFile& file) {
  std::vector<std::string> names;
  const auto reader = mcap::Reader::open(file.path());
  EXPECT_TRUE(reader && (*reader)->damage().empty());
  for (const mcap::Metadata& metadata : (*reader)->metadata()) {
    std::string text = metadata.name;
    for (const auto& [key, value] : metadata.values) text += " " + key + "=" + value;
    names.push_back(text);
  }
  return names;
}

/// Two messages, metadata before and after them.
void write_source(const TempFile& file) {
  auto writer = std::move(*mcap::Writer::create(file.path()));
  ASSERT_TRUE(writer->add_metadata("before", {{"a", "1"}}));
  const auto channel = writer->add_channel(0, "/a", "text");
  for (std::uint64_t i = 0; i < 2; ++i) ASSERT_TRUE(writer->write(channel, i, i, bytes_of("message")));
  ASSERT_TRUE(writer->add_metadata("after", {}));
  ASSERT_TRUE(writer->close());
}

}  // namespace

TEST(McapCopy, AddsRecordsThatTheReaderFindsAndKeepsTheRest) {
  const TempFile source, copy;
  write_source(source);
  ASSERT_TRUE(copy_with_metadata(source.path(), copy.path(), "note.", {{"note.1", {{"b", "2"}}}, {"note.2", {}}}));
  EXPECT_THAT(metadata_of(copy), ElementsAre("before a=1", "after", "note.1 b=2", "note.2"));
  const auto reader = std::move(*mcap::Reader::open(copy.path()));
  EXPECT_EQ(reader->statistics()->metadata_count, 4u);
  int messages = 0;
  EXPECT_TRUE(reader->for_each_message([&](const mcap::Message& message) {
    EXPECT_EQ(text_of(message.data), "message");
    return ++messages > 0;
  }));
  EXPECT_EQ(messages, 2);
}

TEST(McapCopy, WithoutAnythingToAddIsTheSourceByteForByte) {
  const TempFile source, copy;
  write_source(source);
  ASSERT_TRUE(copy_with_metadata(source.path(), copy.path(), "note.", {}));
  EXPECT_EQ(source.read(), copy.read());
}

TEST(McapCopy, PutsRecordsInThePlaceOfThoseThatEndTheSource) {
  const TempFile source, first, second, directly;
  write_source(source);
  ASSERT_TRUE(copy_with_metadata(source.path(), first.path(), "note.", {{"note.1", {}}, {"note.2", {}}}));
  ASSERT_TRUE(copy_with_metadata(first.path(), second.path(), "note.", {{"note.3", {{"c", "3"}}}}));
  EXPECT_THAT(metadata_of(second), ElementsAre("before a=1", "after", "note.3 c=3"));
  ASSERT_TRUE(copy_with_metadata(source.path(), directly.path(), "note.", {{"note.3", {{"c", "3"}}}}));
  EXPECT_EQ(second.read(), directly.read());
}

TEST(McapCopy, KeepsRecordsOfThatNameThatStandBeforeOthers) {
  const TempFile source, copy;
  write_source(source);
  ASSERT_TRUE(copy_with_metadata(source.path(), copy.path(), "before", {}));
  EXPECT_THAT(metadata_of(copy), ElementsAre("before a=1", "after"));
}

TEST(McapCopy, EveryFlippedBitOfACopyIsFound) {
  const TempFile source, copy, flipped;
  write_source(source);
  ASSERT_TRUE(copy_with_metadata(source.path(), copy.path(), "", {{"note", {{"b", "2"}}}}));
  const Buffer bytes = copy.read();
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    Buffer damaged = bytes;
    damaged[i] ^= std::byte{1};
    flipped.write(damaged);
    const auto reader = mcap::Reader::open(flipped.path());
    EXPECT_FALSE(reader && (*reader)->for_each_message([](const mcap::Message&) { return true; })) << "byte " << i;
  }
}

TEST(McapCopy, OfADamagedFileIsRefused) {
  const TempFile source, copy;
  write_source(source);
  Buffer bytes = source.read();
  const auto refusal = [&](const Buffer& content) {
    source.write(content);
    const auto copied = copy_with_metadata(source.path(), copy.path(), "", {});
    EXPECT_FALSE(copied);
    return copied ? "" : to_string(copied.errors());
  };
  EXPECT_THAT(refusal({bytes.begin(), bytes.end() - 30}), HasSubstr("truncated"));
  bytes[bytes.size() / 3] ^= std::byte{1};
  EXPECT_THAT(refusal(bytes), HasSubstr("CRC"));
  EXPECT_FALSE(std::filesystem::exists(copy.path()));
}
