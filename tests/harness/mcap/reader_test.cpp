#include "file_forms.h"
#include "mcap_files.h"

#include <gmock/gmock.h>
#include <lz4frame.h>

using namespace rehearse;
using namespace rehearse::test;
using testing::HasSubstr;

TEST(McapReader, ReadsBackWhatWasWritten) {
  const TempFile file;
  write_small_file(file.path());
  auto reader = std::move(*mcap::Reader::open(file.path()));
  const Pass pass = pass_over(*reader);
  EXPECT_TRUE(pass.end) << to_string(pass.end.errors());
  EXPECT_EQ(pass.messages, (std::vector<Seen>{{"/numbers", 0, 0, "zero"},
                                              {"/numbers", 1, 1000, "one"},
                                              {"/pictures", 0, 0, "a picture"},
                                              {"/numbers", 2, 2000, "two"},
                                              {"/numbers", 3, 3000, ""}}));
}

TEST(McapReader, KnowsWhatElseIsInTheFile) {
  const TempFile file;
  write_small_file(file.path());
  auto reader = std::move(*mcap::Reader::open(file.path()));
  EXPECT_THAT(reader->library(), testing::StartsWith("rehearse "));
  EXPECT_EQ(reader->schema_of(reader->channels().at(1))->name, "test/msg/Text");
  EXPECT_EQ(reader->schema_of(reader->channels().at(2)), nullptr);
  ASSERT_EQ(reader->attachments().size(), 1u);
  EXPECT_EQ(reader->attachments()[0].name, "scenario.yaml");
  EXPECT_EQ(reader->attachments()[0].media_type, "application/yaml");
  EXPECT_EQ(text_of(reader->attachments()[0].data), "rehearse: 1\n");
  ASSERT_EQ(reader->metadata().size(), 1u);
  EXPECT_EQ(reader->metadata()[0].name, "provenance");
  EXPECT_EQ(reader->metadata()[0].values, (mcap::StringMap{{"seed", "0"}, {"solver", "quick"}}));
}

TEST(McapReader, ReadsTheStatistics) {
  const TempFile file;
  write_small_file(file.path());
  auto reader = std::move(*mcap::Reader::open(file.path()));
  const mcap::Statistics& s = reader->statistics().value();
  EXPECT_EQ(s.message_count, 5u);
  EXPECT_EQ(s.schema_count, 1u);
  EXPECT_EQ(s.channel_count, 2u);
  EXPECT_EQ(s.attachment_count, 1u);
  EXPECT_EQ(s.metadata_count, 1u);
  EXPECT_EQ(s.chunk_count, 3u);
  EXPECT_EQ(s.message_start_time, 0u);
  EXPECT_EQ(s.message_end_time, 3000u);
  EXPECT_EQ(s.channel_message_counts, (std::map<std::uint16_t, std::uint64_t>{{1, 4}, {2, 1}}));
}

TEST(McapReader, DeliversOnlyTheChosenChannels) {
  const TempFile file;
  write_small_file(file.path());
  auto reader = std::move(*mcap::Reader::open(file.path()));
  std::vector<std::string> data;
  const std::uint16_t pictures = 2;
  EXPECT_TRUE(reader->for_each_message(
      [&](const mcap::Message& message) { return data.push_back(text_of(message.data)), true; }, {&pictures, 1}));
  EXPECT_EQ(data, std::vector<std::string>{"a picture"});
}

TEST(McapReader, StopsWhenItIsToldTo) {
  const TempFile file;
  write_small_file(file.path());
  auto reader = std::move(*mcap::Reader::open(file.path()));
  int count = 0;
  EXPECT_TRUE(reader->for_each_message([&](const mcap::Message&) { return ++count < 2; }));
  EXPECT_EQ(count, 2);
}

TEST(McapReader, FindsEveryMessageAgainByItsLocation) {
  const TempFile file;
  write_small_file(file.path());
  auto reader = std::move(*mcap::Reader::open(file.path()));
  std::vector<std::pair<mcap::Location, Seen>> all;
  EXPECT_TRUE(reader->for_each_message(
      [&](const mcap::Message& message) { return all.emplace_back(message.location, see(message)), true; }));
  for (auto entry = all.rbegin(); entry != all.rend(); ++entry) {
    const auto again = reader->message_at(entry->first);
    ASSERT_TRUE(again);
    EXPECT_EQ(see(*again), entry->second);
  }
}

TEST(McapReader, FindsNoMessageWhereNoneIs) {
  Composer file;
  file.magic().header().channel(1, "/a");
  const std::uint64_t chunk = file.bytes.size();
  file.chunk(1, 1, Composer().message(1, 1, "x")).end();
  const auto reader = open_composed(file);
  EXPECT_TRUE(reader->message_at({chunk, 0, true}));
  EXPECT_FALSE(reader->message_at({chunk, 1, true}));
  EXPECT_FALSE(reader->message_at({chunk, 1'000'000, true}));
  EXPECT_FALSE(reader->message_at({chunk, 0, false})) << "that is a chunk";
  EXPECT_FALSE(reader->message_at({8, 0, true})) << "that is the header";
  EXPECT_FALSE(reader->message_at({file.bytes.size(), 0, false}));
}

TEST(McapReader, ReadsMessagesThatAreInNoChunk) {
  Composer file;
  file.magic().header().channel(1, "/a").message(1, 5, "five").message(1, 6, "six").end();
  const auto reader = open_composed(file);
  const Pass pass = pass_over(*reader);
  EXPECT_TRUE(pass.end);
  EXPECT_EQ(pass.messages, (std::vector<Seen>{{"/a", 0, 5, "five"}, {"/a", 0, 6, "six"}}));
}

TEST(McapReader, LearnsChannelsInsideOfChunksWhenThereIsNoSummary) {
  Composer file;
  file.magic().header().chunk(1, 1, Composer().channel(7, "/a").message(7, 1, "x")).end();
  const auto reader = open_composed(file);
  EXPECT_EQ(reader->channels().at(7).topic, "/a");
  EXPECT_EQ(pass_over(*reader).messages.size(), 1u);
}

TEST(McapReader, LearnsSchemasInsideOfChunksWhenTheSummaryHasOnlyTheChannels) {
  const Buffer bytes = in_form(written({},
                                       [](mcap::Writer& writer) {
                                         const auto channel =
                                             writer.add_channel(writer.add_schema("T", "ros2msg", ""), "/a", "cdr");
                                         ASSERT_TRUE(writer.write(channel, 1, 1, bytes_of("x")));
                                       }),
                               {.definitions_in_chunks = true, .repeated_schemas = false});
  const auto reader = std::move(*mcap::Reader::open_bytes(bytes, "a"));
  EXPECT_EQ(reader->schemas().at(1).name, "T");
}

TEST(McapReader, ReadsLz4Chunks) {
  const Composer records = Composer().channel(1, "/a").message(1, 1, std::string(1000, 'x'));
  Composer packed;
  packed.bytes.resize(LZ4F_compressFrameBound(records.bytes.size(), nullptr));
  packed.bytes.resize(LZ4F_compressFrame(packed.bytes.data(), packed.bytes.size(), records.bytes.data(),
                                         records.bytes.size(), nullptr));
  Composer file;
  file.magic().header().chunk(1, 1, packed, "lz4", records.bytes.size()).end();
  const auto reader = open_composed(file);
  const Pass pass = pass_over(*reader);
  EXPECT_TRUE(pass.end) << to_string(pass.end.errors());
  ASSERT_EQ(pass.messages.size(), 1u);
  EXPECT_EQ(pass.messages[0].data, std::string(1000, 'x'));
}

TEST(McapReader, WritesAndReadsLz4) {
  const TempFile file;
  auto writer = std::move(*mcap::Writer::create(file.path()));
  const auto channel = writer->add_channel(0, "/a", "text", {}, {2, mcap::Compression::lz4});
  for (std::uint64_t i = 0; i < 100; ++i) ASSERT_TRUE(writer->write(channel, i, i, bytes_of("again and again")));
  ASSERT_TRUE(writer->close());
  auto reader = std::move(*mcap::Reader::open(file.path()));
  EXPECT_LT(reader->size(), 100 * (9 + 22 + 15u)) << "the messages alone would be larger";
  EXPECT_EQ(pass_over(*reader).messages.size(), 100u);
}

TEST(McapReader, SkipsRecordsAndFieldsThatItDoesNotKnow) {
  Composer channel;
  channel.put(std::uint16_t{1}).put(std::uint16_t{0}).text("/a").text("text").put(std::uint32_t{0}).text("a new field");
  Composer file;
  file.magic().header().record(0x04, channel).record(0x77, Composer().text("a new record"));
  file.chunk(1, 1, Composer().record(0x90, Composer().text("private")).message(1, 1, "x")).end();
  const auto reader = open_composed(file);
  const Pass pass = pass_over(*reader);
  EXPECT_TRUE(pass.end) << to_string(pass.end.errors());
  EXPECT_EQ(pass.messages, (std::vector<Seen>{{"/a", 0, 1, "x"}}));
}

TEST(McapReader, SkipsFieldsThatItDoesNotKnowInEveryRecord) {
  constexpr std::string_view more = "new fields";
  const auto definitions =
      Composer()
          .record(0x03, Composer().put(std::uint16_t{1}).text("T").text("e").text("d").raw(bytes_of(more)))
          .record(0x04, Composer()
                            .put(std::uint16_t{1})
                            .put(std::uint16_t{1})
                            .text("/a")
                            .text("text")
                            .put(std::uint32_t{0})
                            .raw(bytes_of(more)));
  Composer file;
  file.magic().record(0x01, Composer().text("p").text("l").raw(bytes_of(more))).raw(definitions.bytes);
  const std::uint64_t chunk = file.bytes.size();
  const Composer records = Composer().message(1, 5, "x");
  Composer body;
  body.put(std::uint64_t{5}).put(std::uint64_t{5}).put(std::uint64_t{records.bytes.size()}).put(std::uint32_t{0});
  body.text("").put(std::uint64_t{records.bytes.size()}).raw(records.bytes).raw(bytes_of(more));
  file.record(0x06, body);
  const std::uint64_t chunk_length = file.bytes.size() - chunk;
  file.record(0x07, Composer().put(std::uint16_t{1}).put(std::uint32_t{0}).raw(bytes_of(more)));
  const std::uint64_t index_length = file.bytes.size() - chunk - chunk_length;
  const std::uint64_t attachment = file.bytes.size();
  Composer attached = Composer().put(std::uint64_t{1}).put(std::uint64_t{2}).text("n").text("t");
  attached.put(std::uint64_t{3}).raw(bytes_of("abc")).put(std::uint32_t{0}).raw(bytes_of(more));
  file.record(0x09, attached);
  const std::uint64_t metadata = file.bytes.size();
  file.record(0x0c, Composer().text("m").put(std::uint32_t{0}).raw(bytes_of(more)));
  const std::uint64_t end = file.bytes.size();
  file.record(0x0f, Composer().put(std::uint32_t{0}));
  const std::uint64_t summary = file.bytes.size();
  file.raw(definitions.bytes);
  file.record(0x0b, Composer()
                        .put(std::uint64_t{1})
                        .put(std::uint16_t{1})
                        .put(std::uint32_t{1})
                        .put(std::uint32_t{1})
                        .put(std::uint32_t{1})
                        .put(std::uint32_t{1})
                        .put(std::uint64_t{5})
                        .put(std::uint64_t{5})
                        .put(std::uint32_t{10})
                        .put(std::uint16_t{1})
                        .put(std::uint64_t{1})
                        .raw(bytes_of(more)));
  file.record(0x08, Composer()
                        .put(std::uint64_t{5})
                        .put(std::uint64_t{5})
                        .put(chunk)
                        .put(chunk_length)
                        .put(std::uint32_t{0})
                        .put(index_length)
                        .text("")
                        .put(std::uint64_t{records.bytes.size()})
                        .put(std::uint64_t{records.bytes.size()})
                        .raw(bytes_of(more)));
  file.record(0x0a, Composer()
                        .put(attachment)
                        .put(metadata - attachment)
                        .put(std::uint64_t{1})
                        .put(std::uint64_t{2})
                        .put(std::uint64_t{3})
                        .text("n")
                        .text("t")
                        .raw(bytes_of(more)));
  file.record(0x0d, Composer().put(metadata).put(end - metadata).text("m").raw(bytes_of(more)));
  file.record(0x0e, Composer().put(std::uint8_t{3}).put(summary).put(std::uint64_t{1}).raw(bytes_of(more)));
  file.record(0x7f, Composer().text("a record of a later version"));
  file.record(0x02, Composer().put(summary).put(std::uint64_t{0}).put(std::uint32_t{0})).magic();

  for (const auto opening : {mcap::Opening::walk, mcap::Opening::by_summary}) {
    const auto reader = open_composed(file, {.opening = opening});
    EXPECT_EQ(reader->opened_by_summary(), opening == mcap::Opening::by_summary);
    EXPECT_TRUE(reader->damage().empty()) << to_string(reader->damage());
    EXPECT_EQ(reader->profile() + reader->library(), "pl");
    EXPECT_EQ(reader->schemas().at(1), (mcap::Schema{1, "T", "e", "d"}));
    EXPECT_EQ(reader->channels().at(1), (mcap::Channel{1, 1, "/a", "text", {}}));
    ASSERT_EQ(reader->chunks().size(), 1u);
    EXPECT_EQ(reader->chunks()[0].size, records.bytes.size());
    ASSERT_EQ(reader->attachments().size(), 1u);
    EXPECT_EQ(text_of(reader->attachments()[0].data), "abc");
    ASSERT_EQ(reader->metadata().size(), 1u);
    EXPECT_EQ(reader->metadata()[0].name, "m");
    EXPECT_EQ(reader->statistics().value().channel_message_counts.at(1), 1u);
    const Pass pass = pass_over(*reader);
    EXPECT_TRUE(pass.end) << to_string(pass.end.errors());
    EXPECT_EQ(pass.messages, (std::vector<Seen>{{"/a", 0, 5, "x"}}));
  }
}

TEST(McapReader, ReadsTheSmallestFile) {
  Composer file;
  file.magic().header().footer();  // a DataEnd may be missing then
  const auto reader = open_composed(file);
  EXPECT_TRUE(reader->damage().empty()) << to_string(reader->damage());
  EXPECT_TRUE(pass_over(*reader).messages.empty());
}

TEST(McapReader, WalksEveryRecordAndThoseInChunks) {
  const TempFile file;
  write_small_file(file.path());
  std::map<int, int> count;
  for_each_record(file.read(), [&](const mcap::Record& record) { return ++count[record.opcode], true; });
  const std::map<int, int> expected{{0x01, 1}, {0x02, 1}, {0x03, 2}, {0x04, 4}, {0x05, 5},
                                    {0x06, 3}, {0x07, 3}, {0x08, 3}, {0x09, 1}, {0x0a, 1},
                                    {0x0b, 1}, {0x0c, 1}, {0x0d, 1}, {0x0e, 6}, {0x0f, 1}};
  EXPECT_EQ(count, expected);
}

TEST(McapReader, RefusesWhatIsNoFile) {
  const auto missing = mcap::Reader::open("/nonexistent/a.mcap");
  ASSERT_FALSE(missing);
  EXPECT_EQ(to_string(missing.errors()[0]),
            "/nonexistent/a.mcap: error: can't read the trace: No such file or directory");
  const auto directory = mcap::Reader::open("/");
  ASSERT_FALSE(directory);
  EXPECT_THAT(directory.errors()[0].message, HasSubstr("it is a directory"));
}
