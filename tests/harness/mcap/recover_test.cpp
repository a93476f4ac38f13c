// Recovery: all complete records are saved, the output is valid, and nothing is invented.

#include <gmock/gmock.h>

#include "core/mcap/examination.h"
#include "core/mcap/recover.h"
#include "mcap_files.h"

using namespace rehearse;
using namespace rehearse::test;
using testing::HasSubstr;

namespace {

/// The result of recover() for some bytes.
struct Saved {
  std::optional<mcap::Recovery> recovery;
  std::string refusal;
  std::vector<Seen> messages;
  std::vector<std::string> extras;  // attachments and metadata
  std::string findings;             // of the doctor, except notes
};

Saved save(const Buffer& bytes, mcap::RecoverOptions options = {}) {
  const TempFile source, target;
  source.write(bytes);
  Saved saved;
  const auto recovery = mcap::recover(source.path(), target.path(), options);
  if (!recovery) {
    saved.refusal = to_string(recovery.errors());
    EXPECT_FALSE(std::filesystem::exists(target.path())) << "nothing is written then";
    return saved;
  }
  saved.recovery = *recovery;
  auto reader = mcap::Reader::open(target.path());
  EXPECT_TRUE(reader);
  const Pass pass = pass_over(**reader);
  EXPECT_TRUE(pass.end) << to_string(pass.end.errors());
  saved.messages = pass.messages;
  for (const auto& attachment : (*reader)->attachments())
    saved.extras.push_back(attachment.name + text_of(attachment.data));
  for (const auto& metadata : (*reader)->metadata())
    if (metadata.name != "rehearse.recover") saved.extras.push_back(metadata.name);
  const auto examination = mcap::examine(target.path());
  EXPECT_TRUE(examination);
  for (const mcap::Finding& finding : examination->findings.list())
    if (finding.severity != Severity::note) saved.findings += finding.message + "\n";
  return saved;
}

bool has(const std::vector<Seen>& all, const Seen& one) { return std::ranges::find(all, one) != all.end(); }

/// Checks that the file contains only records of the whole file, each at most once.
void expect_no_inventions(const Saved& saved, const Saved& whole, const std::string& what) {
  EXPECT_EQ(saved.findings, "") << what;
  EXPECT_LE(saved.messages.size(), whole.messages.size()) << what;
  for (const Seen& message : saved.messages) EXPECT_TRUE(has(whole.messages, message)) << what << ": " << message;
}

}  // namespace

TEST(McapRecover, KeepsAllOfAWholeFile) {
  const Saved saved = save(small_file());
  ASSERT_TRUE(saved.recovery);
  EXPECT_TRUE(saved.recovery->is_whole());
  EXPECT_EQ(saved.recovery->messages, 5u);
  EXPECT_EQ(saved.extras, (std::vector<std::string>{"scenario.yamlrehearse: 1\n", "provenance"}));
  const TempFile source, target;
  write_small_file(source.path());
  ASSERT_TRUE(mcap::recover(source.path(), target.path()));
  EXPECT_EQ((*mcap::Reader::open(target.path()))->metadata().size(), 1u) << "and says nothing of itself";
}

TEST(McapRecover, SavesAPrefixWhereverTheFileIsCut) {
  const Buffer bytes = small_file();
  const Saved whole = save(bytes);
  std::size_t most = 0;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Saved saved = save(Buffer(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)));
    if (!saved.recovery) {
      EXPECT_THAT(saved.refusal, HasSubstr("nothing can be saved")) << size;
      EXPECT_EQ(most, 0u);
      continue;
    }
    expect_no_inventions(saved, whole, "cut at " + std::to_string(size));
    EXPECT_GE(saved.messages.size(), most) << "cut at " << size;
    EXPECT_FALSE(saved.recovery->is_whole()) << size;
    most = saved.messages.size();
  }
  EXPECT_EQ(most, whole.messages.size());
}

/// A flipped byte costs at most its record: here at most the messages of one chunk.
TEST(McapRecover, LosesLittleByAFlippedByte) {
  const Buffer whole_bytes = small_file();
  const Saved whole = save(whole_bytes);
  Buffer bytes = whole_bytes;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] ^= std::byte{0x55};
    const Saved saved = save(bytes);
    ASSERT_TRUE(saved.recovery) << i << ": " << saved.refusal;
    EXPECT_GE(saved.messages.size(), 3u) << "byte " << i;
    EXPECT_EQ(saved.findings, "") << "byte " << i;
    bytes[i] = whole_bytes[i];
  }
}

TEST(McapRecover, SavesWhatIsBehindZeros) {
  const Buffer whole_bytes = small_file();
  const Saved whole = save(whole_bytes);
  for (const std::size_t length : {1u, 7u, 40u, 200u}) {
    for (std::size_t begin = 0; begin + length <= whole_bytes.size(); begin += 7) {
      Buffer bytes = whole_bytes;
      std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(begin), length, std::byte{0});
      const Saved saved = save(bytes);
      if (!saved.recovery) {
        EXPECT_GE(length, 200u) << begin << ": " << saved.refusal;
        continue;
      }
      EXPECT_EQ(saved.findings, "") << length << " zeros at " << begin;
      EXPECT_GE(saved.messages.size(), length <= 7 ? 3u : 0u) << length << " zeros at " << begin;
    }
  }
}

TEST(McapRecover, SaysWhatIsLost) {
  Buffer bytes = small_file();
  const auto data = find_text(bytes, "a picture");
  *data = std::byte{'A'};  // in the chunk of pictures, which isn't compressed
  const Saved saved = save(bytes);
  ASSERT_TRUE(saved.recovery);
  const mcap::Recovery& recovery = *saved.recovery;
  ASSERT_EQ(recovery.lost.size(), 1u);
  EXPECT_EQ(recovery.lost[0].what, "the CRC of the Chunk doesn't match");
  EXPECT_EQ(recovery.lost_bytes, recovery.lost[0].end - recovery.lost[0].begin);
  EXPECT_TRUE(recovery.loss_is_known);
  EXPECT_EQ(recovery.lost_messages, 1u);
  EXPECT_EQ(recovery.channels.at(2).topic, "/pictures");
  EXPECT_EQ(recovery.channels.at(2).lost, 1u);
  EXPECT_EQ(recovery.channels.at(1).lost, 0u);
  EXPECT_EQ(saved.messages.size(), 4u);
}

TEST(McapRecover, TrustsADamagedChunkOnlyIfItIsTold) {
  Buffer bytes = small_file();
  const auto data = find_text(bytes, "a picture");
  *data = std::byte{'A'};
  mcap::RecoverOptions trusting;
  trusting.trust_damaged = true;
  const Saved saved = save(bytes, trusting);
  EXPECT_EQ(saved.messages.size(), 5u);
  EXPECT_TRUE(has(saved.messages, {"/pictures", 0, 0, "A picture"}));
  EXPECT_EQ(saved.findings, "");
}

TEST(McapRecover, GoesByTheSummaryWhereDefinitionsDiffer) {
  Buffer bytes = small_file();
  const auto topic = find_text(bytes, "/numbers");
  *topic = std::byte{'X'};
  const Saved saved = save(bytes);
  ASSERT_TRUE(saved.recovery);
  EXPECT_EQ(saved.messages.size(), 5u);
  EXPECT_TRUE(has(saved.messages, {"/numbers", 1, 1000, "one"}));
  EXPECT_THAT(saved.recovery->lost[0].what, HasSubstr("Channel 1 differs from its definition at byte"));
}

TEST(McapRecover, LosesAChunkWithoutACrcWhoseLastRecordIsNoneThatItCanBe) {
  Composer records = Composer().message(1, 1, "x").message(1, 2, "y");
  const std::size_t last = Composer().message(1, 1, "x").bytes.size();
  records.bytes[last] = std::byte{0x04};  // a channel, whose texts don't fit into it
  const Saved saved =
      save(Composer().magic().header().channel(1, "/a").message(1, 0, "w").chunk(1, 2, records).end().bytes);
  EXPECT_EQ(saved.messages.size(), 1u);
  ASSERT_EQ(saved.recovery->lost.size(), 1u);
  EXPECT_EQ(saved.recovery->lost[0].what, "the records of the Chunk aren't whole from there on");
}

TEST(McapRecover, FindsTheBeginningAgain) {
  Buffer bytes = small_file();
  std::fill_n(bytes.begin(), 20, std::byte{0});
  const Saved saved = save(bytes);
  EXPECT_EQ(saved.messages.size(), 5u);
}

TEST(McapRecover, KeepsNumbersAndBothTimes) {
  Composer file;
  file.magic().header().channel(3, "/a");
  file.record(5,
              Composer().put(std::uint16_t{3}).put(77u).put(std::uint64_t{5}).put(std::uint64_t{4}).raw(bytes_of("x")));
  const TempFile source, target;
  source.write(file.bytes);
  ASSERT_TRUE(mcap::recover(source.path(), target.path()));
  auto reader = std::move(*mcap::Reader::open(target.path()));
  ASSERT_TRUE(reader->for_each_message([](const mcap::Message& message) {
    EXPECT_EQ(message.sequence, 77u);
    EXPECT_EQ(message.log_time, 5u);
    EXPECT_EQ(message.publish_time, 4u);
    return true;
  }));
}

/// The contents of an attachment aren't mistaken for records of the file.
TEST(McapRecover, DoesNotTakeAFileWithinTheFileApart) {
  const Buffer inner = small_file();
  const TempFile source;
  {
    auto writer = std::move(*mcap::Writer::create(source.path()));
    ASSERT_TRUE(writer->add_attachment("inner.mcap", "application/octet-stream", inner));
    const auto channel = writer->add_channel(0, "/outer", "text");
    ASSERT_TRUE(writer->write(channel, 1, 1, bytes_of("x")));
    ASSERT_TRUE(writer->close());
  }
  Buffer bytes = source.read();
  const auto data = find_text(bytes, "rehearse: 1");
  *data = std::byte{'R'};  // its CRC doesn't match any more
  const Saved saved = save(bytes);
  EXPECT_EQ(saved.messages, (std::vector<Seen>{{"/outer", 0, 1, "x"}}));
  EXPECT_THAT(saved.extras, testing::IsEmpty());
}

TEST(McapRecover, RefusesWhereNothingIsToBeSaved) {
  EXPECT_THAT(save(Buffer()).refusal, HasSubstr("nothing can be saved"));
  const auto text = bytes_of("a text that is no MCAP file, but long enough to look for records in it");
  EXPECT_THAT(save(Buffer(text.begin(), text.end())).refusal, HasSubstr("nothing can be saved"));
  EXPECT_THAT(save(Composer().magic().header().end().bytes).refusal, HasSubstr("nothing can be saved"));
}

TEST(McapRecover, NeverWritesOverWhatItReads) {
  const TempFile file;
  write_small_file(file.path());
  const Buffer before = file.read();
  const auto refused = mcap::recover(file.path(), file.path());
  ASSERT_FALSE(refused);
  EXPECT_THAT(to_string(refused.errors()), HasSubstr("can't be replaced: it is also an input"));
  EXPECT_EQ(file.read(), before);
  EXPECT_THAT(to_string(mcap::recover(file.path(), std::filesystem::temp_directory_path()).errors()),
              HasSubstr("it is a directory"));
  EXPECT_THAT(to_string(mcap::recover(file.path(), "/dev/full").errors()), HasSubstr("it is no regular file"));
}

/// Many false record beginnings cost no more than a few passes.
TEST(McapRecover, IsNotLedAstrayByHostileLengths) {
  Composer file;
  file.magic().header();
  for (int i = 0; i < 20000; ++i) file.put(std::uint8_t{0x06}).put(std::uint64_t{100000});
  const TempFile source, target;
  source.write(file.bytes);
  EXPECT_FALSE(mcap::recover(source.path(), target.path()));
}

TEST(McapRecover, MakesTextsUtf8) {
  Composer file;
  file.magic().header().channel(1, "/a\xff\xc3\xa9").message(1, 5, "x");
  const Saved saved = save(file.bytes);
  EXPECT_EQ(saved.messages, (std::vector<Seen>{{"/a\xEF\xBF\xBD\xc3\xa9", 0, 5, "x"}}));
  EXPECT_EQ(saved.findings, "");
}

TEST(McapRecover, KeepsTheMessagesOfASchemaThatTheFormatForbids) {
  Composer file;
  file.magic().header().record(0x03,
                               Composer().put(std::uint16_t{1}).text("test/msg/Text").text("").text("string text"));
  file.record(0x04,
              Composer().put(std::uint16_t{1}).put(std::uint16_t{1}).text("/a").text("cdr").put(std::uint32_t{0}));
  const Saved saved = save(file.message(1, 5, "x").bytes);
  EXPECT_EQ(saved.messages, (std::vector<Seen>{{"/a", 0, 5, "x"}})) << saved.refusal;
  EXPECT_EQ(saved.findings, "");
  ASSERT_TRUE(saved.recovery);
  EXPECT_THAT(saved.recovery->remarks,
              testing::Contains("the schema of '/a' is damaged: its messages are kept without one"));
}

/// The part of a chunk that remains after a cut.
TEST(McapRecover, TrustsTheBeginningOfAChunkThatIsCutOnlyIfItIsTold) {
  const Composer records = Composer().message(1, 5, "one").message(1, 6, "two");
  Composer file;
  file.magic().header().channel(1, "/a").message(1, 1, "loose").chunk(5, 6, records, "", {}, 0x12345678);
  file.bytes.resize(file.bytes.size() - 2);
  EXPECT_EQ(save(file.bytes).messages.size(), 1u);
  mcap::RecoverOptions trusting;
  trusting.trust_damaged = true;
  EXPECT_EQ(save(file.bytes, trusting).messages, (std::vector<Seen>{{"/a", 0, 1, "loose"}, {"/a", 0, 5, "one"}}));
}

TEST(McapRecover, SaysWhatIsLostInValidTextWhateverStandsThere) {
  Composer file;
  file.magic().header().channel(1, "/a").message(1, 1, "x").chunk(1, 1, Composer().message(1, 1, "y"), "z\xff").end();
  const Saved saved = save(file.bytes);
  EXPECT_EQ(saved.messages.size(), 1u);
  EXPECT_EQ(saved.findings, "");
}
