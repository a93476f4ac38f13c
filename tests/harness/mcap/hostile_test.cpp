// Hostile files: decompression bombs, inconsistent lengths, contradictory ids and times, text that isn't UTF-8.
#include "mcap_files.h"

#include <gmock/gmock.h>
#include <lz4frame.h>
#include <zstd.h>

#include <functional>

using namespace rehearse;
using namespace rehearse::test;
using testing::HasSubstr;
using namespace std::string_literals;

namespace {

/// Any number of zeros, compressed piece by piece.
Composer zstd_zeros(std::uint64_t size) {
  Composer packed;
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(), &ZSTD_freeCCtx);
  const Buffer zeros(1 << 20);
  Buffer out(ZSTD_CStreamOutSize());
  while (size > 0) {
    ZSTD_inBuffer in{zeros.data(), std::min<std::uint64_t>(size, zeros.size()), 0};
    size -= in.size;
    const auto mode = size == 0 ? ZSTD_e_end : ZSTD_e_continue;
    std::size_t left = 1;
    while (mode == ZSTD_e_end ? left != 0 : in.pos < in.size) {
      ZSTD_outBuffer place{out.data(), out.size(), 0};
      left = ZSTD_compressStream2(context.get(), &place, &in, mode);
      packed.raw({out.data(), place.pos});
    }
  }
  return packed;
}

Composer lz4_zeros(std::size_t size) {
  const Buffer zeros(size);
  Composer packed;
  packed.bytes.resize(LZ4F_compressFrameBound(size, nullptr));
  packed.bytes.resize(LZ4F_compressFrame(packed.bytes.data(), packed.bytes.size(), zeros.data(), size, nullptr));
  return packed;
}

std::string complaint_of_hostile(const Composer& file) {
  auto reader = mcap::Reader::open_bytes(file.bytes, "composed.mcap");
  if (!reader) return to_string(reader.errors());
  const Pass pass = pass_over(**reader);
  const Pass in_order = pass_in_order(**reader);
  EXPECT_EQ(pass.end.ok(), in_order.end.ok()) << "both ways find it";
  return to_string(pass.end.errors());
}

Composer file_of(const Composer& records) { return Composer().magic().header().raw(records.bytes).end(); }

constexpr std::uint64_t gigabyte = std::uint64_t{1} << 30;

}  // namespace

TEST(McapHostile, ABombThatSaysItIsSmallIsStoppedThere) {
  const Composer zstd = zstd_zeros(gigabyte + 1);
  ASSERT_LT(zstd.bytes.size(), 100'000u);
  EXPECT_THAT(complaint_of_hostile(file_of(Composer().chunk(0, 0, zstd, "zstd", 1000))),
              HasSubstr("can't be decompressed"));
  EXPECT_THAT(complaint_of_hostile(file_of(Composer().chunk(0, 0, lz4_zeros(1 << 24), "lz4", 1000))),
              HasSubstr("can't be decompressed"));
}

TEST(McapHostile, ABombThatSaysWhatItIsIsNotOpened) {
  EXPECT_THAT(complaint_of_hostile(file_of(Composer().chunk(0, 0, zstd_zeros(gigabyte + 1), "zstd", gigabyte + 1))),
              HasSubstr("states 1073741825 bytes decompressed, more than the limit of 1073741824"));
  EXPECT_THAT(complaint_of_hostile(file_of(Composer().chunk(0, 0, lz4_zeros(1 << 20), "lz4", std::uint64_t{1} << 40))),
              HasSubstr("states 1099511627776 bytes decompressed"));
}

TEST(McapHostile, ABombThatIsSmallerThanItSaysIsNoChunk) {
  EXPECT_THAT(complaint_of_hostile(file_of(Composer().chunk(0, 0, zstd_zeros(1000), "zstd", 1'000'000))),
              HasSubstr("states 1000000 bytes decompressed and contains 1000"));
  EXPECT_THAT(complaint_of_hostile(file_of(Composer().chunk(0, 0, lz4_zeros(1000), "lz4", 1'000'000))),
              HasSubstr("states 1000000 bytes decompressed and contains 1000"));
}

TEST(McapHostile, AChunkInAChunkIsNotOpened) {
  const Composer inner = Composer().chunk(1, 1, Composer().message(1, 1, "inside"));
  const Composer file =
      file_of(Composer().channel(1, "/a").chunk(1, 1, Composer().raw(inner.bytes).message(1, 1, "x")));
  const Pass pass = pass_over(*open_composed(file));
  EXPECT_TRUE(pass.end);
  EXPECT_EQ(pass.messages, (std::vector<Seen>{{"/a", 0, 1, "x"}}));
}

TEST(McapHostile, LengthsInLengthsAreNotBelieved) {
  // a map of 8 bytes whose first key has a stated length of 4 gigabytes, in a record that is long enough for neither
  const auto map = [](Composer head) {
    return head.put(std::uint32_t{8}).put(~std::uint32_t{0}).put(std::uint32_t{0});
  };
  EXPECT_THAT(complaint_of_hostile(file_of(Composer().record(0x0c, map(Composer().text("m"))))), HasSubstr("Metadata"));
  EXPECT_THAT(
      complaint_of_hostile(file_of(Composer().record(0x04, map(Composer().put(std::uint32_t{1}).text("/a").text(""))))),
      HasSubstr("channel"));
  // a record in a chunk that is longer than the chunk
  Composer records;
  records.put(std::uint8_t{5}).put(std::uint64_t{1} << 40).text("x");
  EXPECT_THAT(complaint_of_hostile(file_of(Composer().chunk(0, 0, records))), HasSubstr("aren't whole"));
  // compressed records that are longer than their chunk
  Composer chunk = Composer().put(std::uint64_t{0}).put(std::uint64_t{0}).put(std::uint64_t{10}).put(std::uint32_t{0});
  chunk.text("").put(std::uint64_t{1} << 40).text("x");
  EXPECT_THAT(complaint_of_hostile(file_of(Composer().record(0x06, chunk))),
              HasSubstr("is shorter than its fields state"));
}

TEST(McapHostile, ReadsAllChannelsThatThereCanBe) {
  Composer records;
  for (int id = 0; id < 0x10000; ++id) records.channel(static_cast<std::uint16_t>(id), "/" + std::to_string(id));
  records.message(0, 1, "first").message(0xffff, 2, "last");
  const Composer file = file_of(Composer().chunk(1, 2, records));
  const auto reader = open_composed(file);
  EXPECT_EQ(reader->channels().size(), 0x10000u);
  EXPECT_EQ(pass_over(*reader).messages, (std::vector<Seen>{{"/0", 0, 1, "first"}, {"/65535", 0, 2, "last"}}));
}

TEST(McapHostile, AMessageMayComeBeforeItsChannel) {
  const Composer file = file_of(Composer().message(1, 1, "early").channel(1, "/a").message(1, 2, "late"));
  const Pass pass = pass_over(*open_composed(file));
  EXPECT_TRUE(pass.end) << to_string(pass.end.errors());
  EXPECT_EQ(pass.messages.size(), 2u);
}

TEST(McapHostile, TheFirstDefinitionCountsAndASecondOtherOneIsDamage) {
  const auto schema = [](std::string_view name) {
    return Composer().record(0x03, Composer().put(std::uint16_t{1}).text(name).text("ros2msg").text(""));
  };
  EXPECT_EQ(complaint_of_hostile(file_of(Composer().raw(schema("A").bytes).raw(schema("A").bytes))), "");
  EXPECT_THAT(complaint_of_hostile(file_of(Composer().raw(schema("A").bytes).raw(schema("B").bytes))),
              HasSubstr("schema 1 is defined a second time"));
  const Composer file =
      file_of(Composer().channel(1, "/a").chunk(1, 1, Composer().channel(1, "/b").message(1, 1, "x")));
  EXPECT_THAT(complaint_of_hostile(file), HasSubstr("channel 1 is defined a second time"));
  EXPECT_EQ(pass_over(*open_composed(file)).messages, (std::vector<Seen>{{"/a", 0, 1, "x"}}));
}

TEST(McapHostile, TimesMayGoBackwards) {
  const Composer file = file_of(Composer()
                                    .channel(1, "/a")
                                    .message(1, 30, "c")
                                    .chunk(10, 20, Composer().message(1, 20, "b").message(1, 10, "a"))
                                    .message(1, ~std::uint64_t{0}, "z")
                                    .message(1, 0, "0"));
  const auto reader = open_composed(file);
  const auto text = [](const Pass& pass) {
    std::string all;
    for (const Seen& message : pass.messages) all += message.data;
    return all;
  };
  EXPECT_EQ(text(pass_over(*reader)), "cbaz0");
  EXPECT_EQ(text(pass_in_order(*reader)), "0abcz");
}

TEST(McapHostile, BytesThatAreNoTextComeThroughAsTheyAre) {
  const std::string bytes = "\xff\xfe\x00 \xc3\x28"s + std::string("\xed\xa0\x80");
  const Composer file = file_of(Composer()
                                    .record(0x03, Composer().put(std::uint16_t{1}).text(bytes).text(bytes).text(bytes))
                                    .channel(1, bytes)
                                    .record(0x0c, Composer().text(bytes).put(std::uint32_t{0}))
                                    .message(1, 1, "x"));
  const auto reader = open_composed(file);
  EXPECT_EQ(reader->channels().at(1).topic, bytes);
  EXPECT_EQ(reader->schemas().at(1).name, bytes);
  EXPECT_EQ(reader->metadata()[0].name, bytes);
  EXPECT_TRUE(pass_over(*reader).end);
}

TEST(McapHostile, NothingIsBehindTheFooterButTheMagic) {
  const Composer once = file_of(Composer().channel(1, "/a").message(1, 1, "x"));
  const Composer twice = Composer().raw(once.bytes).footer();
  EXPECT_THAT(complaint_of_hostile(twice), HasSubstr("damaged at byte " + std::to_string(once.bytes.size() - 8) +
                                                     ": the file doesn't end with its magic bytes there"));
  EXPECT_EQ(pass_over(*open_composed(twice)).messages.size(), 1u);
}

TEST(McapHostile, AFileMayDoWithoutDataEnd) {
  const Composer file = Composer().magic().header().channel(1, "/a").message(1, 1, "x").footer();
  EXPECT_EQ(complaint_of_hostile(file), "");
}

TEST(McapHostile, AFooterThatPointsNowhereIsDamage) {
  for (const std::uint64_t nowhere : {std::uint64_t{1}, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    Composer file = Composer().magic().header().record(0x0f, Composer().put(std::uint32_t{0}));
    file.record(0x02, Composer().put(nowhere).put(nowhere).put(std::uint32_t{0})).magic();
    EXPECT_THAT(complaint_of_hostile(file), HasSubstr("states a summary at byte " + std::to_string(nowhere)));
    const auto reader = open_composed(file, {.opening = mcap::Opening::by_summary});
    EXPECT_FALSE(reader->opened_by_summary());
  }
}
