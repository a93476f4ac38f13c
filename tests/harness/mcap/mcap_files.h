// Small MCAP files for tests: written by the Writer, or composed byte by byte in forms that the Writer never produces.
#pragma once

#include <rehearse/mcap.h>

#include <gtest/gtest.h>

#include <unistd.h>
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "composer.h"
#include "core/mcap/chunks.h"
#include "support/files.h"

namespace rehearse::test {

inline std::string text_of(mcap::Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

/// The position of the text in the bytes; fails the test and returns the end if it is missing.
inline Buffer::iterator find_text(Buffer& bytes, std::string_view text) {
  const auto wanted = bytes_of(text);
  const auto found = std::search(bytes.begin(), bytes.end(), wanted.begin(), wanted.end());
  EXPECT_NE(found, bytes.end()) << text;
  return found;
}

/// A path for this test alone; the file is removed with the object.
class TempFile {
 public:
  TempFile() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    static int count = 0;
    std::string name = std::string("rehearse_") + test->test_suite_name() + "." + test->name() + "_" +
                       std::to_string(::getpid()) + "_" + std::to_string(count++);
    std::ranges::replace(name, '/', '_');  // in the names of tests with a parameter
    path_ = std::filesystem::temp_directory_path() / name;
  }
  ~TempFile() { std::filesystem::remove(path_); }
  TempFile(const TempFile&) = delete;
  TempFile& operator=(const TempFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  Buffer read() const { return read_bytes(path_); }
  void write(mcap::Bytes bytes) const { write_bytes(path_, bytes); }

 private:
  std::filesystem::path path_;
};

/// A message from a reader, with a copy of its data.
struct Seen {
  std::string topic;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0;
  std::string data;
  bool operator==(const Seen&) const = default;
};

inline std::ostream& operator<<(std::ostream& out, const Seen& seen) {
  return out << seen.topic << '#' << seen.sequence << '@' << seen.log_time << ':' << seen.data;
}

inline Seen see(const mcap::Message& message) {
  return {message.channel->topic, message.sequence, message.log_time, text_of(message.data)};
}

/// All messages in file order, and the result of the pass.
struct Pass {
  std::vector<Seen> messages;
  Result<void> end;
};

inline Pass pass_over(mcap::Reader& reader) {
  Pass pass;
  pass.end = reader.for_each_message([&](const mcap::Message& message) {
    pass.messages.push_back(see(message));
    return true;
  });
  return pass;
}

inline Pass pass_in_order(mcap::Reader& reader) {
  Pass pass;
  pass.end = reader.for_each_message_in_order([&](const mcap::Message& message) {
    pass.messages.push_back(see(message));
    return true;
  });
  return pass;
}

/// Visits every record of a whole file in order: a chunk before its contents, the summary last. Returning false stops.
inline void for_each_record(mcap::Bytes bytes, const std::function<bool(const mcap::Record&)>& callback) {
  mcap::ChunkOpener opener({});
  mcap::RawBuffer buffer;
  mcap::RecordWalker walker(bytes, mcap::magic.size());
  for (mcap::Record record; walker.next(record);) {
    if (!callback(record)) return;
    if (record.opcode != mcap::op::chunk) continue;
    mcap::RecordWalker inside(opener.open(record, buffer).records);
    mcap::Record inner;
    inner.chunk = record.offset;
    while (inside.next(inner))
      if (!callback(inner)) return;
    EXPECT_TRUE(inside.at_end()) << "the chunk at byte " << record.offset;
  }
  EXPECT_EQ(walker.offset() + mcap::magic.size(), bytes.size());
}

/// Two channels in two groups, five messages in three chunks, an attachment, metadata.
inline void write_small_file(const std::filesystem::path& file, mcap::WriterOptions options = {}) {
  options.chunk_span = 2000;
  auto writer = std::move(*mcap::Writer::create(file, options));
  const auto schema = writer->add_schema("test/msg/Text", "ros2msg", "string text\n");
  const auto numbers = writer->add_channel(schema, "/numbers", "cdr", {{"unit", "rad"}});
  const auto pictures = writer->add_channel(0, "/pictures", "cdr", {}, mcap::pictures);
  ASSERT_TRUE(writer->add_attachment("scenario.yaml", "application/yaml", bytes_of("rehearse: 1\n")));
  ASSERT_TRUE(writer->write(numbers, 0, 0, bytes_of("zero")));
  ASSERT_TRUE(writer->write(pictures, 0, 0, bytes_of("a picture")));
  ASSERT_TRUE(writer->write(numbers, 1000, 1000, bytes_of("one")));
  ASSERT_TRUE(writer->write(numbers, 2000, 2000, bytes_of("two")));
  ASSERT_TRUE(writer->write(numbers, 3000, 3001, bytes_of("")));
  ASSERT_TRUE(writer->add_metadata("provenance", {{"seed", "0"}, {"solver", "quick"}}));
  ASSERT_TRUE(writer->close());
}

/// The bytes of a file that `fill` writes with the Writer.
inline Buffer written(const mcap::WriterOptions& options, const std::function<void(mcap::Writer&)>& fill) {
  const TempFile file;
  const auto writer = std::move(*mcap::Writer::create(file.path(), options));
  fill(*writer);
  EXPECT_TRUE(writer->close());
  return file.read();
}

/// The bytes of the sample file.
inline Buffer small_file(mcap::WriterOptions options = {}) {
  const TempFile file;
  write_small_file(file.path(), std::move(options));
  return file.read();
}

inline std::unique_ptr<mcap::Reader> open_composed(const Composer& file, mcap::ReaderOptions options = {}) {
  auto reader = mcap::Reader::open_bytes(file.bytes, "composed.mcap", options);
  EXPECT_TRUE(reader) << (reader ? "" : to_string(reader.errors()));
  return std::move(*reader);
}

}  // namespace rehearse::test
