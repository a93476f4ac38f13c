// The doctor: it finds no error in files of Rehearse's Writer, and finds each error in damaged files at its place.

#include <gmock/gmock.h>

#include "core/mcap/examination.h"
#include "file_forms.h"
#include "mcap_files.h"

using namespace rehearse;
using namespace rehearse::test;
using testing::HasSubstr;
using testing::IsEmpty;

namespace {

std::string findings_text(const mcap::Findings& findings) {
  std::string text;
  for (const mcap::Finding& finding : findings.list()) {
    text += std::to_string(finding.place.offset);
    if (finding.place.inside) text += "+" + std::to_string(*finding.place.inside);
    text += ": " + std::string(to_string(finding.severity)) + ": " + finding.message + "\n";
  }
  return text;
}

mcap::Examination examined(mcap::Bytes bytes) { return mcap::examine_view(mcap::FileView(), bytes, {}); }

std::string findings_of(const Buffer& bytes) { return findings_text(examined(bytes).findings); }

std::string findings_of(const Composer& file) { return findings_of(file.bytes); }

/// The findings without the notes that every hand-made file causes.
std::string errors_of(const Composer& file) {
  const mcap::Examination examination = examined(file.bytes);
  std::string text;
  for (const mcap::Finding& finding : examination.findings.list())
    if (finding.severity == Severity::error)
      text += std::to_string(finding.place.offset) + ": " + finding.message + "\n";
  return text;
}

Composer begin() {
  Composer file;
  file.magic().header();
  return file;
}

Composer schema_body(std::uint16_t id, std::string_view name, std::string_view encoding = "ros2msg",
                     std::string_view data = "") {
  return Composer().put(id).text(name).text(encoding).text(data);
}

Composer index_body(std::uint16_t channel, const std::vector<std::pair<std::uint64_t, std::uint64_t>>& entries) {
  Composer body;
  body.put(channel).put(static_cast<std::uint32_t>(entries.size() * 16));
  for (const auto& [time, offset] : entries) body.put(time).put(offset);
  return body;
}

/// DataEnd, a summary of these records, the Footer.
Composer& end_with(Composer& file, const Composer& summary) {
  file.record(0x0f, Composer().put(std::uint32_t{0}));
  const std::uint64_t start = file.bytes.size();
  file.raw(summary.bytes);
  file.record(0x02, Composer().put(start).put(std::uint64_t{0}).put(std::uint32_t{0}));
  return file.magic();
}

}  // namespace

TEST(McapDoctor, FindsNothingWrongWithWholeFiles) {
  EXPECT_EQ(findings_of(small_file()), "");
  EXPECT_EQ(findings_of(in_form(small_file(), {.chunks = false})), "");
  EXPECT_EQ(
      findings_of(in_form(small_file(), {.definitions_in_chunks = true, .message_indexes = false, .summary = false})),
      "");
}

/// Any flipped bit is found: a CRC, or an index entry, no longer matches.
TEST(McapDoctor, FindsEveryFlippedBit) {
  const Buffer whole = small_file();
  Buffer bytes = whole;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (const int bit : {0, 3, 7}) {
      bytes[i] ^= std::byte{1} << bit;
      EXPECT_TRUE(examined(bytes).findings.has_error()) << "bit " << bit << " of byte " << i;
      bytes[i] = whole[i];
    }
  }
}

TEST(McapDoctor, FindsEveryCut) {
  const Buffer whole = small_file();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_TRUE(examined(mcap::Bytes(whole).first(size)).findings.has_error()) << "cut at byte " << size;
  }
}

TEST(McapDoctor, RefusesWhatIsNoMcapFile) {
  const TempFile file;
  file.write(bytes_of("a text"));
  const auto examination = mcap::examine(file.path());
  ASSERT_FALSE(examination);
  EXPECT_THAT(to_string(examination.errors()), HasSubstr(": error: not an MCAP file"));
}

TEST(McapDoctor, NamesWhatIsWrongWithTheFrame) {
  EXPECT_EQ(errors_of(begin().end()), "");
  Composer headless;
  headless.magic().channel(1, "/a").end();
  EXPECT_EQ(errors_of(headless), "8: the first record is no Header, but a Channel\n");
  Composer twice = begin();
  const std::string second = std::to_string(twice.bytes.size());
  EXPECT_EQ(errors_of(twice.header().end()), second + ": a second Header\n");
  Composer endless = begin();
  EXPECT_THAT(errors_of(endless), HasSubstr(": truncated: the file ends there, without Data End and Footer"));
  Composer without_data_end = begin();
  EXPECT_THAT(errors_of(without_data_end.footer()), HasSubstr("no Data End before the Footer"));
  Composer longer = begin();
  longer.end();
  EXPECT_THAT(errors_of(longer.raw(bytes_of("more"))), HasSubstr("4 bytes after the end of the file"));
  Composer zeros = begin();
  zeros.bytes.resize(zeros.bytes.size() + 100);
  EXPECT_THAT(errors_of(zeros), HasSubstr("zeros only"));
}

TEST(McapDoctor, NamesWhatIsWrongWithDefinitions) {
  EXPECT_THAT(errors_of(begin().record(3, schema_body(0, "T")).end()), HasSubstr("the Schema 'T' has the id 0"));
  EXPECT_THAT(errors_of(begin().record(3, schema_body(1, "T")).record(3, schema_body(1, "U")).end()),
              HasSubstr("Schema 1 differs from its definition at byte"));
  EXPECT_THAT(errors_of(begin().record(3, schema_body(1, "T", "", "data")).end()),
              HasSubstr("has data but no encoding"));
  EXPECT_THAT(findings_of(begin().record(3, schema_body(1, "")).end()),
              HasSubstr("note: deviations from the specification that harm no reader: Schema 1 has no name"));
  EXPECT_THAT(errors_of(begin().channel(1, "/a").channel(1, "/b").end()),
              HasSubstr("Channel 1 differs from its definition at byte"));
  const Composer of_schema_7 = Composer().put(std::uint16_t{1}).put(std::uint16_t{7}).text("/a").text("cdr").put(0u);
  EXPECT_THAT(errors_of(begin().record(4, of_schema_7).end()),
              HasSubstr("Channel 1 '/a' is of Schema 7, which isn't defined before it"));
  EXPECT_THAT(errors_of(begin().record(3, schema_body(1, "\xff")).end()),
              HasSubstr("the Schema: its name '?' is not UTF-8"));
  const Composer map = Composer().text("k").text("1").text("k").text("2");
  const Composer keys = Composer().text("m").put(static_cast<std::uint32_t>(map.bytes.size())).raw(map.bytes);
  EXPECT_THAT(errors_of(begin().record(0x0c, keys).end()), HasSubstr("has the key 'k' more than once"));
  EXPECT_THAT(errors_of(begin().record(3, Composer().put(std::uint16_t{1}).put(~0u)).end()),
              HasSubstr("the Schema is shorter than its fields state: it has 6 bytes"));
}

TEST(McapDoctor, NamesWhatIsWrongWithMessages) {
  EXPECT_THAT(errors_of(begin().message(9, 1, "x").channel(9, "/late").end()),
              HasSubstr("a Message of channel 9, which isn't defined before it"));
  const std::string back = findings_of(begin().channel(1, "/a").message(1, 5, "x").message(1, 3, "y").end());
  EXPECT_THAT(
      back,
      HasSubstr("warning: Channel 1 '/a': the log time goes back from here on, in 1 of 2 messages, by up to 2 ns"));
  EXPECT_THAT(findings_of(begin().record(0x42, Composer().text("x")).end()),
              HasSubstr("that harm no reader: a record of opcode 0x42, which version 0 doesn't define"));
  EXPECT_THAT(findings_of(begin().record(0x93, Composer().text("x")).end()), Not(HasSubstr("0x93")));
}

TEST(McapDoctor, NamesWhatIsWrongWithChunks) {
  const Composer message = Composer().message(1, 5, "x");
  const auto of = [&](std::uint64_t start, std::uint64_t end, const Composer& records,
                      std::string_view compression = "", std::optional<std::uint64_t> size = {},
                      std::uint32_t crc = 0) {
    return errors_of(begin().channel(1, "/a").chunk(start, end, records, compression, size, crc).end());
  };
  EXPECT_EQ(of(5, 5, message), "");
  EXPECT_THAT(of(5, 6, message), HasSubstr("states messages from 5 ns to 6 ns, but they are from 5 ns to 5 ns"));
  EXPECT_THAT(of(5, 5, message, "", {}, 1), HasSubstr("the CRC of the Chunk doesn't match"));
  EXPECT_THAT(of(5, 5, message, "brotli"), HasSubstr("its compression \"brotli\""));
  EXPECT_THAT(of(5, 5, message, "", 7), HasSubstr("can't be decompressed"));
  EXPECT_THAT(of(5, 5, message, "zstd", std::uint64_t{1} << 40), HasSubstr("more than the limit of"));
  EXPECT_THAT(of(0, 0, Composer().record(0x0c, Composer().text("m").put(0u))),
              HasSubstr("a Metadata isn't allowed in a Chunk"));
  EXPECT_THAT(of(0, 0, Composer().chunk(0, 0, Composer())), HasSubstr("a Chunk isn't allowed in a Chunk"));
  EXPECT_THAT(of(5, 5, Composer().message(1, 5, "x").put(std::uint8_t{5})), HasSubstr("aren't whole from there on"));
}

TEST(McapDoctor, ComparesMessageIndexesWithTheirChunk) {
  const Composer records = Composer().message(1, 5, "x").message(1, 6, "y");
  const std::uint64_t second = Composer().message(1, 5, "x").bytes.size();
  const auto of = [&](const Composer& indexes) {
    return errors_of(begin().channel(1, "/a").channel(2, "/b").chunk(5, 6, records).raw(indexes.bytes).end());
  };
  EXPECT_EQ(of(Composer()), "");
  EXPECT_EQ(of(Composer().record(7, index_body(1, {{5, 0}, {6, second}}))), "");
  EXPECT_EQ(of(Composer().record(7, index_body(1, {{6, second}, {5, 0}}))), "");  // in any order
  EXPECT_THAT(of(Composer().record(7, index_body(1, {{5, 0}}))), HasSubstr("lacks the message at byte"));
  EXPECT_THAT(of(Composer().record(7, index_body(1, {{5, 0}, {7, second}}))),
              HasSubstr("has the stated time 7 ns and the actual time 6 ns"));
  EXPECT_THAT(of(Composer().record(7, index_body(1, {{5, 0}, {6, 3}}))),
              HasSubstr("or no message of that channel is there"));
  EXPECT_THAT(of(Composer().record(7, index_body(2, {}))),
              HasSubstr("has messages of channel 1, but no Message Index"));
  EXPECT_THAT(
      of(Composer().record(7, index_body(1, {{5, 0}, {6, second}})).record(7, index_body(1, {{5, 0}, {6, second}}))),
      HasSubstr("a second Message Index of channel 1"));
  EXPECT_THAT(errors_of(begin().channel(1, "/a").record(7, index_body(1, {})).end()),
              HasSubstr("a Message Index that doesn't follow a Chunk"));
}

TEST(McapDoctor, ComparesTheSummaryWithTheData) {
  const auto of = [](const Composer& summary) {
    Composer file = begin();
    file.channel(1, "/a").message(1, 5, "x");
    return errors_of(end_with(file, summary));
  };
  const auto statistics = [](std::uint64_t messages, std::uint64_t count) {
    return Composer().record(0x0b, Composer()
                                       .put(messages)
                                       .put(std::uint16_t{0})
                                       .put(1u)
                                       .put(0u)
                                       .put(0u)
                                       .put(0u)
                                       .put(std::uint64_t{5})
                                       .put(std::uint64_t{5})
                                       .put(10u)
                                       .put(std::uint16_t{1})
                                       .put(count));
  };
  const Composer channel = Composer().channel(1, "/a");
  EXPECT_EQ(of(Composer().raw(channel.bytes).raw(statistics(1, 1).bytes)), "");
  EXPECT_THAT(of(Composer().raw(channel.bytes).raw(statistics(2, 1).bytes)),
              HasSubstr("the record of statistics states: messages 2 in place of 1"));
  EXPECT_THAT(of(Composer().raw(channel.bytes).raw(statistics(1, 3).bytes)),
              HasSubstr("messages of channel 1 3 in place of 1"));
  EXPECT_THAT(of(Composer().channel(1, "/b")), HasSubstr("Channel 1 differs from its definition at byte"));
  EXPECT_THAT(of(Composer().message(1, 5, "x")), HasSubstr("a Message isn't allowed in the summary"));
  const Composer nowhere = Composer().record(0x0a, Composer()
                                                       .put(std::uint64_t{3})
                                                       .put(std::uint64_t{4})
                                                       .put(std::uint64_t{0})
                                                       .put(std::uint64_t{0})
                                                       .put(std::uint64_t{0})
                                                       .text("")
                                                       .text(""));
  EXPECT_THAT(of(nowhere), HasSubstr("an index of byte 3, where no Attachment record begins"));
}

/// One note lists them all: a reader gets the same data.
TEST(McapDoctor, ListsHarmlessDeviationsInOneNote) {
  Composer file = begin();
  file.record(3, schema_body(1, "")).channel(1, "/a").message(1, 5, "x");
  end_with(file, Composer().channel(1, "/a").record(3, schema_body(1, "")).channel(2, "/b"));
  EXPECT_THAT(findings_of(file),
              testing::EndsWith(": note: deviations from the specification that harm no reader: Schema 1 has no name; "
                                "the summary isn't grouped: a Channel after records of other kinds; the summary has "
                                "Channel 2, but the data section doesn't\n"));
  EXPECT_EQ(errors_of(file), "");
  Composer many = begin();
  for (std::uint16_t i = 1; i <= 15; ++i) many.record(3, schema_body(i, ""));
  EXPECT_THAT(findings_of(many.end()), HasSubstr("Schema 10 has no name; and 5 more"));
}

TEST(McapDoctor, GoesOnBehindDamage) {
  Buffer bytes = small_file();
  const auto at = find_text(bytes, "scenario.yaml");
  std::fill(at - 40, at + 4, std::byte{0});  // the attachment's head, and the bytes before it
  const std::string found = findings_of(bytes);
  EXPECT_THAT(found, HasSubstr("the bytes there are no record; the next record begins at byte"));
  EXPECT_EQ(examined(bytes).messages, 5u);  // all messages are behind the damage
}

TEST(McapDoctor, KeepsItsListShort) {
  Composer file = begin();
  for (int i = 0; i < 5000; ++i) file.message(9, 1, "x");
  const mcap::Examination examination = examined(file.end().bytes);
  EXPECT_EQ(examination.findings.count(Severity::error), 5000u);
  EXPECT_LE(examination.findings.list().size(), 1002u);
}
