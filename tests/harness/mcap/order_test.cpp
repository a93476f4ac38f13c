#include "mcap_files.h"

#include <gmock/gmock.h>

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

}  // namespace

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
