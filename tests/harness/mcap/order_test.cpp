#include "mcap_files.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>
#include <map>

#include "core/mcap/codec.h"
#include "core/mcap/records.h"

using namespace rehearse;
using namespace rehearse::test;

namespace {

std::string data_in_order(mcap::Reader& reader) {
  const Pass pass = pass_in_order(reader);
  EXPECT_TRUE(pass.end) << to_string(pass.end.errors());
  std::string all;
  for (const Seen& seen : pass.messages) all += seen.data;
  return all;
}

/// A file of write_small_file(), which a test damages.
class SmallFile {
 public:
  /// Alters the picture, whose chunk isn't compressed.
  void alter_picture() {
    const mcap::Bytes picture = bytes_of("a picture");
    *std::search(bytes_.begin(), bytes_.end(), picture.begin(), picture.end()) ^= std::byte{4};
  }
  /// Alters the channel of the first message index.
  void alter_index() {
    mcap::RecordWalker walker(bytes_, mcap::magic.size());
    mcap::Record record;
    while (walker.next(record) && record.opcode != mcap::op::message_index) continue;
    bytes_[record.offset + mcap::record_head] ^= std::byte{4};
  }
  /// Makes the CRC of the data section right for the altered bytes.
  void correct_data_crc() {
    mcap::RecordWalker walker(bytes_, mcap::magic.size());
    mcap::Record record;
    while (walker.next(record) && record.opcode != mcap::op::data_end) continue;
    const std::uint32_t crc = mcap::crc32(mcap::Bytes(bytes_).first(record.offset), 0);
    std::memcpy(&bytes_[record.offset + mcap::record_head], &crc, sizeof crc);
  }
  /// Reads the numbers alone, in order: their number, and the errors.
  std::pair<int, std::string> numbers() const {
    const auto reader = std::move(*mcap::Reader::open_bytes(bytes_, "small.mcap"));
    std::vector<std::uint16_t> chosen;
    for (const auto& [id, channel] : reader->channels())
      if (channel.topic == "/numbers") chosen.push_back(id);
    int count = 0;
    const auto end = reader->for_each_message_in_order([&](const mcap::Message&) { return ++count, true; }, chosen);
    return {count, end ? "" : to_string(end.errors())};
  }

 private:
  Buffer bytes_ = small_file();
};

}  // namespace

TEST(McapOrder, OpensNoChunkWithoutMessagesOfTheChannels) {
  SmallFile file;
  file.alter_picture();
  file.correct_data_crc();
  EXPECT_EQ(file.numbers(), std::pair(4, std::string()));
}

TEST(McapOrder, NamesTheDamagedChunkOfOtherChannels) {
  SmallFile file;
  file.alter_picture();
  const auto [count, errors] = file.numbers();
  EXPECT_EQ(count, 4);
  EXPECT_THAT(errors, testing::HasSubstr("the CRC of the data section doesn't match"));
  EXPECT_THAT(errors, testing::ContainsRegex("the chunk at byte [0-9]+"));
}

TEST(McapOrder, OpensAllChunksIfTheIndexesListOtherMessagesThanTheStatistics) {
  SmallFile file;
  file.alter_index();
  file.correct_data_crc();
  EXPECT_EQ(file.numbers(), std::pair(4, std::string()));
}

TEST(McapOrder, MergesChunksThatOverlapInTime) {
  Composer file;
  file.magic().header().channel(1, "/a");
  file.chunk(1, 5, Composer().message(1, 1, "a").message(1, 3, "c").message(1, 5, "e"));
  file.chunk(2, 6, Composer().message(1, 2, "b").message(1, 4, "d").message(1, 6, "f"));
  EXPECT_EQ(data_in_order(*open_composed(file.end())), "abcdef");
}

TEST(McapOrder, SortsWithinAChunk) {
  Composer file;
  file.magic().header().channel(1, "/a");
  file.chunk(1, 3, Composer().message(1, 3, "c").message(1, 1, "a").message(1, 2, "b")).end();
  EXPECT_EQ(data_in_order(*open_composed(file)), "abc");
}

TEST(McapOrder, BeginsAtATime) {
  Composer file;
  file.magic().header().channel(1, "/a").message(1, 1, "a").message(1, 4, "d");
  file.chunk(1, 3, Composer().message(1, 1, "b").message(1, 3, "c"));
  file.chunk(2, 5, Composer().message(1, 2, "c").message(1, 4, "e").message(1, 5, "f")).end();
  const auto reader = open_composed(file);
  for (const auto& [from, expected] :
       std::map<std::uint64_t, std::string>{{0, "abccdef"}, {3, "cdef"}, {4, "def"}, {5, "f"}, {6, ""}}) {
    mcap::OrderedMessages messages(*reader, {}, from);
    std::string all;
    while (const mcap::Message* message = messages.next()) all += see(*message).data;
    EXPECT_TRUE(messages.verdict());
    EXPECT_EQ(all, expected) << from;
  }
}

TEST(McapOrder, OpensNoChunkBeforeTheBegin) {
  Composer file;
  file.magic().header().channel(1, "/a");
  file.chunk(1, 2, Composer().message(1, 9, "a"));  // it states a wrong time
  file.chunk(3, 4, Composer().message(1, 4, "b")).end();
  const auto reader = open_composed(file);
  for (const auto& [from, whole] : {std::pair(2, false), std::pair(3, true)}) {
    mcap::OrderedMessages messages(*reader, {}, static_cast<std::uint64_t>(from));
    while (messages.next()) continue;
    EXPECT_EQ(static_cast<bool>(messages.verdict()), whole) << from;
  }
}

TEST(McapOrder, KeepsFileOrderAmongEqualTimes) {
  Composer file;
  file.magic().header().channel(1, "/a").message(1, 7, "a");
  file.chunk(7, 7, Composer().message(1, 7, "b").message(1, 7, "c"));
  file.message(1, 7, "d");
  file.chunk(7, 7, Composer().message(1, 7, "e")).end();
  EXPECT_EQ(data_in_order(*open_composed(file)), "abcde");
}

TEST(McapOrder, TakesChunksThatStandInTheWrongOrder) {
  Composer file;
  file.magic().header().channel(1, "/a");
  file.chunk(5, 6, Composer().message(1, 5, "c").message(1, 6, "d"));
  file.chunk(1, 2, Composer().message(1, 1, "a").message(1, 2, "b")).end();
  EXPECT_EQ(data_in_order(*open_composed(file)), "abcd");
}

TEST(McapOrder, MergesTheGroupsOfOurOwnFiles) {
  const TempFile file;
  write_small_file(file.path());
  auto reader = std::move(*mcap::Reader::open(file.path()));
  EXPECT_EQ(data_in_order(*reader), "zeroa pictureonetwo");
}

TEST(McapOrder, SaysWhenAChunkLiesAboutItsTime) {
  Composer file;
  file.magic().header().channel(1, "/a").chunk(5, 6, Composer().message(1, 1, "a")).end();
  const Pass pass = pass_in_order(*open_composed(file));
  EXPECT_EQ(pass.messages.size(), 1u);
  ASSERT_FALSE(pass.end);
  EXPECT_THAT(pass.end.errors()[0].message, testing::HasSubstr("outside of the time that it states"));
}

TEST(McapOrder, RefusesToHoldTooManyChunksAtOnce) {
  Composer file;
  file.magic().header().channel(1, "/a");
  for (int i = 0; i < 10; ++i) file.chunk(0, 9, Composer().message(1, 9, std::string(100, 'x')));
  mcap::ReaderOptions options;
  options.max_chunk_size = 131;  // one of them; four may be held
  const Pass pass = pass_in_order(*open_composed(file.end(), options));
  ASSERT_FALSE(pass.end);
  EXPECT_THAT(pass.end.errors()[0].message, testing::HasSubstr("overlap in time"));
}
