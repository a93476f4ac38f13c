#include "mcap_files.h"
#include "support/files.h"

#include <gmock/gmock.h>

#include <memory>
#include <thread>

using namespace rehearse;
using namespace rehearse::test;
using testing::HasSubstr;

namespace {

/// Start times of the file's chunks, in file order, with their compression.
std::vector<std::pair<std::uint64_t, std::string>> chunks_of(const TempFile& file) {
  std::vector<std::pair<std::uint64_t, std::string>> chunks;
  for_each_record(file.read(), [&](const mcap::Record& record) {
    if (record.opcode != 0x06) return true;
    std::uint64_t start = 0;
    std::memcpy(&start, record.body.data(), 8);
    std::uint32_t length = 0;
    std::memcpy(&length, record.body.data() + 28, 4);
    chunks.emplace_back(start, text_of(record.body.subspan(32, length)));
    return true;
  });
  return chunks;
}

}  // namespace

TEST(McapWriter, WritesTheSameBytesForTheSameCalls) {
  const TempFile a, b;
  write_small_file(a.path());
  write_small_file(b.path());
  EXPECT_EQ(a.read(), b.read());
}

TEST(McapWriter, WritesTheSameBytesHoweverLongItsQueueIs) {
  const TempFile a, b;
  const auto write = [](const TempFile& file, std::size_t queue_length) {
    mcap::WriterOptions options;
    options.chunk_size = 100;  // hundreds of chunks: the caller waits for the thread
    options.queue_length = queue_length;
    auto writer = std::move(*mcap::Writer::create(file.path(), options));
    const auto channel = writer->add_channel(0, "/a", "text");
    const auto picture = writer->add_channel(0, "/b", "text", {}, mcap::pictures);
    for (std::uint64_t i = 0; i < 1000; ++i) {
      ASSERT_TRUE(writer->write(i % 7 == 0 ? picture : channel, i, i, bytes_of("some bytes " + std::to_string(i))));
    }
    ASSERT_TRUE(writer->close());
  };
  write(a, 1);
  write(b, 1000);
  EXPECT_EQ(a.read(), b.read());
}

TEST(McapWriter, WritesTheSameBytesWhateverIsPutOff) {
  const auto write = [](const TempFile& file, std::uint64_t every) {
    mcap::WriterOptions options;
    options.chunk_span = 100;
    auto writer = std::move(*mcap::Writer::create(file.path(), options));
    const auto a = writer->add_channel(0, "/a", "text");
    const auto b = writer->add_channel(0, "/b", "text");
    for (std::uint64_t i = 0; i < 1000; ++i) {
      const std::string text = "bytes " + std::string(i % 13, 'x') + std::to_string(i);
      const auto channel = i % 5 == 0 ? b : a;
      if (every > 0 && i % every == 0) {
        const mcap::Bytes raw = bytes_of(text);
        ASSERT_TRUE(writer->write_later(channel, i, i + 7, 10, Buffer(raw.begin(), raw.end()),
                                        [](mcap::Bytes bytes) { return Buffer(bytes.begin(), bytes.end()); }));
      } else {
        ASSERT_TRUE(writer->write(channel, i, i + 7, bytes_of(text)));
      }
    }
    ASSERT_TRUE(writer->close());
  };
  const TempFile at_once, some_later, all_later;
  write(at_once, 0);
  write(some_later, 3);
  write(all_later, 1);
  EXPECT_EQ(some_later.read(), at_once.read());
  EXPECT_EQ(all_later.read(), at_once.read());
}

TEST(McapWriter, FindsItsFileAgainAfterAChangeOfTheWorkingFolder) {
  const TempFile file;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(file.path().parent_path());
  mcap::WriterOptions options;
  options.verified = true;
  auto writer = std::move(*mcap::Writer::create(file.path().filename(), options));
  std::filesystem::current_path("/");
  const auto closed = writer->close();
  std::filesystem::current_path(before);
  EXPECT_TRUE(closed) << to_string(closed.errors());
}

std::thread::id composing_thread;

TEST(McapWriter, ComposesWhatIsPutOffOnItsOwnThread) {
  const TempFile file;
  auto writer = std::move(*mcap::Writer::create(file.path()));
  const auto channel = writer->add_channel(0, "/a", "text");
  composing_thread = std::this_thread::get_id();
  ASSERT_TRUE(writer->write_later(channel, 0, 0, 10, Buffer(3), [](mcap::Bytes raw) {
    composing_thread = std::this_thread::get_id();
    return Buffer(raw.begin(), raw.end());
  }));
  ASSERT_TRUE(writer->flush());
  EXPECT_NE(composing_thread, std::this_thread::get_id());
  ASSERT_TRUE(writer->close());
}

TEST(McapWriter, FinishesAChunkWhenWhatItHoldsReachesItsSize) {
  const TempFile file;
  mcap::WriterOptions options;
  options.chunk_size = 1000;
  auto writer = std::move(*mcap::Writer::create(file.path(), options));
  const auto channel = writer->add_channel(0, "/a", "text");
  for (std::uint64_t i = 0; i < 5; ++i)
    ASSERT_TRUE(writer->write_later(channel, i, i, 490, {}, [](mcap::Bytes) { return Buffer(1); }));
  ASSERT_TRUE(writer->close());
  using Chunks = std::vector<std::pair<std::uint64_t, std::string>>;
  EXPECT_EQ(chunks_of(file), (Chunks{{0, "zstd"}, {2, "zstd"}, {4, "zstd"}}));
}

TEST(McapWriter, FinishesAChunkWhenItsSizeIsReached) {
  const TempFile file;
  mcap::WriterOptions options;
  options.chunk_size = 2 * (9 + 22 + 10);  // two messages of ten bytes
  auto writer = std::move(*mcap::Writer::create(file.path(), options));
  const auto channel = writer->add_channel(0, "/a", "text");
  for (std::uint64_t i = 0; i < 5; ++i) ASSERT_TRUE(writer->write(channel, i, i, bytes_of("0123456789")));
  ASSERT_TRUE(writer->close());
  using Chunks = std::vector<std::pair<std::uint64_t, std::string>>;
  EXPECT_EQ(chunks_of(file), (Chunks{{0, "zstd"}, {2, "zstd"}, {4, "zstd"}}));
}

TEST(McapWriter, FinishesEveryOldChunkWhenTimeGoesOn) {
  const TempFile file;
  mcap::WriterOptions options;
  options.chunk_span = 10;
  auto writer = std::move(*mcap::Writer::create(file.path(), options));
  const auto number = writer->add_channel(0, "/a", "text");
  const auto picture = writer->add_channel(0, "/b", "text", {}, mcap::pictures);
  ASSERT_TRUE(writer->write(picture, 0, 0, bytes_of("p")));
  ASSERT_TRUE(writer->write(number, 1, 1, bytes_of("n")));
  // The picture's chunk is 10 old now, though no picture comes.
  ASSERT_TRUE(writer->write(number, 10, 10, bytes_of("n")));
  ASSERT_TRUE(writer->write(number, 11, 11, bytes_of("n")));
  ASSERT_TRUE(writer->close());
  using Chunks = std::vector<std::pair<std::uint64_t, std::string>>;
  EXPECT_EQ(chunks_of(file), (Chunks{{0, ""}, {1, "zstd"}, {11, "zstd"}}));
}

TEST(McapWriter, IsReadableUpToTheLastFinishedChunkWhenItDies) {
  const TempFile file;
  {
    mcap::WriterOptions options;
    options.chunk_span = 10;
    auto writer = std::move(*mcap::Writer::create(file.path(), options));
    const auto channel = writer->add_channel(0, "/a", "text");
    ASSERT_TRUE(writer->write(channel, 0, 0, bytes_of("kept")));
    ASSERT_TRUE(writer->write(channel, 10, 10, bytes_of("lost: its chunk is open")));
  }
  auto reader = std::move(*mcap::Reader::open(file.path()));
  EXPECT_EQ(pass_over(*reader).messages, (std::vector<Seen>{{"/a", 0, 0, "kept"}}));
  ASSERT_EQ(reader->damage().size(), 1u);
  EXPECT_THAT(reader->damage()[0].message, HasSubstr("truncated at byte"));
}

TEST(McapWriter, FlushPutsOpenChunksIntoTheFile) {
  const TempFile file;
  auto writer = std::move(*mcap::Writer::create(file.path()));
  const auto channel = writer->add_channel(0, "/a", "text");
  ASSERT_TRUE(writer->write(channel, 0, 0, bytes_of("kept")));
  ASSERT_TRUE(writer->flush());
  auto reader = std::move(*mcap::Reader::open(file.path()));  // the writer still lives
  EXPECT_EQ(pass_over(*reader).messages.size(), 1u);
  ASSERT_TRUE(writer->close());
}

TEST(McapWriter, WritesTheSameBytesHoweverLittleOfTheIndexItHolds) {
  const auto bytes_with = [](std::size_t index_size, const std::filesystem::path& path) {
    mcap::WriterOptions options;
    options.index_size = index_size;
    write_small_file(path, options);
    return read_file(path);
  };
  const TempFile held, read_back;
  EXPECT_EQ(bytes_with(0, read_back.path()), bytes_with(1 << 20, held.path()));
  EXPECT_EQ(bytes_with(100, read_back.path()), bytes_with(1 << 20, held.path()));
}

TEST(McapWriter, HoldsTheIndexOfAFileThatItMayNotRead) {
  const TempFile file;
  file.write({});
  std::filesystem::permissions(file.path(), std::filesystem::perms::owner_write);
  const TempFile link;  // written through, not replaced
  std::filesystem::create_symlink(file.path(), link.path());
  mcap::WriterOptions options;
  options.index_size = 0;
  write_small_file(link.path(), options);
  std::filesystem::permissions(file.path(), std::filesystem::perms::owner_all);
  const auto reader = mcap::Reader::open(file.path());
  ASSERT_TRUE(reader) << to_string(reader.errors());
  EXPECT_TRUE((*reader)->damage().empty());
  EXPECT_EQ((*reader)->statistics()->chunk_count, 3u);
}

TEST(McapWriter, CountsSequencesPerChannel) {
  const TempFile file;
  write_small_file(file.path());
  auto reader = std::move(*mcap::Reader::open(file.path()));
  std::map<std::string, std::vector<std::uint32_t>> sequences;
  for (const Seen& seen : pass_over(*reader).messages) sequences[seen.topic].push_back(seen.sequence);
  EXPECT_EQ(sequences["/numbers"], (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(sequences["/pictures"], (std::vector<std::uint32_t>{0}));
}

TEST(McapWriter, KeepsTheNumberOfAMessageThatHasOne) {
  const TempFile file;
  auto writer = std::move(*mcap::Writer::create(file.path()));
  const auto channel = writer->add_channel(0, "/copied", "text");
  for (const std::uint32_t number : {7u, 9u, 0xffffffffu}) {
    ASSERT_TRUE(writer->write(channel, number, number, bytes_of("x"), number));
  }
  ASSERT_TRUE(writer->close());
  const Pass pass = pass_over(**mcap::Reader::open(file.path()));
  ASSERT_EQ(pass.messages.size(), 3u);
  for (const Seen& seen : pass.messages) EXPECT_EQ(seen.sequence, seen.log_time);
}

TEST(McapWriter, GivesEqualSchemasOneId) {
  const TempFile file;
  auto writer = std::move(*mcap::Writer::create(file.path()));
  const auto first = writer->add_schema("a/msg/A", "ros2msg", "bool a\n");
  EXPECT_EQ(writer->add_schema("a/msg/A", "ros2msg", "bool a\n"), first);
  EXPECT_NE(writer->add_schema("a/msg/A", "ros2msg", "bool b\n"), first);
  ASSERT_TRUE(writer->close());
}

TEST(McapWriter, GivesChannelsTheMetadataThatItsProfileDemands) {
  const TempFile file;
  write_small_file(file.path());
  auto reader = std::move(*mcap::Reader::open(file.path()));
  EXPECT_EQ(reader->profile(), "ros2");
  EXPECT_EQ(reader->channels().at(1).metadata, (mcap::StringMap{{"offered_qos_profiles", ""}, {"unit", "rad"}}));
}

TEST(McapWriter, SaysWhichFileItCannotCreate) {
  const auto writer = mcap::Writer::create("/nonexistent/a.mcap");
  ASSERT_FALSE(writer);
  EXPECT_EQ(to_string(writer.errors()[0]),
            "/nonexistent/a.mcap: error: can't create the trace: No such file or directory "
            "(make the folder /nonexistent first, or name another file with -o)");
}

// The replay of a log with other ticks writes there, whatever other processes do.
TEST(McapWriter, SharesADeviceThatKeepsNothing) {
  auto one = mcap::Writer::create("/dev/null"), other = mcap::Writer::create("/dev/null");
  EXPECT_TRUE(one.ok());
  EXPECT_TRUE(other.ok()) << to_string(other.errors());
}

TEST(McapWriter, TellsOfAFullDiskAtTheLatestWhenItCloses) {
  auto writer = std::move(*mcap::Writer::create("/dev/full"));
  const auto channel = writer->add_channel(0, "/a", "text");
  static_cast<void>(writer->write(channel, 0, 0, bytes_of("a")));
  const auto closed = writer->close();
  ASSERT_FALSE(closed);
  EXPECT_EQ(closed.errors()[0].file, "/dev/full");
  EXPECT_EQ(closed.errors()[0].message, "can't write the trace: No space left on device");
  EXPECT_FALSE(writer->close()) << "and says so again";
}

TEST(McapWriter, TellsOfAFullDiskWhileItIsWrittenTo) {
  mcap::WriterOptions options;
  options.chunk_size = 1;  // every message is a chunk
  auto writer = std::move(*mcap::Writer::create("/dev/full", options));
  const auto channel = writer->add_channel(0, "/a", "text");
  bool told = false;
  for (std::uint64_t i = 0; i < 1000 && !told; ++i) told = !writer->write(channel, i, i, bytes_of("a"));
  EXPECT_TRUE(told);
}
