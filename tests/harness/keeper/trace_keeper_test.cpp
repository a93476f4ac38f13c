// Recordings that another process writes: here the parent's side is a thread of the same process.
#include "core/keeper/trace_keeper.h"

#include <gmock/gmock.h>
#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include "../mcap/mcap_files.h"
#include "core/keeper/remote_writer.h"
#include "core/trace/run_facts.h"

namespace rehearse {
namespace {

using test::Buffer;
using test::TempFile;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class Kept : public ::testing::Test {
 protected:
  Kept() { send_recordings_through(ring_); }

  static std::unique_ptr<mcap::Writer> create(const std::filesystem::path& file) {
    return std::move(create_recording(file)->writer);
  }

  Ring& ring_ = *Ring::create();
  TraceKeeper keeper_{ring_};
};

Buffer tick_message(std::int64_t tick) {
  CdrWriter cdr;
  msg::Tick message;
  message.tick = tick;
  msg::encode(message, cdr);
  return {cdr.bytes().begin(), cdr.bytes().end()};
}

/// All kinds of calls.
void write_everything(mcap::Writer& writer) {
  const auto schema = writer.add_schema("a/msg/A", "ros2msg", "float64 x\n");
  EXPECT_EQ(writer.add_schema("a/msg/A", "ros2msg", "float64 x\n"), schema);
  const auto numbers = writer.add_channel(schema, "/numbers", "cdr", {{"unit", "rad"}});
  EXPECT_TRUE(writer.add_attachment("model.urdf", "application/xml", Buffer(6'000'000, std::byte{'m'}), 1, 2));
  EXPECT_TRUE(writer.add_metadata("facts", {{"seed", "1"}}));
  const auto pictures = writer.add_channel(0, "/pictures", "png", {}, mcap::pictures);
  for (std::uint64_t i = 0; i < 3000; ++i) {
    EXPECT_TRUE(writer.write(numbers, i * 1'000'000, i * 1'000'000, Buffer(i % 100, static_cast<std::byte>(i))));
    if (i % 100 != 0) continue;
    EXPECT_TRUE(writer.write_later(pictures, i * 1'000'000, i, 5000, Buffer(i, std::byte{'p'}),
                                   [](mcap::Bytes raw) { return Buffer(raw.rbegin(), raw.rend()); }));
  }
  EXPECT_TRUE(writer.write(numbers, 4'000'000'000, 0, Buffer(8), 77));
  EXPECT_TRUE(writer.close());
  EXPECT_TRUE(writer.close()) << "the result of the first";
}

TEST_F(Kept, HasTheBytesOfARecordingThatTheProcessWritesItself) {
  const TempFile sent, own;
  write_everything(*create(sent.path()));
  mcap::WriterOptions options;
  write_everything(**mcap::Writer::create(own.path(), options));
  EXPECT_TRUE(sent.read() == own.read());
}

TEST_F(Kept, HasTheChunksThatAreCopiedAndCountsTheirTicks) {
  const TempFile source, copy;
  const auto add_channel = [](mcap::Writer& writer) { return writer.add_channel(0, "/tick", "cdr"); };
  {
    auto writer = std::move(*mcap::Writer::create(source.path()));
    const auto ticks = add_channel(*writer);
    for (std::int64_t tick = 0; tick < 50; ++tick)
      ASSERT_TRUE(writer->write(ticks, static_cast<std::uint64_t>(tick) * 1000, 0, tick_message(tick)));
    ASSERT_TRUE(writer->close());
  }
  const auto reader = std::move(*mcap::Reader::open(source.path()));
  const auto writer = create(copy.path());
  add_channel(*writer);
  for (const mcap::Chunk& chunk : reader->chunks()) EXPECT_TRUE(writer->copy_chunk(*reader->stored_chunk(chunk)));
  keeper_.finish();
  keeper_.close_failed({"Rig/C", "controller 'Rig/C' crashed", 50, 0.05});
  const auto copied = *mcap::Reader::open(copy.path());
  EXPECT_THAT(copied->damage(), SizeIs(0));
  EXPECT_EQ(copied->statistics()->message_count, 50u);
  for (const mcap::Metadata& record : copied->metadata()) EXPECT_EQ(RunOutcome::of(record.values).ticks, 50);
}

TEST_F(Kept, IsClosedWithTheFailureAndTheTickThatWasUnderWay) {
  const TempFile file;
  const auto [writer, supervised] = std::move(*create_recording(file.path()));
  const auto ticks = writer->add_channel(0, "/tick", "cdr"), events = writer->add_channel(0, "/events", "cdr");
  supervised->add_metadata_at_failure("rehearse.devices_read", {{"Rig/Gyro", "Rig/C"}});
  for (std::int64_t tick = 0; tick < 3; ++tick) {
    {
      const PendingMessages pending(*supervised);
      ASSERT_TRUE(writer->write(ticks, static_cast<std::uint64_t>(tick) * 1000, 0, tick_message(100 + tick)));
    }
    if (tick < 2) {
      ASSERT_TRUE(writer->write(ticks, static_cast<std::uint64_t>(tick) * 1000, 0, tick_message(tick)));
    }
  }
  keeper_.finish();
  EXPECT_THAT(keeper_.close_failed({"Rig/C", "controller 'Rig/C' crashed", 2, 2e-6}),
              ElementsAre(HasSubstr("the trace up to there: " + file.path().string())));

  const auto reader = *mcap::Reader::open(file.path());
  EXPECT_THAT(reader->damage(), SizeIs(0));
  std::vector<std::int64_t> seen;
  std::vector<std::string> failures;
  ASSERT_TRUE(reader->for_each_message([&](const mcap::Message& message) {
    CdrReader cdr(message.data);
    msg::Tick tick;
    msg::Event event;
    if (message.channel->id == ticks && msg::decode(cdr, tick)) seen.push_back(tick.tick);
    if (message.channel->id == events && msg::decode(cdr, event)) failures.push_back(event.text);
    return true;
  }));
  EXPECT_THAT(seen, ElementsAre(0, 1, 102)) << "of the last tick the pending message";
  EXPECT_THAT(failures, ElementsAre("controller 'Rig/C' crashed"));
  std::map<std::string, mcap::StringMap> metadata;
  for (const mcap::Metadata& record : reader->metadata()) metadata[record.name] = record.values;
  EXPECT_EQ(metadata.at("rehearse.devices_read").at("Rig/Gyro"), "Rig/C");
  const RunOutcome outcome = RunOutcome::of(metadata.at(records::outcome));
  EXPECT_EQ(outcome.ticks, 3);
  EXPECT_FALSE(outcome.complete);
  EXPECT_EQ(outcome.failure, "controller 'Rig/C' crashed");
}

TEST_F(Kept, StatesThatAFileCanNotBeCreated) {
  const auto refused = create_recording("no/such/folder/t.mcap");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.errors()[0].file, "no/such/folder/t.mcap") << "as the user named it";
  EXPECT_THAT(refused.errors()[0].message, HasSubstr("No such file or directory"));
}

TEST_F(Kept, StatesAnErrorOfAnEarlierCall) {
  const auto writer = create("/dev/full");
  const auto channel = writer->add_channel(0, "/a", "text");
  Result<void> result;
  for (std::uint64_t i = 0; i < 100'000 && result; ++i) result = writer->write(channel, i * 1'000'000, 0, Buffer(1000));
  ASSERT_FALSE(result);
  EXPECT_THAT(result.errors()[0].message, HasSubstr("No space left on device"));
  EXPECT_FALSE(writer->close());
}

TEST_F(Kept, StatesThatSomethingElseDeletedTheFile) {
  const TempFile file;
  const auto writer = create(file.path());
  ASSERT_TRUE(writer->flush());
  std::filesystem::remove(file.path());
  const auto closed = writer->close();
  ASSERT_FALSE(closed);
  EXPECT_TRUE(writer->is_changed_by_others());
  EXPECT_THAT(closed.errors()[0].message, HasSubstr("something else has deleted the trace"));
}

}  // namespace
}  // namespace rehearse
