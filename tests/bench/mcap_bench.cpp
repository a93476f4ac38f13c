// The cost of the container: writing relative to compressing, reading relative to decompressing and checking, small
// messages relative to copying them, and info of a large file.
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>

#include "../harness/mcap/large_file.h"
#include "core/mcap/codec.h"
#include "core/mcap/file_view.h"
#include "core/mcap/records.h"
#include "pairs.h"

namespace rehearse {
namespace {

using Buffer = std::vector<std::byte>;

constexpr std::size_t chunk_size = mcap::WriterOptions{}.chunk_size;

/// Joint states of a robot that moves its legs, as sensor_msgs/msg/JointState has them: names, then positions,
/// velocities and efforts of 30 joints, tick by tick.
std::vector<Buffer> joint_states() {
  constexpr std::size_t ticks = 50'000, joints = 30, moving = 12;
  std::string names;
  for (std::size_t i = 0; i < joints; ++i) names += std::string("\x0c\0\0\0LEG_JOINT_", 14) + std::to_string(10 + i);
  std::vector<Buffer> messages;
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    double values[3 * joints] = {};
    for (std::size_t i = 0; i < moving; ++i) {
      const double phase = 0.001 * static_cast<double>(tick) * (1.0 + 0.1 * static_cast<double>(i));
      values[i] = std::sin(phase);
      values[joints + i] = std::cos(phase);
      values[2 * joints + i] = 20.0 * std::sin(phase) * std::cos(3.0 * phase);
    }
    Buffer message(names.size() + sizeof values);
    std::memcpy(message.data(), names.data(), names.size());
    std::memcpy(message.data() + names.size(), values, sizeof values);
    messages.push_back(std::move(message));
  }
  return messages;
}

/// Writes a file of these messages.
void write_file(const std::filesystem::path& file, const std::vector<Buffer>& messages,
                const mcap::WriterOptions& options = {}) {
  const auto writer = std::move(*mcap::Writer::create(file, options));
  const auto channel = writer->add_channel(0, "/joints", "cdr");
  for (std::uint64_t i = 0; i < messages.size(); ++i)
    static_cast<void>(writer->write(channel, i * 1'000'000, i * 1'000'000, messages[i]));
  REHEARSE_ASSERT(writer->close(), "the folder for temporary files has room");
}

/// Takes any bytes without work.
const std::filesystem::path nowhere = "/dev/null";

/// Work: joint states through the Writer, as recordings are written. Base: zstd level 1 over the same bytes, in
/// pieces as large as a chunk.
void writing_over_compressing(benchmark::State& state) {
  const auto messages = joint_states();
  Buffer all;
  for (const Buffer& message : messages) all.insert(all.end(), message.begin(), message.end());
  mcap::Compressor compressor(1, 0);
  Pairs pairs(CLOCK_PROCESS_CPUTIME_ID);
  for (auto _ : Repeated(state)) {
    const auto write = [&] { write_file(nowhere, messages); };
    const auto compress = [&] {
      for (std::size_t at = 0; at < all.size(); at += chunk_size) {
        const auto piece = mcap::Bytes(all).subspan(at, std::min(chunk_size, all.size() - at));
        benchmark::DoNotOptimize(compressor.compress(mcap::Compression::zstd, piece)->data());
      }
    };
    state.SetIterationTime(pairs.measure(write, compress));
  }
  pairs.report(state, 1, 1);
}
BENCHMARK(writing_over_compressing)->UseManualTime()->Unit(benchmark::kMillisecond);

/// Work: messages of 16 bytes, uncompressed, with all CRCs and indexes, into nothing. Base: copying their records five
/// times.
void small_messages_over_copying(benchmark::State& state) {
  constexpr std::uint64_t count = 1'000'000;
  const Buffer data(16, std::byte{7});
  mcap::WriterOptions options;
  options.compression = mcap::Compression::none;
  options.chunk_span = ~std::uint64_t{0};
  Buffer copy;
  const Buffer records(count * (mcap::record_head + mcap::message_head + data.size()), std::byte{7});
  copy.resize(records.size());
  Pairs pairs(CLOCK_PROCESS_CPUTIME_ID);
  for (auto _ : Repeated(state)) {
    const auto write = [&] {
      const auto writer = std::move(*mcap::Writer::create(nowhere, options));
      const auto channel = writer->add_channel(0, "/small", "cdr");
      for (std::uint64_t i = 0; i < count; ++i) static_cast<void>(writer->write(channel, i, i, data));
      REHEARSE_ASSERT(writer->close(), "nothing is never full");
    };
    const auto copy_records = [&] {
      for (int i = 0; i < 5; ++i) {
        std::memcpy(copy.data(), records.data(), records.size());
        benchmark::ClobberMemory();
      }
    };
    state.SetIterationTime(pairs.measure(write, copy_records));
  }
  pairs.report(state, 1, 1);
}
BENCHMARK(small_messages_over_copying)->UseManualTime()->Unit(benchmark::kMillisecond);

/// Work: a pass over all messages of a file of level 1, all CRCs checked. Base: decompressing the same chunks, and one
/// CRC over what comes out.
void reading_over_decompressing(benchmark::State& state) {
  mcap::WriterOptions options;
  options.zstd_level = 1;  // files of others are compressed in such a way
  const auto path = std::filesystem::temp_directory_path() / "rehearse_joint_states.mcap";
  write_file(path, joint_states(), options);
  const auto view = std::move(*mcap::FileView::open(path));
  std::filesystem::remove(path);
  const Buffer file(view.bytes().begin(), view.bytes().end());
  std::vector<mcap::ChunkHead> heads;
  mcap::RecordWalker walker(file, mcap::magic.size());
  for (mcap::Record record; walker.next(record);)
    if (record.opcode == mcap::op::chunk) heads.push_back(*mcap::parse_chunk(record.body));
  mcap::Decompressor decompressor;
  mcap::RawBuffer buffer;
  Pairs pairs;
  for (auto _ : Repeated(state)) {
    std::uint64_t sum = 0;
    const auto read = [&] {
      const auto opened = mcap::Reader::open_bytes(file, "joints");
      const auto end = (*opened)->for_each_message([&](const mcap::Message& message) {
        sum += message.log_time + message.data.size();
        return true;
      });
      REHEARSE_ASSERT(end, "the file is whole");
    };
    const auto decompress = [&] {
      for (const mcap::ChunkHead& head : heads)
        sum += mcap::crc32(*decompressor.decompress(head.compression, head.records, head.uncompressed_size, buffer));
    };
    state.SetIterationTime(pairs.measure(read, decompress));
    benchmark::DoNotOptimize(sum);
  }
  pairs.report(state, 1, 1);
}
BENCHMARK(reading_over_decompressing)->UseManualTime()->Unit(benchmark::kMillisecond);

/// Work: `rehearse info` of an indexed file of 10 GB. Base: `rehearse --version`.
void info_of_10_gigabytes(benchmark::State& state) {
  const auto file = std::filesystem::temp_directory_path() / "rehearse_info_of_10_gigabytes.mcap";
  test::LargeFile large(file, 10'000'000'000);
  if (!large.ok()) return state.SkipWithError("no room for a large file");
  const auto run = [](const std::string& arguments) {
    const std::string line = REHEARSE_COMMAND " " + arguments + " > /dev/null";
    REHEARSE_ASSERT(std::system(line.c_str()) == 0, "it is a whole file");
  };
  Pairs pairs;
  for (auto _ : Repeated(state))
    state.SetIterationTime(pairs.measure([&] { run("info " + file.string()); }, [&] { run("--version"); }));
  pairs.report(state, 1, 1);
}
BENCHMARK(info_of_10_gigabytes)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rehearse
