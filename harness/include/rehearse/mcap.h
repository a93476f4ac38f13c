// MCAP: the container in which a recording stands. Writer and Reader of the public format, version 0.
//
// A file is a sequence of records: schemas and channels (what can be said), messages packed into chunks (what was said,
// compressed and with a CRC), attachments and metadata, then a summary that makes all of it findable. Nothing here
// knows what is in a message; that is cdr.h and messages.h. What Rehearse puts into one: harness/TRACE_FORMAT.md.
//
// Writer: the caller's thread copies a message into the open chunk and returns; one thread of the Writer's own
// composes what was put off, compresses, checksums and writes finished chunks. The bytes of the file depend on the
// calls and their arguments, on nothing else.
//
// Reader: maps the file, trusts no length in it, checks every CRC that it passes, and delivers what can be had of a
// damaged file before it says where the damage is. What comes through a pipe it keeps in a temporary file first.
// Neither class may be used from two threads at a time.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap_types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse::mcap {

using Bytes = std::span<const std::byte>;

/// Says what the messages of a channel look like.
struct Schema {
  std::uint16_t id = 0;  // never 0
  std::string name;      // as sensor_msgs/msg/JointState
  std::string encoding;  // "ros2msg" in what we write
  std::string data;      // the schema itself
  bool operator==(const Schema&) const = default;
};

/// A stream of messages of one kind about one thing.
struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0;   // 0: none
  std::string topic;             // as /SR1/joints
  std::string message_encoding;  // "cdr" in what we write
  StringMap metadata;
  bool operator==(const Channel&) const = default;
};

/// One message, as a Reader delivers it. The data is valid during the callback only.
struct Message {
  const Channel* channel = nullptr;  // never null; lives as long as the Reader
  std::uint32_t sequence = 0;        // counts from 0 on each channel, in what we write
  std::uint64_t log_time = 0;        // [ns]
  std::uint64_t publish_time = 0;    // [ns]
  Bytes data;
  Location location;
};

/// A file within the file. Of a Reader: the data lives as long as it.
struct Attachment {
  std::uint64_t log_time = 0;     // [ns]
  std::uint64_t create_time = 0;  // [ns]
  std::string name;
  std::string media_type;
  Bytes data;
  std::uint64_t offset = 0;  // of its record in the file

  std::string_view text() const { return {reinterpret_cast<const char*>(data.data()), data.size()}; }
};

struct Metadata {
  std::string name;
  StringMap values;
  std::uint64_t offset = 0;  // of its record in the file
};

/// A chunk: as its own head says it, or the summary's index of it.
struct Chunk {
  std::uint64_t offset = 0;       // of its record in the file
  std::uint64_t start_time = 0;   // [ns], of its earliest message
  std::uint64_t end_time = 0;     // [ns], of its latest
  std::string compression;        // "", "lz4", "zstd", or whatever stands there
  std::uint64_t stored_size = 0;  // [bytes]
  std::uint64_t size = 0;         // decompressed [bytes]
};

/// Counts, as the file's summary states them.
struct Statistics {
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0;
  std::uint32_t attachment_count = 0;
  std::uint32_t metadata_count = 0;
  std::uint32_t chunk_count = 0;
  std::uint64_t message_start_time = 0;  // [ns], of the earliest message; 0 without messages
  std::uint64_t message_end_time = 0;    // [ns], of the latest
  std::map<std::uint16_t, std::uint64_t> channel_message_counts;
};

enum class Compression { none, lz4, zstd };

/// "", "lz4" or "zstd": the format's own names.
std::string_view to_string(Compression compression);

/// What a file has besides what was put into it. The format demands none of it: what is left out is missed by readers
/// who want to find something without reading everything, or to notice damage.
struct FileForm {
  bool chunks = true;                  // false: messages stand by themselves, uncompressed, in the order of the calls
  bool definitions_in_chunks = false;  // schemas and channels before their first message in each chunk, nowhere else
  bool message_indexes = true;         // behind each chunk
  bool chunk_crcs = true;
  bool attachment_crcs = true;
  bool data_crc = true;
  bool summary = true;  // false: nothing of what follows, but for the CRC
  bool repeated_schemas = true;
  bool repeated_channels = true;
  bool statistics = true;
  bool chunk_indexes = true;
  bool attachment_indexes = true;
  bool metadata_indexes = true;
  bool summary_offsets = true;
  bool summary_crc = true;

  bool has_definitions_in_chunks() const { return chunks && definitions_in_chunks; }
};

struct WriterOptions {
  /// The profile of the header. With "ros2" every channel gets the metadata key offered_qos_profiles that it demands.
  std::string profile = "ros2";
  /// Who writes, as the header says it; nullopt: rehearse and its version.
  std::optional<std::string> library;
  /// A chunk is finished when its records, and what is held for those put off, reach this size [bytes]; so it is at
  /// most one message larger.
  std::size_t chunk_size = 768 * 1024;
  /// ... or when any message comes this much log time after the chunk's first [ns]. This bounds what a kill loses.
  std::uint64_t chunk_span = 1'000'000'000;
  /// For all channels; nullopt: as their groups say.
  std::optional<Compression> compression;
  int lz4_level = 0;   // from 3 on it is slower, and smaller
  int zstd_level = 1;  // level 3 took three times as long on joint states and made them no smaller (measured)
  /// Finished chunks that may wait for the writer thread; then write() waits too. Bounds the memory.
  std::size_t queue_length = 4;
  /// The index of the chunks is held in memory up to this size [bytes]; if it grows larger, it is made in the end from
  /// what stands in the file. A pipe can't be read again: there all of it is held.
  std::size_t index_size = std::size_t{1} << 20;
  FileForm form;
};

/// How the messages of a channel are stored. Channels with equal values share chunks.
struct ChunkGroup {
  int id = 0;
  Compression compression = Compression::zstd;
};
/// Numbers: many, small, alike.
inline constexpr ChunkGroup numbers{0, Compression::zstd};
/// Pictures and other data that is already compressed.
inline constexpr ChunkGroup pictures{1, Compression::none};

/// Writes one file, front to back; it never seeks. Every call may return the error of an earlier one (a full disk shows
/// late); after an error nothing more is written. Destroying a Writer without close() leaves a file without summary,
/// readable up to the last finished chunk: as a kill does.
class Writer {
 public:
  /// Creates the file, or begins it anew: who has the old one open keeps it as it was, unless it has more than one name
  /// or owner. Links, pipes and devices are written into. Fails if it can't be opened.
  static Result<std::unique_ptr<Writer>> create(const std::filesystem::path& file, WriterOptions options = {});
  /// Appends to bytes that outlive the Writer, and that nobody else touches before close() or flush() has returned.
  static std::unique_ptr<Writer> create_in_memory(std::vector<std::byte>& out, WriterOptions options = {});
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// Adds a schema and returns its id (from 1); the same name, encoding and data again is the same id. A file holds
  /// 65535: one more is 0 and an error of every later call.
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view data);

  /// Adds a channel and returns its id (from 1). `schema` is 0 or an id of add_schema. A file holds 65536, the last
  /// with the id 0: one more is an error of every later call.
  std::uint16_t add_channel(std::uint16_t schema, std::string_view topic, std::string_view message_encoding,
                            StringMap metadata = {}, ChunkGroup group = numbers);

  /// Copies the message into the open chunk of its channel's group. Tens of nanoseconds, unless the queue is full.
  /// `sequence`: for messages that have a number already; else they are counted from 0 on each channel.
  Result<void> write(std::uint16_t channel, std::uint64_t log_time_ns, std::uint64_t publish_time_ns, Bytes data,
                     std::optional<std::uint32_t> sequence = {});

  /// The same for a message that takes long to compose, as a picture to encode: the Writer's thread will call `compose`
  /// once, when the chunk is finished. What it gives depends only on what it was made of, which nobody changes; it
  /// throws nothing. `held`: the memory that waits with it [bytes].
  Result<void> write_later(std::uint16_t channel, std::uint64_t log_time_ns, std::uint64_t publish_time_ns,
                           std::size_t held, std::function<std::vector<std::byte>()> compose);

  /// Adds an attachment. Times are 0 where nothing better is known: never the wall clock's.
  Result<void> add_attachment(std::string_view name, std::string_view media_type, Bytes data,
                              std::uint64_t log_time_ns = 0, std::uint64_t create_time_ns = 0);

  Result<void> add_metadata(std::string_view name, const StringMap& values);

  /// Finishes the open chunks and waits until all of them are in the file. Changes the bytes of the file: the chunks
  /// end here. For the moment before something may crash for good.
  Result<void> flush();

  /// Finishes the open chunks, writes the summary and closes the file. Only add nothing after it; a second close()
  /// returns what the first did.
  Result<void> close();

  /// The number under which the file is open, until close(); -1 in memory.
  int descriptor() const;

 private:
  class Impl;
  explicit Writer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// How a Reader learns what is in a file.
enum class Opening {
  walk,        // by every outermost record: finds all damage of the frame, and reads no message
  by_summary,  // by what the end of the file says, if that is whole and fits together; else by the walk
};

struct ReaderOptions {
  bool check_crcs = true;
  Opening opening = Opening::walk;
  /// A chunk that says it is larger decompressed is refused as damaged [bytes].
  std::uint64_t max_chunk_size = std::uint64_t{1} << 30;
};

/// A record as it stands in the file.
struct Record {
  std::uint8_t opcode = 0;
  Bytes body;                          // without opcode and length; valid during the callback only
  std::uint64_t offset = 0;            // of its opcode: in the file, or in the chunk's decompressed records
  std::optional<std::uint64_t> chunk;  // offset of its chunk in the file, if it is in one
};

/// Reads one file. open() fails only if there is nothing to be had: no such file, not MCAP, not a file (a directory, a
/// device). A pipe is one, and so is standard input, named "-". A file that is cut or damaged opens; damage() says
/// where, passes deliver what is whole and then return all the damage they met.
class Reader {
 public:
  using OnMessage = std::function<bool(const Message&)>;  // false: stop
  using OnRecord = std::function<bool(const Record&)>;    // false: stop

  /// Maps the file, as large as it is now, and walks its outermost records (not into chunks, except for channels if
  /// there is no summary).
  static Result<std::unique_ptr<Reader>> open(const std::filesystem::path& file, ReaderOptions options = {});
  /// The same over bytes that outlive the Reader; `name` is what messages call them.
  static Result<std::unique_ptr<Reader>> open_bytes(Bytes bytes, std::string name, ReaderOptions options = {});
  ~Reader();
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  const std::string& name() const;     // as the user named the file
  const std::string& profile() const;  // of the header
  const std::string& library() const;  // of the header: who wrote it
  std::uint64_t size() const;          // [bytes]

  /// Whether open() learned all from the summary. The walk is then made by the first pass that isn't of single
  /// messages: until then damage() is empty, and an attachment's CRC isn't checked. What the walk finds comes with that
  /// pass.
  bool opened_by_summary() const;

  /// What the walk found: cut at byte N, summary damaged, ... Empty: the file's frame is whole.
  const Diagnostics& damage() const;

  const std::map<std::uint16_t, Schema>& schemas() const;
  const std::map<std::uint16_t, Channel>& channels() const;
  /// The schema of a channel; null if it has none.
  const Schema* schema_of(const Channel& channel) const;
  const std::vector<Attachment>& attachments() const;
  const std::vector<Metadata>& metadata() const;
  const std::vector<Chunk>& chunks() const;             // in file order
  const std::optional<Statistics>& statistics() const;  // nullopt: the file has none

  /// Every message of the chosen channels (all if empty) in file order. A chunk whose CRC is wrong is left out whole.
  /// Unless stopped, the pass also checks the data section's CRC. Its errors include damage().
  Result<void> for_each_message(const OnMessage& callback, std::span<const std::uint16_t> channels = {});

  /// The same in order of (log time, position in the file), over chunks that overlap in time. Holds those chunks.
  Result<void> for_each_message_in_order(const OnMessage& callback, std::span<const std::uint16_t> channels = {});

  /// One message again. Its data is valid until the next call of any function of this Reader.
  Result<Message> message_at(const Location& location);

  class Impl;
  Impl& impl() const { return *impl_; }  // internal

 private:
  explicit Reader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// The messages of a file in order of (log time, position in the file), one at a time, over chunks that overlap in
/// time. Holds those chunks.
class OrderedMessages {
 public:
  /// Of the chosen channels (all if empty). The reader must outlive this.
  explicit OrderedMessages(Reader& reader, std::span<const std::uint16_t> channels = {});
  ~OrderedMessages();
  OrderedMessages(const OrderedMessages&) = delete;
  OrderedMessages& operator=(const OrderedMessages&) = delete;

  /// The next message, valid until the next call; null behind the last.
  const Message* next();
  /// All damage so far, the reader's own included. Behind the last message the data section's CRC is checked, too.
  Result<void> verdict();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rehearse::mcap
