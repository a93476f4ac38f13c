#include "outputs_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/clock.h"
#include "core/kinds/channel_name.h"
#include "core/replay/output_record.h"

namespace rehearse {

namespace fs = std::filesystem;

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(OutputField, controller, channel, element, unit, kind)

constexpr char file_magic[8] = {'R', 'H', 'A', 'U', 'D', 'I', 'T', '1'};

/// The header of the file. After it: the fields as CBOR, then the rows.
struct OutputsHead {
  char magic[8];
  std::uint64_t beats;       // number of begins and ends of calls into controllers
  std::uint64_t names_size;  // of the fields' CBOR [bytes]
  std::uint64_t fields;      // number of fields
  std::uint64_t rows_at;     // offset of the first row
  std::uint64_t rows;        // number of complete rows
  std::int64_t tick;         // of the present call
  std::uint64_t under_way;   // 1: a call is running
  char controller[256];      // of the present call
  char function[128];
};

namespace {

using Json = nlohmann::json;

constexpr std::size_t first_size = 1 << 16;

Diagnostic unwritable(const fs::path& file, const char* why) {
  return error(fmt::format("can't write {}: {}", file.string(), why));
}

Diagnostic unreadable(const fs::path& file) {
  return error(fmt::format("{} is not a file of outputs of an audit", file.string()));
}

void put_text(char* place, std::size_t size, const char* text) {
  const std::size_t length = std::min(size - 1, std::strlen(text));
  std::memcpy(place, text, length);
  place[length] = '\0';
}

}  // namespace

Result<OutputsWriter> OutputsWriter::create(const fs::path& file) {
  const int opened = ::open(file.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (opened < 0) return unwritable(file, std::strerror(errno));
  const bool sized = ::ftruncate(opened, first_size) == 0;
  void* memory = sized ? ::mmap(nullptr, first_size, PROT_READ | PROT_WRITE, MAP_SHARED, opened, 0) : MAP_FAILED;
  const int problem = errno;
  ::close(opened);
  if (memory == MAP_FAILED) return unwritable(file, std::strerror(problem));
  OutputsWriter writer(fs::absolute(file), static_cast<std::byte*>(memory), first_size);
  std::memcpy(writer.head().magic, file_magic, sizeof file_magic);
  return writer;
}

OutputsWriter::OutputsWriter(fs::path file, std::byte* memory, std::size_t size)
    : file_(std::move(file)), memory_(memory), size_(size) {}

OutputsWriter::OutputsWriter(OutputsWriter&& other) noexcept
    : file_(std::move(other.file_)),
      memory_(std::exchange(other.memory_, nullptr)),
      size_(other.size_),
      complete_(other.complete_) {}

OutputsWriter::~OutputsWriter() {
  if (memory_) ::munmap(memory_, size_);
}

OutputsHead& OutputsWriter::head() const { return *reinterpret_cast<OutputsHead*>(memory_); }

/// Opens the file by name, because a controller may have closed every descriptor.
bool OutputsWriter::grow(std::size_t size) {
  if (size <= size_) return true;
  std::size_t larger = size_;
  while (larger < size) larger *= 2;
  if (::truncate(file_.c_str(), static_cast<off_t>(larger)) != 0) return false;
  void* memory = ::mremap(memory_, size_, larger, MREMAP_MAYMOVE);
  if (memory == MAP_FAILED) return false;
  memory_ = static_cast<std::byte*>(memory);
  size_ = larger;
  return true;
}

void OutputsWriter::begin(const std::vector<OutputField>& fields) {
  const std::vector<std::uint8_t> names = Json::to_cbor(fields);
  const std::size_t rows_at = (sizeof(OutputsHead) + names.size() + 7) / 8 * 8;
  complete_ = complete_ && grow(rows_at);
  if (!complete_) return;
  std::memcpy(memory_ + sizeof(OutputsHead), names.data(), names.size());
  head().names_size = names.size();
  head().rows_at = rows_at;
  head().fields = fields.size();
}

void OutputsWriter::add(std::int64_t tick, const std::vector<std::uint64_t>& row) {
  const std::size_t stride = (row.size() + 1) * sizeof(std::uint64_t);
  const std::size_t at = head().rows_at + head().rows * stride;
  complete_ = complete_ && grow(at + stride);
  if (!complete_) return;
  const auto number = static_cast<std::uint64_t>(tick);
  std::memcpy(memory_ + at, &number, sizeof number);
  std::memcpy(memory_ + at + sizeof number, row.data(), row.size() * sizeof(std::uint64_t));
  ++head().rows;
}

void OutputsWriter::enter(const char* controller, const char* function, std::int64_t tick) {
  OutputsHead& now = head();
  put_text(now.controller, sizeof now.controller, controller);
  put_text(now.function, sizeof now.function, function);
  now.tick = tick;
  now.under_way = 1;
  ++now.beats;
}

void OutputsWriter::leave() {
  head().under_way = 0;
  ++head().beats;
}

Result<Outputs> Outputs::read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  OutputsHead head{};
  if (!stream.read(reinterpret_cast<char*>(&head), sizeof head)) return unreadable(file);
  if (std::memcmp(head.magic, file_magic, sizeof file_magic) != 0) return unreadable(file);
  Outputs outputs;
  if (head.under_way != 0) outputs.unfinished_ = UnfinishedCall{head.controller, head.function, head.tick};
  if (head.fields == 0) return outputs;
  std::error_code ignored;
  const std::uintmax_t size = fs::file_size(file, ignored);
  const std::uint64_t words = head.rows * (head.fields + 1);
  if (head.names_size > size || head.rows_at > size || words > (size - head.rows_at) / sizeof(std::uint64_t))
    return unreadable(file);
  std::string names(head.names_size, '\0');
  stream.read(names.data(), static_cast<std::streamsize>(names.size()));
  try {
    outputs.fields_ = Json::from_cbor(names).get<std::vector<OutputField>>();
  } catch (const Json::exception&) {
    return unreadable(file);
  }
  outputs.words_.resize(words);
  stream.seekg(static_cast<std::streamoff>(head.rows_at));
  stream.read(reinterpret_cast<char*>(outputs.words_.data()),
              static_cast<std::streamsize>(words * sizeof(std::uint64_t)));
  if (!stream || outputs.fields_.size() != head.fields) return unreadable(file);
  return outputs;
}

std::optional<std::uint64_t> heartbeat_of(const fs::path& file) {
  OutputsHead head{};
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(reinterpret_cast<char*>(&head), sizeof head)) return std::nullopt;
  return head.beats + head.rows;
}

namespace {

bool same_layout(const Outputs& a, const Outputs& b) {
  const auto same = [](const OutputField& one, const OutputField& other) {
    return one.controller == other.controller && one.channel == other.channel && one.element == other.element;
  };
  return std::ranges::equal(a.fields(), b.fields(), same);
}

}  // namespace

std::optional<Divergence> first_difference(const Outputs& expected, const Outputs& actual, double time_step,
                                           const std::string& controller) {
  Divergence found;
  found.channel = controller.empty() ? run_topics::tick : "/" + controller + "/output";
  if (!same_layout(expected, actual)) {
    const bool begun = !expected.fields().empty() && !actual.fields().empty();
    found.note = begun ? "another set of outputs was enabled" : "only one of two runs came to its first tick";
    return found;
  }
  const std::int64_t rows = std::min(expected.rows(), actual.rows());
  for (std::int64_t row = 0; row < rows; ++row) {
    const auto a = expected.row(row), b = actual.row(row);
    if (std::memcmp(a.data(), b.data(), a.size_bytes()) == 0) continue;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const OutputField& field = expected.fields()[i];
      if (!controller.empty() && field.controller != controller) continue;
      auto differs = difference(field, a[i], b[i]);
      if (!differs) continue;
      differs->tick = expected.tick(row);
      differs->time = time_of(differs->tick, time_step);
      return differs;
    }
  }
  if (expected.rows() == actual.rows()) return std::nullopt;
  found.tick = rows == 0 ? 0 : (expected.rows() > rows ? expected.tick(rows) : actual.tick(rows));
  found.time = time_of(found.tick, time_step);
  found.note = "only one of two runs came to this tick";
  return found;
}

}  // namespace rehearse
