// MCAP: the container format of recordings. Writer and Reader of the public format, version 0.
//
// A file is a sequence of records: schemas and channels (descriptions of messages), messages packed into compressed
// chunks with a CRC, attachments and metadata, then a summary that indexes all of these. The content of messages is not
// interpreted here; cdr.h and messages.h do that. The records of Rehearse: harness/TRACE_FORMAT.md.
//
// Writer: the caller's thread copies a message into the open chunk and returns. The Writer's thread composes deferred
// messages, compresses, checksums and writes finished chunks. The bytes of the file depend on the calls and their
// arguments alone.
//
// Reader: maps the file, trusts no length in it, and checks every CRC that it passes. It delivers all readable data of
// a damaged file before it reports the place of the damage. Data from a pipe is first stored in a temporary file.
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

/// Describes the structure of the messages of a channel.
struct Schema {
  std::uint16_t id = 0;  // never 0
  std::string name;      // as sensor_msgs/msg/JointState
  std::string encoding;  // "ros2msg" in recordings
  std::string data;      // the schema itself
  bool operator==(const Schema&) const = default;
};

/// A stream of messages of one kind about one thing.
struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0;   // 0: none
  std::string topic;             // as /SR1/joints
  std::string message_encoding;  // "cdr" in recordings
  StringMap metadata;
  bool operator==(const Channel&) const = default;
};

/// One message, as a Reader delivers it. The data is valid during the callback only.
struct Message {
  const Channel* channel = nullptr;  // never null; valid as long as the Reader exists
  std::uint32_t sequence = 0;        // counts from 0 on each channel in recordings
  std::uint64_t log_time = 0;        // [ns]
  std::uint64_t publish_time = 0;    // [ns]
  Bytes data;
  Location location;
};

/// A file within the file. The data of a Reader's attachment is valid as long as the Reader exists.
struct Attachment {
  std::uint64_t log_time = 0;     // [ns]
  std::uint64_t create_time = 0;  // [ns]
  std::string name;
  std::string media_type;
  Bytes data;
  std::uint64_t offset = 0;  // offset of its record in the file

  std::string_view text() const { return {reinterpret_cast<const char*>(data.data()), data.size()}; }
};

struct Metadata {
  std::string name;
  StringMap values;
  std::uint64_t offset = 0;  // offset of its record in the file
};

/// A chunk, as described by its own header or by the summary's index.
struct Chunk {
  std::uint64_t offset = 0;       // offset of its record in the file
  std::uint64_t start_time = 0;   // log time of its earliest message [ns]
  std::uint64_t end_time = 0;     // log time of its latest message [ns]
  std::string compression;        // "", "lz4", "zstd", or any other text in the file
  std::uint64_t stored_size = 0;  // [bytes]
  std::uint64_t size = 0;         // decompressed [bytes]
};

/// A chunk as a file contains it, with the message indexes after it: a copy of it needs no decompression.
struct StoredChunk {
  /// The index of one channel's messages.
  struct Index {
    std::uint16_t channel = 0;
    std::uint64_t count = 0;   // of messages
    std::uint64_t offset = 0;  // offset of its record in `bytes`
  };
  Chunk chunk;
  Bytes bytes;  // the Chunk record, then its MessageIndex records
  std::vector<Index> indexes;

  /// Parses the chunk at `offset` of `file`. nullopt: there is none, or it or an index is shorter than its fields
  /// state.
  static std::optional<StoredChunk> parse(Bytes file, std::uint64_t offset = 0);
};

/// Counts, as the file's summary states them.
struct Statistics {
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0;
  std::uint32_t attachment_count = 0;
  std::uint32_t metadata_count = 0;
  std::uint32_t chunk_count = 0;
  std::uint64_t message_start_time = 0;  // log time of the earliest message [ns]; 0 without messages
  std::uint64_t message_end_time = 0;    // log time of the latest message [ns]
  std::map<std::uint16_t, std::uint64_t> channel_message_counts;
};

enum class Compression { none, lz4, zstd };

/// "", "lz4" or "zstd": the format's own names.
std::string_view to_string(Compression compression);

struct WriterOptions {
  /// The profile of the header. With "ros2" every channel gets the metadata key offered_qos_profiles, which this
  /// profile demands.
  std::string profile = "ros2";
  /// The writing library in the header; nullopt: rehearse and its version.
  std::optional<std::string> library;
  /// A chunk is finished when its records, and the memory of its deferred messages, reach this size [bytes]. So a
  /// chunk is larger by at most one message.
  std::size_t chunk_size = 768 * 1024;
  /// A chunk is also finished when any message comes this much log time after the chunk's first [ns]. So a kill loses
  /// no more than this span.
  std::uint64_t chunk_span = 1'000'000'000;
  /// The compression of all channels; nullopt: the compression of their groups.
  std::optional<Compression> compression;
  int lz4_level = 0;  // from 3 on slower, with smaller files
  /// Level -1 has no entropy coding: joint states are 2 % larger than at level 1, and decompressed in a third of the
  /// time. Level 3 takes three times as long and makes them no smaller.
  int zstd_level = -1;
  /// Largest number of finished chunks that wait for the writer thread; beyond it write() waits, too. It bounds the
  /// memory.
  std::size_t queue_length = 4;
  /// The index of the chunks is kept in memory up to this size [bytes]. A larger index is made at the end from the
  /// chunks in the file. A pipe can't be read again: for a pipe the whole index is kept.
  std::size_t index_size = std::size_t{1} << 20;
  /// close() compares the file with the written bytes, and fails if something else has changed the file.
  bool verified = false;
  /// False: chunks and the data section have no CRC. For a file that this process alone reads.
  bool crcs = true;
};

/// How the messages of a channel are stored. Channels with equal values share chunks.
struct ChunkGroup {
  int id = 0;
  Compression compression = Compression::zstd;
};
/// For numbers: many small messages, similar to each other.
inline constexpr ChunkGroup numbers{0, Compression::zstd};
/// For pictures and other data that is already compressed.
inline constexpr ChunkGroup pictures{1, Compression::none};

/// Makes the data of a message from raw data, and from nothing else; throws nothing.
using Compose = std::vector<std::byte> (*)(Bytes raw);

/// Writes one file from front to back; it never seeks. Every call may return the error of an earlier call (a full disk
/// is reported late). After an error nothing more is written. A Writer that is destroyed without close(), or a process
/// that is killed, leaves a file without summary, readable up to the last finished chunk.
class Writer {
 public:
  /// Creates the file, or replaces it: processes that have the old file open keep its contents, unless it has a second
  /// name or a different owner. Links, pipes and devices are written into. Fails if the file can't be opened.
  static Result<std::unique_ptr<Writer>> create(const std::filesystem::path& file, WriterOptions options = {});
  virtual ~Writer() = default;
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// Adds a schema and returns its id (from 1). The same name, encoding and data return the same id again. A file can
  /// contain 65535 schemas; for one more it returns 0, and every later call returns an error.
  virtual std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view data) = 0;

  /// Adds a channel and returns its id (from 1). `schema` is 0 or an id of add_schema. A file can contain 65536
  /// channels, the last with the id 0; after one more every later call returns an error.
  virtual std::uint16_t add_channel(std::uint16_t schema, std::string_view topic, std::string_view message_encoding,
                                    StringMap metadata = {}, ChunkGroup group = numbers) = 0;

  /// Copies the message into the open chunk of its channel's group. Takes tens of nanoseconds, unless the queue is
  /// full. `sequence`: for messages that already have a number; else they are counted from 0 on each channel.
  virtual Result<void> write(std::uint16_t channel, std::uint64_t log_time_ns, std::uint64_t publish_time_ns,
                             Bytes data, std::optional<std::uint32_t> sequence = {}) = 0;

  /// Adds a message that takes long to compose, as a picture to encode. The Writer's thread calls `compose` once, when
  /// the chunk is finished. `held`: the size [bytes] by which the message counts until then.
  virtual Result<void> write_later(std::uint16_t channel, std::uint64_t log_time_ns, std::uint64_t publish_time_ns,
                                   std::size_t held, std::vector<std::byte> raw, Compose compose) = 0;

  /// Copies a chunk of another file behind the finished chunks; the ids of its channels must be those of this file. The
  /// messages written next on these channels are numbered after its messages. A kill loses copies that wait in the
  /// queue.
  virtual Result<void> copy_chunk(const StoredChunk& chunk) = 0;

  /// Adds an attachment. Unknown times are 0, never the wall clock's time.
  virtual Result<void> add_attachment(std::string_view name, std::string_view media_type, Bytes data,
                                      std::uint64_t log_time_ns = 0, std::uint64_t create_time_ns = 0) = 0;

  virtual Result<void> add_metadata(std::string_view name, const StringMap& values) = 0;

  /// Finishes the open chunks and waits until all of them are in the file. It changes the bytes of the file, because
  /// the chunks end here. For use before a step that may crash the process.
  virtual Result<void> flush() = 0;

  /// Finishes the open chunks, writes the summary and closes the file. No data may be added afterwards; a second
  /// close() returns the result of the first.
  virtual Result<void> close() = 0;

  /// The file descriptor until close(); -1 if another process writes the file.
  virtual int descriptor() const = 0;

  /// The log time from which on a message makes the Writer wait until the earliest open chunk is in the file [ns]; the
  /// largest number: no chunk is open.
  virtual std::uint64_t deadline() const = 0;

  /// True if close() failed because something else has changed the file.
  virtual bool is_changed_by_others() const = 0;

 protected:
  Writer() = default;
};

/// The way in which a Reader finds the contents of a file.
enum class Opening {
  walk,        // reads every outermost record: finds all damage of the frame, and reads no message
  by_summary,  // reads the summary if it is whole and consistent; else as `walk`
};

struct ReaderOptions {
  bool check_crcs = true;
  Opening opening = Opening::walk;
  /// A chunk whose stated decompressed size is larger is refused as damaged [bytes].
  std::uint64_t max_chunk_size = std::uint64_t{1} << 30;
};

/// Reads one log: an MCAP file, a rosbag2 folder with all of its files, a database of rosbag2 (.db3), or such a file
/// compressed by zstd. All but the first are converted to an MCAP file in the folder for temporary files (TMPDIR).
/// open() fails only if nothing can be read: the file doesn't exist, is no log or is not a file (a device). A pipe
/// counts as a file; so does standard input, named "-". A file that is cut or damaged opens: damage() reports the
/// place, passes deliver all undamaged messages and then return the damage that they found.
class Reader {
 public:
  using OnMessage = std::function<bool(const Message&)>;  // false: stop

  /// Maps the file in its present size, and reads its outermost records. It reads no chunks, except for channels if
  /// there is no summary.
  static Result<std::unique_ptr<Reader>> open(const std::filesystem::path& file, ReaderOptions options = {});
  /// Opens bytes that outlive the Reader; `name` is their name in diagnostics.
  static Result<std::unique_ptr<Reader>> open_bytes(Bytes bytes, std::string name, ReaderOptions options = {});
  ~Reader();
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  const std::string& name() const;     // as the user named the file
  const std::string& profile() const;  // profile in the header
  const std::string& library() const;  // library in the header: it wrote the file
  std::uint64_t size() const;          // size of the log's own files [bytes]
  const std::string& form() const;     // "MCAP", or the container from which it was converted

  /// True if open() read only the summary. The first pass over all messages then makes the walk: until then damage()
  /// is empty, and an attachment's CRC isn't checked. That pass reports the findings of the walk.
  bool opened_by_summary() const;

  /// The findings of the walk: cut at byte N, summary damaged, ... Empty: the file's frame is whole.
  const Diagnostics& damage() const;

  const std::map<std::uint16_t, Schema>& schemas() const;
  const std::map<std::uint16_t, Channel>& channels() const;
  /// The schema of a channel; null if it has none.
  const Schema* schema_of(const Channel& channel) const;
  const std::vector<Attachment>& attachments() const;
  const std::vector<Metadata>& metadata() const;
  const std::vector<Chunk>& chunks() const;             // in file order
  const std::optional<Statistics>& statistics() const;  // nullopt: the file has no statistics

  /// Delivers every message of the chosen channels (all if empty) in file order. A chunk whose CRC is wrong is left out
  /// whole. A pass that isn't stopped also checks the data section's CRC. Its errors include damage().
  Result<void> for_each_message(const OnMessage& callback, std::span<const std::uint16_t> channels = {});

  /// Delivers the messages in order of (log time, position in the file), also if chunks overlap in time. Overlapping
  /// chunks are kept in memory.
  Result<void> for_each_message_in_order(const OnMessage& callback, std::span<const std::uint16_t> channels = {});

  /// Reads one message again. Its data is valid until the next call of any function of this Reader.
  Result<Message> message_at(const Location& location);

  /// True if chunks may be copied without a look at their messages: the file isn't damaged, the CRC of its data section
  /// matches, and its message indexes list as many messages as its statistics. Reads the whole file once.
  bool can_copy_chunks();
  /// A chunk of chunks(), as it is stored. Its bytes are valid until the next call. nullopt: it is damaged.
  std::optional<StoredChunk> stored_chunk(const Chunk& chunk);

  class Impl;
  Impl& impl() const { return *impl_; }  // internal

 private:
  explicit Reader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// The messages of a file in order of (log time, position in the file), one at a time, also if chunks overlap in time.
/// Overlapping chunks are kept in memory.
class OrderedMessages {
 public:
  /// Delivers the messages of the chosen channels (all if empty) whose log time is `from` [ns] or later; a chunk that
  /// states an earlier end isn't read. The reader must outlive this.
  explicit OrderedMessages(Reader& reader, std::span<const std::uint16_t> channels = {}, std::uint64_t from = 0);
  ~OrderedMessages();
  OrderedMessages(const OrderedMessages&) = delete;
  OrderedMessages& operator=(const OrderedMessages&) = delete;

  /// The next message, valid until the next call; null after the last.
  const Message* next();
  /// All damage so far, the reader's included. After the last message it also includes a mismatch of the data section's
  /// CRC.
  Result<void> verdict();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rehearse::mcap
