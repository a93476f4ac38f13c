// The forms of a file: those that options of the Writer determine, and those that other writers produce; and the
// Writer's output files.
#include "file_forms.h"
#include "mcap_files.h"
#include "support/printed_by_name.h"

#include <gmock/gmock.h>

#include <sys/stat.h>
#include <functional>
#include <map>
#include <thread>

using namespace rehearse;
using namespace rehearse::test;
using testing::HasSubstr;

namespace {

namespace fs = std::filesystem;

struct Form {
  std::string name;
  std::function<void(mcap::WriterOptions&, FileForm&)> set;
  std::vector<int> without;  // opcodes that aren't in the file
};
std::vector<Form> forms() {
  using O = mcap::WriterOptions;
  using F = FileForm;
  return {
      {"AsEver", [](O&, F&) {}, {}},
      {"Unchunked", [](O&, F& f) { f.chunks = false; }, {0x06, 0x07, 0x08}},
      {"DefinitionsInChunks", [](O&, F& f) { f.definitions_in_chunks = true; }, {}},
      {"NoMessageIndex", [](O&, F& f) { f.message_indexes = false; }, {0x07}},
      {"NoSummary", [](O&, F& f) { f.summary = false; }, {0x08, 0x0a, 0x0b, 0x0d, 0x0e}},
      {"NoRepeatedSchemas", [](O&, F& f) { f.repeated_schemas = false; }, {}},
      {"NoRepeatedChannels", [](O&, F& f) { f.repeated_channels = false; }, {}},
      {"DefinitionsOnlyInChunks",
       [](O&, F& f) {
         f.definitions_in_chunks = true;
         f.repeated_schemas = f.repeated_channels = false;
       },
       {}},
      {"NoStatistics", [](O&, F& f) { f.statistics = false; }, {0x0b}},
      {"NoChunkIndex", [](O&, F& f) { f.chunk_indexes = false; }, {0x08}},
      {"NoAttachmentIndex", [](O&, F& f) { f.attachment_indexes = false; }, {0x0a}},
      {"NoMetadataIndex", [](O&, F& f) { f.metadata_indexes = false; }, {0x0d}},
      {"NoSummaryOffsets", [](O&, F& f) { f.summary_offsets = false; }, {0x0e}},
      {"NoCrcs", [](O&, F& f) { f.crcs = false; }, {}},
      {"NoCrcsOfChunksAndData", [](O& o, F&) { o.crcs = false; }, {}},
      {"Uncompressed", [](O& o, F&) { o.compression = mcap::Compression::none; }, {}},
      {"Lz4", [](O& o, F&) { o.compression = mcap::Compression::lz4; }, {}},
      {"Lz4Level9",
       [](O& o, F&) {
         o.compression = mcap::Compression::lz4;
         o.lz4_level = 9;
       },
       {}},
      {"ZstdLevel19",
       [](O& o, F&) {
         o.compression = mcap::Compression::zstd;
         o.zstd_level = 19;
       },
       {}},
  };
}

class McapForms : public testing::TestWithParam<Form> {
 protected:
  /// Two channels in two groups, one of them put off, an attachment, metadata.
  static Buffer file_of(const Form& form) {
    mcap::WriterOptions options;
    FileForm left;
    form.set(options, left);
    options.chunk_size = 300;
    const Buffer whole = written(options, [](mcap::Writer& writer) {
      const auto schema = writer.add_schema("test/msg/Text", "ros2msg", "string text\n");
      const auto numbers = writer.add_channel(schema, "/numbers", "cdr");
      const auto pictures = writer.add_channel(0, "/pictures", "png", {}, mcap::pictures);
      EXPECT_TRUE(writer.add_attachment("scenario.yaml", "application/yaml", bytes_of("rehearse: 1\n")));
      for (std::uint64_t i = 0; i < 50; ++i) {
        EXPECT_TRUE(writer.write(numbers, i, i, bytes_of("number " + std::to_string(i))));
        if (i % 5 != 0) continue;
        EXPECT_TRUE(writer.write_later(pictures, i, i, 100, Buffer(i + 1, std::byte{'p'}),
                                       [](mcap::Bytes raw) { return Buffer(raw.begin(), raw.end()); }));
      }
      EXPECT_TRUE(writer.add_metadata("provenance", {{"seed", "0"}}));
    });
    return options.crcs ? in_form(whole, left) : whole;
  }

  static std::map<int, int> records_of(mcap::Bytes file) {
    std::map<int, int> count;
    for_each_record(file, [&](const mcap::Record& record) { return ++count[record.opcode], true; });
    return count;
  }
};

}  // namespace

TEST_P(McapForms, AreReadBackWhateverIsLeftOut) {
  const Buffer bytes = file_of(GetParam());
  const Buffer usual_bytes = file_of(forms().front());
  const auto usual = std::move(*mcap::Reader::open_bytes(usual_bytes, "usual"));
  const auto reader = std::move(*mcap::Reader::open_bytes(bytes, "a"));
  EXPECT_TRUE(reader->damage().empty()) << to_string(reader->damage());
  const Pass pass = pass_over(*reader);
  EXPECT_TRUE(pass.end) << to_string(pass.end.errors());
  EXPECT_EQ(pass.messages.size(), 60u);
  EXPECT_EQ(reader->schemas(), usual->schemas());
  EXPECT_EQ(reader->channels(), usual->channels());
  ASSERT_EQ(reader->attachments().size(), 1u);
  EXPECT_EQ(text_of(reader->attachments()[0].data), "rehearse: 1\n");
  ASSERT_EQ(reader->metadata().size(), 1u);

  const Pass in_order = pass_in_order(*reader);
  EXPECT_TRUE(in_order.end);
  std::uint64_t time = 0;
  std::map<std::string, std::uint32_t> next;
  for (const Seen& message : in_order.messages) {
    EXPECT_GE(message.log_time, time);
    time = message.log_time;
    EXPECT_EQ(message.sequence, next[message.topic]++);
    EXPECT_EQ(message.data,
              message.topic == "/numbers" ? "number " + std::to_string(time) : std::string(time + 1, 'p'));
  }
  EXPECT_EQ(next, (std::map<std::string, std::uint32_t>{{"/numbers", 50}, {"/pictures", 10}}));
}

TEST_P(McapForms, HaveNothingOfWhatIsLeftOut) {
  const Buffer bytes = file_of(GetParam());
  const auto reader = std::move(*mcap::Reader::open_bytes(bytes, "a"));
  const auto records = records_of(bytes);
  for (const int opcode : GetParam().without) EXPECT_FALSE(records.contains(opcode)) << "opcode " << opcode;
  for (int opcode = 1; opcode <= 0x0f; ++opcode) {
    const bool left_out = std::ranges::find(GetParam().without, opcode) != GetParam().without.end();
    EXPECT_EQ(records.contains(opcode), !left_out) << "opcode " << opcode;
  }
}

INSTANTIATE_TEST_SUITE_P(All, McapForms, testing::ValuesIn(forms()), test::by_name);

/// The other tests of forms rely on it.
TEST(McapForms, AFileOfTheWriterIsComposedByteForByte) {
  const Buffer whole = small_file();
  EXPECT_EQ(in_form(whole, {}), whole);
}

TEST(McapWriterForms, NamesWhoWrites) {
  mcap::WriterOptions options;
  options.library = "a recorder 1.0";
  options.profile = "";
  const Buffer bytes = written(options, [](mcap::Writer&) {});
  const auto reader = std::move(*mcap::Reader::open_bytes(bytes, "a"));
  EXPECT_EQ(reader->library(), "a recorder 1.0");
  EXPECT_EQ(reader->profile(), "");
}

TEST(McapWriterLimits, Holds65536ChannelsAndSaysThatOneMoreIsTooMany) {
  const TempFile file;
  const auto writer = std::move(*mcap::Writer::create(file.path()));
  std::uint16_t last = 0;
  for (int i = 0; i < 0x10000; ++i) {
    last = writer->add_channel(0, "/" + std::to_string(i), "text");
    if (i % 1000 != 0) continue;
    ASSERT_TRUE(writer->write(last, 0, 0, bytes_of("x")));
  }
  EXPECT_EQ(last, 0) << "the ids begin at 1";
  ASSERT_TRUE(writer->write(last, 1, 1, bytes_of("the last")));
  ASSERT_TRUE(writer->flush());
  {
    const auto reader = std::move(*mcap::Reader::open(file.path()));
    const Pass pass = pass_over(*reader);
    EXPECT_EQ(reader->channels().size(), 0x10000u);
    EXPECT_EQ(pass.messages.back(), (Seen{"/65535", 0, 1, "the last"}));
  }
  const auto one_more = writer->add_channel(0, "/one/more", "text");
  const auto written = writer->write(one_more, 2, 2, bytes_of("x"));
  ASSERT_FALSE(written);
  EXPECT_EQ(written.errors()[0].message, "the channel /one/more is one too many: a file contains at most 65536");
  EXPECT_FALSE(writer->close());
}

TEST(McapWriterLimits, Holds65535SchemasAndSaysThatOneMoreIsTooMany) {
  const TempFile file;
  const auto writer = std::move(*mcap::Writer::create(file.path()));
  for (int i = 1; i < 0x10000; ++i) ASSERT_EQ(writer->add_schema("T" + std::to_string(i), "ros2msg", ""), i);
  ASSERT_EQ(writer->add_schema("T7", "ros2msg", ""), 7);
  EXPECT_TRUE(writer->flush());
  EXPECT_EQ(writer->add_schema("U", "ros2msg", ""), 0);
  EXPECT_THAT(to_string(writer->close().errors()),
              HasSubstr("the schema U is one too many: a file contains at most 65535"));
}

TEST(McapWriterTargets, WhoHasTheOldFileOpenKeepsIt) {
  const TempFile file;
  write_small_file(file.path());
  fs::permissions(file.path(), fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
  const auto reader = std::move(*mcap::Reader::open(file.path()));
  ASSERT_TRUE(std::move(*mcap::Writer::create(file.path()))->close());
  EXPECT_EQ(pass_over(*reader).messages.size(), 5u) << "as it was";
  EXPECT_TRUE(pass_over(*std::move(*mcap::Reader::open(file.path()))).messages.empty()) << "as it is";
  EXPECT_EQ(fs::status(file.path()).permissions(),
            fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
}

TEST(McapWriterTargets, ALinkStaysALink) {
  const TempFile file, link;
  write_small_file(file.path());
  fs::create_symlink(file.path(), link.path());
  ASSERT_TRUE(std::move(*mcap::Writer::create(link.path()))->close());
  EXPECT_TRUE(fs::is_symlink(link.path()));
  EXPECT_TRUE(pass_over(*std::move(*mcap::Reader::open(file.path()))).messages.empty()) << "where it leads to";
}

TEST(McapWriterTargets, AFileWithTwoNamesKeepsBoth) {
  const TempFile file, other;
  write_small_file(file.path());
  fs::create_hard_link(file.path(), other.path());
  ASSERT_TRUE(std::move(*mcap::Writer::create(file.path()))->close());
  EXPECT_TRUE(fs::equivalent(file.path(), other.path()));
}

TEST(McapWriterTargets, APipeIsWrittenInto) {
  const TempFile pipe;
  ASSERT_EQ(::mkfifo(pipe.path().c_str(), 0600), 0);
  std::thread writer([&] { write_small_file(pipe.path()); });
  const auto reader = std::move(*mcap::Reader::open(pipe.path()));
  writer.join();
  EXPECT_EQ(pass_over(*reader).messages.size(), 5u);
  EXPECT_TRUE(fs::is_fifo(pipe.path()));
}
