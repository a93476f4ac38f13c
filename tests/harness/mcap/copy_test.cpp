#include <gmock/gmock.h>

#include <algorithm>

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

namespace {

/// Numbers and pictures in many chunks, which overlap in time; a channel is added in the middle.
void write_chunks(mcap::Writer& writer, std::uint64_t begin, std::uint64_t end) {
  const auto numbers = writer.add_channel(0, "/numbers", "cdr");
  const auto pictures = writer.add_channel(0, "/pictures", "png", {}, mcap::pictures);
  for (std::uint64_t i = begin; i < end; ++i) {
    ASSERT_TRUE(writer.write(numbers, i, i, bytes_of("number " + std::to_string(i))));
    if (i % 70 == 0) {
      ASSERT_TRUE(writer.write(pictures, i, i, bytes_of("picture " + std::string(i % 90, 'p'))));
    }
  }
}

mcap::WriterOptions small_chunks() {
  mcap::WriterOptions options;
  options.chunk_size = 1000;
  options.chunk_span = 300;
  return options;
}

}  // namespace

TEST(McapCopy, ChunksAndTheMessagesAfterThemMakeTheSourceByteForByte) {
  const TempFile source, copy;
  {
    auto writer = std::move(*mcap::Writer::create(source.path(), small_chunks()));
    write_chunks(*writer, 0, 2000);
    ASSERT_TRUE(writer->close());
  }
  const auto reader = std::move(*mcap::Reader::open(source.path()));
  ASSERT_TRUE(reader->can_copy_chunks());
  const auto& chunks = reader->chunks();
  ASSERT_GT(chunks.size(), 20u);
  // in the middle a chunk of pictures is open
  const std::size_t copied = chunks.size() / 2;
  const std::uint64_t end = chunks[copied - 1].end_time + 1;
  auto writer = std::move(*mcap::Writer::create(copy.path(), small_chunks()));
  for (const auto& [id, channel] : reader->channels())
    ASSERT_EQ(writer->add_channel(0, channel.topic, channel.message_encoding, {},
                                  channel.topic == "/pictures" ? mcap::pictures : mcap::numbers),
              id);
  for (std::size_t i = 0; i < copied; ++i) ASSERT_TRUE(writer->copy_chunk(*reader->stored_chunk(chunks[i])));
  mcap::OrderedMessages rest(*reader);
  while (const mcap::Message* message = rest.next()) {
    const bool is_copied = std::any_of(chunks.begin(), chunks.begin() + static_cast<std::ptrdiff_t>(copied),
                                       [&](const auto& chunk) { return chunk.offset == message->location.record; });
    if (is_copied) continue;
    ASSERT_TRUE(writer->write(message->channel->id, message->log_time, message->publish_time, message->data));
  }
  ASSERT_TRUE(writer->close());
  EXPECT_GT(reader->statistics()->message_end_time, end);
  EXPECT_TRUE(source.read() == copy.read());
}

TEST(McapCopy, ChunksOfADamagedFileAreNotCopied) {
  const TempFile source;
  {
    auto writer = std::move(*mcap::Writer::create(source.path(), small_chunks()));
    write_chunks(*writer, 0, 300);
    ASSERT_TRUE(writer->close());
  }
  const Buffer whole = source.read();
  std::vector<mcap::Chunk> chunks;
  {
    const auto reader = std::move(*mcap::Reader::open(source.path()));
    ASSERT_TRUE(reader->can_copy_chunks());
    chunks = reader->chunks();
    const auto stored = reader->stored_chunk(chunks.front());
    ASSERT_TRUE(stored);
    const auto by_summary = std::move(*mcap::Reader::open(source.path(), {.opening = mcap::Opening::by_summary}));
    EXPECT_TRUE(by_summary->stored_chunk(by_summary->chunks().front()).has_value());
    const mcap::Bytes bytes = stored->bytes;
    for (std::size_t size = 0; size < bytes.size(); ++size) {  // a record that is cut is no record
      const auto cut = mcap::StoredChunk::parse(bytes.first(size));
      EXPECT_TRUE(!cut || cut->bytes.size() < bytes.size()) << size;
    }
    EXPECT_FALSE(mcap::StoredChunk::parse(bytes, bytes.size() + 1));
  }
  Buffer changed = whole;
  changed[chunks.front().offset + 60] ^= std::byte{1};
  source.write(changed);
  EXPECT_FALSE((*mcap::Reader::open(source.path()))->can_copy_chunks()) << "the CRC of the data section differs";
  source.write(mcap::Bytes(whole).first(whole.size() - 30));
  EXPECT_FALSE((*mcap::Reader::open(source.path()))->can_copy_chunks()) << "the summary is cut";
}
