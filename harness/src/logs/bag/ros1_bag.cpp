#include "ros1_bag.h"

#include <bzlib.h>
#include <fmt/format.h>

#include <cstring>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

namespace rehearse::bag {
namespace {

constexpr std::string_view magic = "#ROSBAG V2.0\n";
constexpr std::uint32_t largest_chunk = std::uint32_t{1} << 28;  // decompressed [bytes]

enum class Op : std::uint8_t { message = 2, bag = 3, index = 4, chunk = 5, chunk_info = 6, connection = 7 };

std::string_view text_of(mcap::Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

template <class Number>
std::optional<Number> number_in(mcap::Bytes bytes) {
  if (bytes.size() != sizeof(Number)) return std::nullopt;
  Number number;
  std::memcpy(&number, bytes.data(), sizeof number);
  return number;
}

/// Takes a block that begins with its size; false: it isn't whole.
bool take_block(mcap::Bytes bytes, std::size_t& at, mcap::Bytes& block) {
  if (bytes.size() - at < sizeof(std::uint32_t)) return false;
  const std::uint32_t size = *number_in<std::uint32_t>(bytes.subspan(at, sizeof(std::uint32_t)));
  if (bytes.size() - at - sizeof size < size) return false;
  block = bytes.subspan(at + sizeof size, size);
  at += sizeof size + size;
  return true;
}

using HeaderFields = std::map<std::string_view, mcap::Bytes>;

/// Reads fields "name=value"; false: one isn't whole.
bool read_fields(mcap::Bytes bytes, HeaderFields& fields) {
  for (std::size_t at = 0; at < bytes.size();) {
    mcap::Bytes field;
    if (!take_block(bytes, at, field)) return false;
    const std::size_t sign = text_of(field).find('=');
    if (sign == std::string_view::npos) return false;
    fields[text_of(field).substr(0, sign)] = field.subspan(sign + 1);
  }
  return true;
}

std::string text_in(const HeaderFields& fields, std::string_view name) {
  const auto found = fields.find(name);
  return found == fields.end() ? std::string() : std::string(text_of(found->second));
}

}  // namespace

struct Ros1Bag::Record {
  std::size_t begin = 0;  // offset in the file, or in its chunk [bytes]
  HeaderFields fields;
  mcap::Bytes data;

  template <class Number>
  std::optional<Number> number(std::string_view name) const {
    const auto found = fields.find(name);
    return found == fields.end() ? std::nullopt : number_in<Number>(found->second);
  }
};

struct Ros1Bag::Pass {
  const OnConnection& on_connection;
  const OnMessage& on_message;
  std::size_t place = 0;  // of the present record of the file [bytes]
  std::set<std::uint32_t> known = {};
  std::set<std::uint32_t> unknown = {};
  Diagnostics damage = {};
  Result<void> delivered = {};  // failed: a callback ended the pass

  void add(const std::string& name, std::string problem) {
    damage.push_back(error_in(name, fmt::format("damaged at byte {}: {}", place, problem)));
  }
};

Result<std::unique_ptr<Ros1Bag>> Ros1Bag::open(mcap::Bytes bytes, std::string name) {
  if (!text_of(bytes).starts_with(magic)) {
    const std::string_view line = text_of(bytes).substr(0, text_of(bytes).substr(0, 64).find('\n'));
    return error_in(std::move(name),
                    fmt::format("a bag of ROS 1 of another version than 2.0: it begins with \"{}\"", line),
                    "rosbag fix, or rosbag migrate, of ROS 1 converts it");
  }
  std::unique_ptr<Ros1Bag> opened(new Ros1Bag(bytes, std::move(name)));
  std::size_t at = magic.size();
  Record record;
  if (read_record(bytes, at, record) && !text_in(record.fields, "encryptor").empty())
    return error_in(opened->name_, fmt::format("it is encrypted by {}", text_in(record.fields, "encryptor")),
                    "rosbag decrypt of ROS 1 decrypts it");
  return opened;
}

bool Ros1Bag::read_record(mcap::Bytes bytes, std::size_t& at, Record& record) {
  record.begin = at;
  record.fields.clear();
  mcap::Bytes header;
  return take_block(bytes, at, header) && take_block(bytes, at, record.data) && read_fields(header, record.fields);
}

Result<void> Ros1Bag::for_each_message(const OnConnection& on_connection, const OnMessage& on_message) {
  Pass pass{on_connection, on_message};
  Record record;
  for (std::size_t at = magic.size(); at < bytes_.size();) {
    pass.place = at;
    if (!read_record(bytes_, at, record)) {
      pass.add(name_, "the record that begins there isn't whole");
      break;
    }
    if (!take(record, pass)) return pass.delivered;
  }
  if (pass.damage.empty()) return {};
  return pass.damage;
}

/// False: a callback failed.
bool Ros1Bag::take(const Record& record, Pass& pass) {
  const auto op = record.number<std::uint8_t>("op");
  if (!op) {
    pass.add(name_, "a record without a kind");
    return true;
  }
  switch (static_cast<Op>(*op)) {
    case Op::chunk: return take_chunk(record, pass);
    case Op::connection: take_connection(record, pass); return true;
    case Op::message: return take_message(record, pass);
    default: return true;  // the index, and kinds of a later version
  }
}

bool Ros1Bag::take_chunk(const Record& record, Pass& pass) {
  const auto chunk = decompress(record);
  if (!chunk) {
    pass.add(name_, chunk.errors()[0].message);
    return true;
  }
  Record inside;
  for (std::size_t at = 0; at < chunk->size();) {
    if (!read_record(*chunk, at, inside)) {
      pass.add(name_, fmt::format("in its chunk the record at byte {} isn't whole", inside.begin));
      return true;
    }
    if (inside.number<std::uint8_t>("op") == static_cast<std::uint8_t>(Op::chunk)) {
      pass.add(name_, "a chunk within a chunk");
      continue;
    }
    if (!take(inside, pass)) return false;
  }
  return true;
}

/// The records of a chunk. Valid until the next call.
Result<mcap::Bytes> Ros1Bag::decompress(const Record& chunk) {
  const std::string compression = text_in(chunk.fields, "compression");
  const auto size = chunk.number<std::uint32_t>("size");
  if (!size) return error("a chunk without its size");
  if (*size > largest_chunk) return error(fmt::format("a chunk of {} bytes", *size));
  if (compression == "none") return chunk.data;
  if (compression == "lz4") return decompressor_.decompress("lz4", chunk.data, *size, buffer_);
  if (compression != "bz2") return error(fmt::format("a chunk of the unknown compression '{}'", compression));
  unsigned int length = *size;
  auto* into = reinterpret_cast<char*>(buffer_.reserve(length));
  auto* from = const_cast<char*>(text_of(chunk.data).data());  // the library doesn't change it
  const int done = BZ2_bzBuffToBuffDecompress(into, &length, from, static_cast<unsigned int>(chunk.data.size()), 0, 0);
  if (done != BZ_OK || length != *size) return error("a chunk that bz2 can't decompress to its size");
  return mcap::Bytes(reinterpret_cast<const std::byte*>(into), length);
}

void Ros1Bag::take_connection(const Record& record, Pass& pass) {
  const auto id = record.number<std::uint32_t>("conn");
  HeaderFields stated;
  if (!id || !read_fields(record.data, stated)) return pass.add(name_, "a connection that isn't whole");
  if (!pass.known.insert(*id).second) return;  // the index repeats all connections
  Ros1Connection connection{
      *id, text_in(record.fields, "topic"), text_in(stated, "type"), text_in(stated, "message_definition"), {}};
  for (const std::string_view name : {"md5sum", "callerid", "latching"})
    if (stated.contains(name)) connection.details[std::string(name)] = text_in(stated, name);
  pass.on_connection(connection);
}

bool Ros1Bag::take_message(const Record& record, Pass& pass) {
  const auto id = record.number<std::uint32_t>("conn");
  const auto time = record.number<std::uint64_t>("time");  // seconds, then nanoseconds
  if (!id || !time) {
    pass.add(name_, "a message without its connection or its time");
    return true;
  }
  if (!pass.known.contains(*id)) {
    if (pass.unknown.insert(*id).second)
      pass.add(name_, fmt::format("messages of connection {}, which no record before describes", *id));
    return true;
  }
  const std::uint64_t nanoseconds = (*time & 0xffffffff) * 1'000'000'000 + (*time >> 32);
  pass.delivered = pass.on_message(*id, nanoseconds, record.data);
  return pass.delivered.ok();
}

}  // namespace rehearse::bag
