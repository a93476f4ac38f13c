#include "mcap_files.h"

#include <gmock/gmock.h>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <algorithm>
#include <cstdlib>
#include <thread>
#include <utility>

using namespace rehearse;
using namespace rehearse::test;
using testing::HasSubstr;

namespace {

/// Gives bytes in pieces of this size.
mcap::ReadBytes in_pieces(Buffer bytes, std::size_t piece) {
  return [bytes = std::move(bytes), piece, at = std::size_t{0}](std::span<std::byte> target) mutable {
    const std::size_t count = std::min({piece, target.size(), bytes.size() - at});
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), count, target.begin());
    at += count;
    return Result<std::size_t>(count);
  };
}

std::unique_ptr<mcap::StreamReader> stream_of(const Buffer& bytes, std::size_t piece = 7,
                                              mcap::ReaderOptions options = {}) {
  auto stream = mcap::StreamReader::open_source(in_pieces(bytes, piece), "composed.mcap", options);
  EXPECT_TRUE(stream) << (stream ? "" : to_string(stream.errors()));
  return std::move(*stream);
}

Pass pass_over(mcap::StreamReader& stream) {
  Pass pass;
  pass.end = stream.for_each_message([&](const mcap::Message& message) {
    pass.messages.push_back(see(message));
    return true;
  });
  return pass;
}

/// All errors, one per line, sorted.
std::vector<std::string> complaints(const Result<void>& end) {
  std::vector<std::string> lines;
  for (const Diagnostic& diagnostic : end.errors()) lines.push_back(to_string(diagnostic));
  std::stable_sort(lines.begin(), lines.end());
  return lines;
}

/// The stream delivers the same for these bytes as the reader of files.
void expect_the_same_as_of_a_file(const Buffer& bytes, const std::string& what) {
  auto reader = mcap::Reader::open_bytes(bytes, "composed.mcap");
  auto stream = mcap::StreamReader::open_source(in_pieces(bytes, 100), "composed.mcap");
  ASSERT_EQ(reader.ok(), stream.ok()) << what;
  if (!reader) {
    EXPECT_EQ(to_string(reader.errors()), to_string(stream.errors())) << what;
    return;
  }
  const Pass of_file = rehearse::test::pass_over(**reader);
  const Pass of_stream = pass_over(**stream);
  EXPECT_EQ(of_stream.messages, of_file.messages) << what;
  EXPECT_EQ(complaints(of_stream.end), complaints(of_file.end)) << what;
}

}  // namespace

TEST(McapStream, ReadsWhateverThePieces) {
  const Buffer bytes = small_file();
  const auto reader = std::move(*mcap::Reader::open_bytes(bytes, "a"));
  const auto expected = pass_over(*reader).messages;
  for (const std::size_t piece : {1u, 2u, 13u, 4096u, 1u << 20}) {
    const auto stream = stream_of(bytes, piece);
    const Pass pass = pass_over(*stream);
    EXPECT_TRUE(pass.end) << to_string(pass.end.errors());
    EXPECT_EQ(pass.messages, expected) << "in pieces of " << piece;
    EXPECT_EQ(stream->statistics().value().message_count, 5u) << "from the summary, the last part of the file";
  }
}

TEST(McapStream, LearnsNothingFromASummaryThatIsNotWhatWasWritten) {
  Buffer bytes = small_file();
  auto repeated = find_text(bytes, "test/msg/Text");  // in the data section
  repeated = std::search(repeated + 1, bytes.end(), repeated, repeated + 13);
  ASSERT_NE(repeated, bytes.end());
  *(repeated - 6) = std::byte{9};  // the schema's id in the summary
  const auto stream = stream_of(bytes);
  EXPECT_FALSE(pass_over(*stream).end);
  EXPECT_EQ(stream->schemas().size(), 1u);
  EXPECT_FALSE(stream->statistics());
}

TEST(McapStream, StopsWhenItIsToldTo) {
  int count = 0;
  EXPECT_TRUE(stream_of(small_file())->for_each_message([&](const mcap::Message&) { return ++count < 2; }));
  EXPECT_EQ(count, 2);
}

TEST(McapStream, SaysTheSameOfAFileThatIsCutAnywhere) {
  const Buffer whole = small_file();
  for (std::size_t size = 0; size < whole.size(); ++size)
    expect_the_same_as_of_a_file({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)},
                                 "cut at byte " + std::to_string(size));
}

TEST(McapStream, SaysTheSameOfAnyFlippedBit) {
  Buffer bytes = small_file();
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::byte before = bytes[i];
    for (int bit = 0; bit < 8; ++bit) {
      bytes[i] = before ^ (std::byte{1} << bit);
      const auto reader = mcap::Reader::open_bytes(bytes, "a");
      const auto stream = mcap::StreamReader::open_source(in_pieces(bytes, 100), "a");
      ASSERT_EQ(reader.ok(), stream.ok());
      if (!reader) continue;
      const Pass pass = pass_over(**stream);
      EXPECT_FALSE(pass.end) << "bit " << bit << " of byte " << i << " of " << bytes.size();
    }
    bytes[i] = before;
  }
}

TEST(McapStream, SaysTheSameOfDamage) {
  Composer zeros;
  zeros.magic().header().channel(1, "/a").message(1, 1, "x").bytes.resize(1000);
  expect_the_same_as_of_a_file(zeros.bytes, "zeros");
  Composer length;
  length.magic().header().put(std::uint8_t{5}).put(std::uint64_t{1} << 60).end();
  expect_the_same_as_of_a_file(length.bytes, "a length that fits nowhere");
  Composer more = Composer().magic().header().end();
  more.text("more");
  expect_the_same_as_of_a_file(more.bytes, "more behind the end");
  expect_the_same_as_of_a_file(Composer().magic().header().footer().bytes, "no DataEnd");
  expect_the_same_as_of_a_file(Composer().magic().message(9, 1, "x").end().bytes, "neither header nor channel");
  expect_the_same_as_of_a_file(
      Composer().magic().header().chunk(0, 0, Composer().text("?"), "zstd", std::uint64_t{1} << 40).end().bytes,
      "a huge chunk");
}

TEST(McapStream, LeavesOutAMessageWhoseChannelComesBehindIt) {
  const Composer file = Composer().magic().header().message(1, 1, "early").channel(1, "/a").message(1, 2, "x").end();
  const Pass pass = pass_over(*stream_of(file.bytes));
  EXPECT_EQ(pass.messages, (std::vector<Seen>{{"/a", 0, 2, "x"}}));
  ASSERT_FALSE(pass.end);
  EXPECT_THAT(pass.end.errors()[0].message, HasSubstr("is of channel 1, which isn't defined"));
}

TEST(McapStream, LeavesOutARecordThatIsTooLargeToHold) {
  const std::string large(100'000, 'x');
  const Composer file = Composer().magic().header().channel(1, "/a").message(1, 1, large).message(1, 2, "x").end();
  const Pass pass = pass_over(*stream_of(file.bytes, 1000, {.max_chunk_size = 10'000}));
  EXPECT_EQ(pass.messages, (std::vector<Seen>{{"/a", 0, 2, "x"}}));
  ASSERT_FALSE(pass.end);
  EXPECT_THAT(to_string(pass.end.errors()),
              HasSubstr("it has 100022 bytes, more than the limit of 10000 for a stream"));
}

TEST(McapStream, TakesNoMemoryForWhatDoesNotCome) {
  Composer file = Composer().magic().header();
  const std::size_t record = file.bytes.size();
  file.put(std::uint8_t{6}).put((std::uint64_t{1} << 30) - 100).text("that was all");
  std::size_t most = 0;
  auto source = in_pieces(file.bytes, 10);
  auto stream = std::move(*mcap::StreamReader::open_source(
      [&](std::span<std::byte> target) { return most = std::max(most, target.size()), source(target); }, "a"));
  const auto end = stream->for_each_message([](const mcap::Message&) { return true; });
  EXPECT_LE(most, 1u << 20) << "bytes of memory were offered for a record that says it has a gigabyte";
  EXPECT_EQ(to_string(end.errors()), "a: error: truncated at byte " + std::to_string(file.bytes.size()) +
                                         ": the record that begins at byte " + std::to_string(record) +
                                         " isn't whole\n");
}

TEST(McapStream, PassesOnWhyNoMoreCame) {
  auto source = in_pieces(Composer().magic().header().bytes, 100);
  auto stream = std::move(*mcap::StreamReader::open_source(
      [&, calls = 0](std::span<std::byte> target) mutable -> Result<std::size_t> {
        if (++calls > 1) return error("the line is dead");
        return source(target);
      },
      "a"));
  const auto end = stream->for_each_message([](const mcap::Message&) { return true; });
  EXPECT_THAT(to_string(end.errors()), HasSubstr("the line is dead"));
}

namespace {

/// Both ends of a pipe.
class Pipe {
 public:
  Pipe() { EXPECT_EQ(::pipe(ends_), 0); }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void write(mcap::Bytes bytes) const {
    EXPECT_EQ(::write(ends_[1], bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  void close_end(int end) {
    if (ends_[end] >= 0) ::close(std::exchange(ends_[end], -1));
  }
  std::string path() const { return "/proc/self/fd/" + std::to_string(ends_[0]); }

 private:
  int ends_[2] = {-1, -1};
};

}  // namespace

TEST(McapStream, DeliversAMessageAsSoonAsItsChunkHasCome) {
  Pipe pipe;
  pipe.write(Composer().magic().header().channel(1, "/a").bytes);
  auto stream = std::move(*mcap::StreamReader::open(pipe.path()));
  // Each message writes the next one, and the last closes the pipe: a reader that reads ahead would wait forever.
  std::uint64_t count = 0;
  const auto write_next = [&] { pipe.write(Composer().chunk(count, count, Composer().message(1, count, "x")).bytes); };
  write_next();
  const auto end = stream->for_each_message([&](const mcap::Message& message) {
    EXPECT_EQ(message.log_time, count);
    if (++count < 10) {
      write_next();
    } else {
      pipe.write(Composer().end().bytes);
      pipe.close_end(1);
    }
    return true;
  });
  EXPECT_TRUE(end) << to_string(end.errors());
  EXPECT_EQ(count, 10u);
}

TEST(McapStream, ReadsAFile) {
  const TempFile file;
  write_small_file(file.path());
  auto stream = std::move(*mcap::StreamReader::open(file.path()));
  EXPECT_EQ(stream->name(), file.path().string());
  EXPECT_EQ(pass_over(*stream).messages.size(), 5u);
}

TEST(McapInput, APipeIsReadAsAFile) {
  const TempFile file;
  ASSERT_EQ(::mkfifo(file.path().c_str(), 0600), 0);
  const Buffer bytes = small_file();
  std::thread feeder([&] { file.write(bytes); });
  auto reader = mcap::Reader::open(file.path());
  feeder.join();
  ASSERT_TRUE(reader) << to_string(reader.errors());
  EXPECT_EQ((*reader)->size(), bytes.size());
  EXPECT_EQ(pass_in_order(**reader).messages.size(), 5u);
}

TEST(McapInput, APipeThatHasNoNameCanBeOpenedAgain) {
  Pipe pipe, other;
  pipe.write(small_file());
  pipe.close_end(1);
  other.write(Composer().magic().header().end().bytes);
  other.close_end(1);
  for (int time = 0; time < 2; ++time) {
    EXPECT_EQ(pass_over(*std::move(*mcap::Reader::open(pipe.path()))).messages.size(), 5u);
    EXPECT_EQ(pass_over(*std::move(*mcap::Reader::open(other.path()))).messages.size(), 0u);
  }
}

TEST(McapInput, APipeForWhichThereIsNoRoomIsRefused) {
  const char* const before = std::getenv("TMPDIR");
  const std::string restored = before ? before : "";
  ::setenv("TMPDIR", "/nonexistent", 1);
  Pipe pipe;
  const auto reader = mcap::Reader::open(pipe.path());
  before ? ::setenv("TMPDIR", restored.c_str(), 1) : ::unsetenv("TMPDIR");
  ASSERT_FALSE(reader);
  EXPECT_THAT(to_string(reader.errors()),
              HasSubstr(": error: can't store the input in the folder for temporary files: "));
}

TEST(McapInput, AFileThatIsMadeUpAsItIsReadIsReadAsAFile) {
  const auto reader = mcap::Reader::open("/proc/self/status");
  ASSERT_FALSE(reader);
  EXPECT_EQ(to_string(reader.errors()),
            "/proc/self/status: error: not an MCAP file: it doesn't begin with the magic bytes \\x89MCAP0\\r\\n\n");
}

TEST(McapInput, WhatNothingCanBeReadOfIsRefused) {
  const TempFile file;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  ASSERT_LT(file.path().string().size(), sizeof address.sun_path);
  file.path().string().copy(address.sun_path, sizeof address.sun_path - 1);
  const int made = ::socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(::bind(made, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  const auto why = [](const std::filesystem::path& path) {
    const auto reader = mcap::Reader::open(path);
    const auto stream = mcap::StreamReader::open(path);
    EXPECT_FALSE(stream);
    EXPECT_EQ(to_string(stream.errors()), to_string(reader.errors()));
    return reader.errors().front().message;
  };
  EXPECT_EQ(why(file.path()), "can't read the trace: it is a socket's file");
  EXPECT_EQ(why("/dev/zero"), "can't read the trace: it is a device");
  EXPECT_EQ(to_string(mcap::StreamReader::open("/usr").errors()),
            "/usr: error: can't read the trace: it is a directory\n");
  EXPECT_EQ(why("/nonexistent.mcap"), "can't read the trace: No such file or directory");
  ::close(made);
}

TEST(McapInput, AFileThatGrowsIsReadAsLargeAsItWas) {
  const TempFile file;
  const Composer first = Composer().magic().header().channel(1, "/a").message(1, 1, "first");
  file.write(first.bytes);
  auto reader = std::move(*mcap::Reader::open(file.path()));
  file.write(Composer().raw(first.bytes).message(1, 2, "second").bytes);
  EXPECT_EQ(reader->size(), first.bytes.size());
  EXPECT_EQ(pass_over(*reader).messages.size(), 1u);
}
