#include "mcap_files.h"

#include <gmock/gmock.h>
#include <unistd.h>

using namespace rehearse;
using namespace rehearse::test;
using testing::HasSubstr;

namespace {

/// The readable content of these bytes: messages, attachments, metadata; and whether an error was reported.
struct Yield {
  std::vector<Seen> messages;
  std::vector<std::string> extras;
  bool whole = false;
};

Yield yield_of(const Buffer& bytes) {
  Yield yield;
  auto reader = mcap::Reader::open_bytes(bytes, "damaged.mcap");
  if (!reader) return yield;
  Pass pass = pass_over(**reader);
  yield.messages = std::move(pass.messages);
  yield.whole = pass.end.ok();
  for (const auto& attachment : (*reader)->attachments()) {
    yield.extras.push_back(attachment.name + attachment.media_type + text_of(attachment.data));
  }
  for (const auto& metadata : (*reader)->metadata()) yield.extras.push_back(metadata.name);
  static_cast<void>(pass_in_order(**reader));
  return yield;
}

std::string complaint_about(const Composer& file, mcap::ReaderOptions options = {}) {
  auto reader = mcap::Reader::open_bytes(file.bytes, "composed.mcap", options);
  if (!reader) return to_string(reader.errors());
  const Pass pass = pass_over(**reader);
  return pass.end ? "" : to_string(pass.end.errors());
}

}  // namespace

TEST(McapDamage, YieldsAPrefixWhereverTheFileIsCut) {
  const Buffer whole = small_file();
  const Yield all = yield_of(whole);
  ASSERT_TRUE(all.whole);
  std::size_t most = 0;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Buffer cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    const Yield yield = yield_of(cut);
    EXPECT_FALSE(yield.whole) << "cut at byte " << size;
    ASSERT_LE(yield.messages.size(), all.messages.size());
    EXPECT_TRUE(std::equal(yield.messages.begin(), yield.messages.end(), all.messages.begin())) << "cut at " << size;
    EXPECT_GE(yield.messages.size(), most) << "a longer piece yields no less";
    most = yield.messages.size();
  }
  EXPECT_EQ(most, all.messages.size());
}

TEST(McapDamage, SurvivesThatAnotherProgramCutsTheFileWhileItIsRead) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("rehearse_cut_" + std::to_string(getpid()) + ".mcap");
  mcap::WriterOptions uncompressed;
  uncompressed.compression = mcap::Compression::none;
  const std::vector<std::byte> payload(1 << 16, std::byte{7});
  for (const bool in_order : {false, true}) {
    auto writer = *mcap::Writer::create(file, uncompressed);
    const std::uint16_t channel = writer->add_channel(0, "/a", "x");
    for (std::uint64_t time = 0; time < 64; ++time) ASSERT_TRUE(writer->write(channel, time, time, payload));
    ASSERT_TRUE(writer->close());
    auto reader = mcap::Reader::open(file);
    ASSERT_TRUE(reader);
    std::filesystem::resize_file(file, 1 << 20);
    const Pass pass = in_order ? pass_in_order(**reader) : pass_over(**reader);
    ASSERT_FALSE(pass.end);
    EXPECT_THAT(pass.end.errors()[0].message, HasSubstr("another program cut the file while it was read"));
    EXPECT_LT(pass.messages.size(), 64u);
  }
  std::filesystem::remove(file);
}

TEST(McapDamage, DetectsEveryFlippedBit) {
  const Buffer whole = small_file();
  Buffer bytes = whole;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      bytes[i] ^= std::byte{1} << bit;
      EXPECT_FALSE(yield_of(bytes).whole) << "bit " << bit << " of byte " << i << " of " << bytes.size();
      bytes[i] = whole[i];
    }
  }
}

TEST(McapDamage, LearnsNothingFromASummaryThatIsNotWhatWasWritten) {
  Buffer bytes = small_file();
  auto repeated = find_text(bytes, "test/msg/Text");  // in the data section
  repeated = std::search(repeated + 1, bytes.end(), repeated, repeated + 13);
  ASSERT_NE(repeated, bytes.end());
  *(repeated - 6) = std::byte{9};  // the schema's id in the summary
  const auto reader = std::move(*mcap::Reader::open_bytes(bytes, "damaged.mcap"));
  EXPECT_FALSE(pass_over(*reader).end);
  EXPECT_EQ(reader->schemas().size(), 1u);
  EXPECT_FALSE(reader->statistics());
}

TEST(McapDamage, SaysWhereAFileIsCut) {
  Composer file;
  file.magic().header().channel(1, "/a");
  const std::size_t start = file.bytes.size();
  file.message(1, 1, "x");
  file.bytes.pop_back();
  EXPECT_EQ(complaint_about(file), "composed.mcap: error: truncated at byte " + std::to_string(file.bytes.size()) +
                                       ": the record that begins at byte " + std::to_string(start) + " isn't whole\n");
}

TEST(McapDamage, TellsZerosFromRecords) {
  Composer file;
  file.magic().header();
  const std::string start = std::to_string(file.bytes.size());
  file.bytes.resize(file.bytes.size() + 1000);  // as a file system leaves them after a power cut
  EXPECT_THAT(complaint_about(file),
              HasSubstr("truncated at byte " + start + ": from there on the file contains zeros only"));
}

TEST(McapDamage, TellsALengthThatIsWrongFromAFileThatIsCut) {
  Composer file;
  file.magic().header();
  const std::string start = std::to_string(file.bytes.size());
  file.put(std::uint8_t{0x05}).put(std::uint64_t{1} << 60).end();
  EXPECT_THAT(complaint_about(file), HasSubstr("damaged at byte " + start));
}

TEST(McapDamage, SaysWhichChunkHasAWrongCrcAndGoesOn) {
  Composer file;
  file.magic().header().channel(1, "/a");
  const std::string start = std::to_string(file.bytes.size());
  file.chunk(1, 1, Composer().message(1, 1, "bad"), "", {}, 0xdeadbeef)
      .chunk(2, 2, Composer().message(1, 2, "good"))
      .end();
  const Pass pass = pass_over(*open_composed(file));
  EXPECT_EQ(pass.messages, (std::vector<Seen>{{"/a", 0, 2, "good"}}));
  EXPECT_EQ(to_string(pass.end.errors()),
            "composed.mcap: error: damaged: the CRC of the chunk at byte " + start + " doesn't match\n");
}

TEST(McapDamage, ReadsOverCrcsWhenItIsToldTo) {
  Composer file;
  file.magic().header().channel(1, "/a").chunk(1, 1, Composer().message(1, 1, "bad"), "", {}, 0xdeadbeef).end();
  EXPECT_EQ(complaint_about(file, {.check_crcs = false}), "");
}

TEST(McapDamage, RefusesFilesThatAreNotMcap) {
  EXPECT_EQ(complaint_about(Composer()), "composed.mcap: error: not an MCAP file: it is empty\n");
  EXPECT_EQ(complaint_about(Composer().raw(bytes_of("rehearse: 1\nduration: 2\n"))),
            "composed.mcap: error: not an MCAP file: it doesn't begin with the magic bytes \\x89MCAP0\\r\\n\n");
  EXPECT_THAT(complaint_about(Composer().raw(bytes_of("\x89MCAP9\r\n"))),
              HasSubstr("a version that this reader doesn't support"));
}

TEST(McapDamage, DoesNotBelieveAChunkThatSaysItIsHuge) {
  Composer file;
  file.magic().header().chunk(0, 0, Composer().text("?"), "zstd", std::uint64_t{1} << 40).end();
  EXPECT_THAT(complaint_about(file), HasSubstr("states 1099511627776 bytes decompressed"));
}

TEST(McapDamage, SaysThatAChunkIsSmallerThanItSays) {
  const Composer records = Composer().message(1, 1, "x");
  Composer file;
  file.magic().header().channel(1, "/a").chunk(1, 1, records, "", records.bytes.size() + 1).end();
  EXPECT_THAT(complaint_about(file), HasSubstr("can't be decompressed"));
}

TEST(McapDamage, NamesACompressionThatItDoesNotKnow) {
  Composer file;
  file.magic().header().chunk(1, 1, Composer().text("x"), "brotli").end();
  EXPECT_THAT(complaint_about(file), HasSubstr("its compression \"brotli\""));
}

TEST(McapDamage, DoesNotBelieveLengthsInsideOfRecords) {
  constexpr std::uint32_t huge = 0xfffffff0;
  const auto file = [](std::uint8_t opcode, const Composer& body) {
    Composer composed;
    composed.magic().header().record(opcode, body).end();
    return composed;
  };
  EXPECT_THAT(complaint_about(file(0x03, Composer().put(std::uint16_t{1}).put(huge))), HasSubstr("schema"));
  EXPECT_THAT(complaint_about(file(0x04, Composer().put(std::uint32_t{1}).put(huge))), HasSubstr("channel"));
  EXPECT_THAT(complaint_about(file(0x0c, Composer().text("m").put(huge))), HasSubstr("Metadata"));
  EXPECT_THAT(complaint_about(file(0x06, Composer().put(std::uint64_t{0}))), HasSubstr("chunk"));
  EXPECT_THAT(
      complaint_about(file(
          0x09, Composer().put(std::uint64_t{0}).put(std::uint64_t{0}).text("a").text("b").put(~std::uint64_t{0}))),
      HasSubstr("attachment"));
}

TEST(McapDamage, NamesTheChannelOfAMessageThatHasNone) {
  Composer file;
  file.magic().header().message(9, 1, "x").end();
  EXPECT_THAT(complaint_about(file), HasSubstr("is of channel 9, which isn't defined"));
}

TEST(McapDamage, SaysThatAMessageIsTooShort) {
  Composer file;
  file.magic().header().record(0x05, Composer().put(std::uint16_t{1})).end();
  EXPECT_THAT(complaint_about(file), HasSubstr("is too short"));
}

TEST(McapDamage, SaysThatAChannelIsDefinedTwiceAndDifferently) {
  Composer file;
  file.magic().header().channel(1, "/a").channel(1, "/a").channel(1, "/b").end();
  EXPECT_THAT(complaint_about(file), HasSubstr("channel 1 is defined a second time"));
}

TEST(McapDamage, KeepsItsListOfComplaintsShort) {
  Composer file;
  file.magic().header();
  for (int i = 0; i < 10000; ++i) file.message(9, 1, "x");
  const Pass pass = pass_over(*open_composed(file.end()));
  EXPECT_LE(pass.end.errors().size(), 51u);
  EXPECT_EQ(pass.end.errors().back().message, "and more damage after that");
}
