// Parts of files, and merged files: messages are unchanged, and the output is valid.

#include <gmock/gmock.h>

#include "composer.h"
#include "core/mcap/examination.h"
#include "core/mcap/merge.h"
#include "core/trace/filter.h"
#include "mcap_files.h"

using namespace rehearse;
using namespace rehearse::test;
using testing::ElementsAre;
using testing::HasSubstr;

namespace {

struct Written {
  std::vector<Seen> messages;
  std::vector<std::string> topics, metadata, attachments;
  std::string profile;
};

Written read_back(const std::filesystem::path& file) {
  const auto examination = mcap::examine(file);
  for (const mcap::Finding& finding : examination->findings.list())
    EXPECT_EQ(finding.severity, Severity::note) << finding.message;
  auto reader = std::move(*mcap::Reader::open(file));
  const Pass pass = pass_over(*reader);
  EXPECT_TRUE(pass.end);
  Written written{pass.messages, {}, {}, {}, reader->profile()};
  for (const auto& [id, channel] : reader->channels()) written.topics.push_back(channel.topic);
  for (const auto& metadata : reader->metadata()) written.metadata.push_back(metadata.name);
  for (const auto& attachment : reader->attachments()) written.attachments.push_back(attachment.name);
  return written;
}

mcap::FilterOptions between(std::uint64_t from, std::uint64_t until) {
  mcap::FilterOptions options;
  options.selection.from = mcap::TimeBound{from, mcap::TimeOrigin::clock};
  options.selection.until = mcap::TimeBound{until, mcap::TimeOrigin::clock};
  return options;
}

class McapFilter : public testing::Test {
 protected:
  McapFilter() { write_small_file(source_.path()); }
  Written filter(const mcap::FilterOptions& options) {
    const auto filtered = mcap::filter(source_.path(), target_.path(), options);
    EXPECT_TRUE(filtered) << to_string(filtered.errors());
    return filtered ? read_back(target_.path()) : Written();
  }
  std::string refusal(const mcap::FilterOptions& options = {}) {
    const auto filtered = mcap::filter(source_.path(), target_.path(), options);
    EXPECT_FALSE(std::filesystem::exists(target_.path()));
    return filtered ? "" : to_string(filtered.errors());
  }
  const TempFile source_, target_;
};

}  // namespace

TEST_F(McapFilter, KeepsAllIfNothingElseIsSaid) {
  const Written written = filter({});
  EXPECT_EQ(written.messages.size(), 5u);
  EXPECT_THAT(written.topics, ElementsAre("/numbers", "/pictures"));
  EXPECT_THAT(written.metadata, ElementsAre("provenance"));
  EXPECT_THAT(written.attachments, ElementsAre("scenario.yaml"));
}

TEST_F(McapFilter, KeepsTheChosenTopics) {
  mcap::FilterOptions options;
  options.selection.topics = {"/num*"};
  const Written written = filter(options);
  EXPECT_EQ(written.messages.size(), 4u);
  EXPECT_THAT(written.topics, ElementsAre("/numbers"));
  EXPECT_THAT(written.metadata, ElementsAre("provenance", "rehearse.filter"));
  options.selection.topics.clear();
  options.exclude = {"/num*"};
  EXPECT_THAT(filter(options).topics, ElementsAre("/pictures"));
}

TEST_F(McapFilter, KeepsASpanOfTimeWithItsNumbers) {
  const Written written = filter(between(1000, 3000));
  EXPECT_EQ(written.messages, (std::vector<Seen>{{"/numbers", 1, 1000, "one"}, {"/numbers", 2, 2000, "two"}}));
  EXPECT_THAT(written.topics, ElementsAre("/numbers", "/pictures"));
}

TEST_F(McapFilter, KeepsPicturesApartFromNumbers) {
  filter({});
  std::vector<std::string> compressions;
  for_each_record(target_.read(), [&](const mcap::Record& record) {
    if (record.opcode != 6) return true;
    const auto body = text_of(record.body);
    compressions.push_back(body.substr(28, 4) == std::string(4, '\0') ? "none" : body.substr(32, 4));
    return true;
  });
  EXPECT_THAT(compressions, testing::UnorderedElementsAre("zstd", "none"));
}

TEST_F(McapFilter, WritesTheCompressionThatIsAskedFor) {
  for (const auto compression : {mcap::Compression::none, mcap::Compression::lz4, mcap::Compression::zstd}) {
    mcap::FilterOptions options;
    options.compression = compression;
    options.level = 3;
    options.chunk_size = 100;
    EXPECT_EQ(filter(options).messages.size(), 5u);
  }
}

TEST_F(McapFilter, LeavesAttachmentsAndMetadataOutIfItIsTold) {
  mcap::FilterOptions options;
  options.attachments = {};
  options.metadata = false;
  const Written written = filter(options);
  EXPECT_THAT(written.metadata, testing::IsEmpty());
  EXPECT_THAT(written.attachments, testing::IsEmpty());
}

/// For any damage of the source: no file is written, or a file without errors.
TEST_F(McapFilter, RefusesDamagedSources) {
  const Buffer whole = source_.read();
  for (std::size_t i = 0; i < whole.size(); ++i) {
    Buffer bytes = whole;
    bytes[i] ^= std::byte{0x55};
    source_.write(bytes);
    EXPECT_NE(refusal(), "") << "byte " << i;
    source_.write(mcap::Bytes(whole).first(i));
    EXPECT_NE(refusal(), "") << "cut at " << i;
  }
  EXPECT_THAT(refusal(), HasSubstr("rehearse recover makes a whole file"));
}

TEST_F(McapFilter, RefusesASpanWithoutMessages) {
  EXPECT_THAT(refusal(between(~std::uint64_t{0} - 1, ~std::uint64_t{0})), HasSubstr("nothing was recorded in the span"));
  mcap::FilterOptions empty = between(7, 8);
  empty.selection.from = mcap::TimeBound{1, mcap::TimeOrigin::first_message};
  empty.selection.until = mcap::TimeBound{2, mcap::TimeOrigin::first_message};
  EXPECT_THAT(refusal(empty), HasSubstr("nothing was recorded in the span"));
}

TEST_F(McapFilter, RefusesATopicThatIsNotThere) {
  mcap::FilterOptions options;
  options.selection.topics = {"/numbrs"};
  EXPECT_THAT(refusal(options), HasSubstr("no topic matches '/numbrs'"));
}

namespace {

/// Messages at these times on one topic, each with the text `word`.
void write_file(const std::filesystem::path& file, std::string_view topic, std::string_view word,
                const std::vector<std::uint64_t>& times, const std::string& profile = "ros2",
                std::string_view encoding = "cdr") {
  mcap::WriterOptions options;
  options.profile = profile;
  auto writer = std::move(*mcap::Writer::create(file, options));
  const auto channel = writer->add_channel(writer->add_schema("T", "ros2msg", "string text\n"), topic, encoding);
  for (const std::uint64_t time : times) ASSERT_TRUE(writer->write(channel, time, time, bytes_of(word)));
  ASSERT_TRUE(writer->add_metadata("origin", {{"word", std::string(word)}}));
  ASSERT_TRUE(writer->add_attachment("note.txt", "text/plain", bytes_of(word)));
  ASSERT_TRUE(writer->close());
}

std::vector<std::string> words(const Written& written) {
  std::vector<std::string> words;
  for (const Seen& seen : written.messages) words.push_back(std::to_string(seen.log_time) + seen.data);
  return words;
}

}  // namespace

TEST(McapMerge, GoesByTimeThenByTheOrderOfTheSources) {
  const TempFile a, b, target;
  write_file(a.path(), "/t", "a", {1, 3, 3, 5});
  write_file(b.path(), "/t", "b", {2, 3, 9});
  auto merged = mcap::merge({{b.path(), ""}, {a.path(), ""}}, target.path());
  ASSERT_TRUE(merged);
  EXPECT_EQ(merged->messages, 7u);
  EXPECT_EQ(merged->channels, 1u);
  const Written written = read_back(target.path());
  EXPECT_THAT(words(written), ElementsAre("1a", "2b", "3b", "3a", "3a", "5a", "9b"));
  EXPECT_THAT(written.metadata, ElementsAre("origin", "origin", "rehearse.merge"));
  EXPECT_THAT(written.attachments, ElementsAre("note.txt", "note.txt"));
  EXPECT_THAT(merged->remarks, ElementsAre(HasSubstr("'note.txt' occurs more than once"), HasSubstr("'origin'")));
}

TEST(McapMerge, KeepsApartWhatIsDefinedOtherwise) {
  const TempFile a, b, target;
  write_file(a.path(), "/t", "a", {1});
  write_file(b.path(), "/t", "b", {2}, "", "text");
  auto merged = mcap::merge({{a.path(), ""}, {b.path(), ""}}, target.path());
  ASSERT_TRUE(merged);
  EXPECT_EQ(merged->channels, 2u);
  EXPECT_THAT(merged->remarks[0], HasSubstr("'/t' has several definitions"));
  const Written written = read_back(target.path());
  EXPECT_EQ(written.profile, "") << "they have none in common";
  EXPECT_EQ(read_back(target.path()).messages.size(), 2u);
}

TEST(McapMerge, PutsPrefixesBeforeTopics) {
  const TempFile a, b, target;
  write_file(a.path(), "/t", "a", {1});
  write_file(b.path(), "/t", "b", {2});
  ASSERT_TRUE(mcap::merge({{a.path(), "/left"}, {b.path(), "/right"}}, target.path()));
  EXPECT_THAT(read_back(target.path()).topics, ElementsAre("/left/t", "/right/t"));
  ASSERT_TRUE(mcap::merge({{a.path(), ""}, {b.path(), ""}}, target.path(), {.keep_apart = true, .progress = {}}));
  EXPECT_THAT(read_back(target.path()).topics, ElementsAre("/t", "/t"));
}

TEST(McapMerge, RefusesDamagedSourcesAndItsOwnTarget) {
  const TempFile a, b;
  write_file(a.path(), "/t", "a", {1});
  write_file(b.path(), "/t", "b", {2});
  const Buffer whole = b.read();
  EXPECT_FALSE(mcap::merge({{a.path(), ""}, {b.path(), ""}}, b.path()));
  EXPECT_EQ(b.read(), whole);
  for (std::size_t i = 0; i < whole.size(); i += 3) {
    const TempFile target;
    Buffer bytes = whole;
    bytes[i] ^= std::byte{0x55};
    b.write(bytes);
    EXPECT_FALSE(mcap::merge({{a.path(), ""}, {b.path(), ""}}, target.path())) << "byte " << i;
    EXPECT_FALSE(std::filesystem::exists(target.path()));
  }
}

TEST(McapCopies, StateThePrivateRecordsThatTheyDoNotKeep) {
  const TempFile source, target;
  Composer file;
  file.magic().header().record(0x80, Composer().text("mine")).channel(1, "/a");
  file.message(1, 5, "x").record(0xff, Composer().text("mine")).end();
  write_bytes(source.path(), file.bytes);
  const std::string remark = "2 private records of " + source.path().string() + " aren't kept";
  const auto filtered = mcap::filter(source.path(), target.path(), {});
  ASSERT_TRUE(filtered) << to_string(filtered.errors());
  EXPECT_THAT(filtered->remarks, ElementsAre(HasSubstr(remark)));
  const auto merged = mcap::merge({{source.path(), ""}}, target.path());
  ASSERT_TRUE(merged) << to_string(merged.errors());
  EXPECT_THAT(merged->remarks, ElementsAre(HasSubstr(remark)));
  const auto again = mcap::filter(target.path(), source.path(), {});
  ASSERT_TRUE(again) << to_string(again.errors());
  EXPECT_TRUE(again->remarks.empty());
}
