#include <rehearse/logs.h>

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <deque>
#include <map>
#include <mutex>
#include <tuple>
#include <utility>

#include "bag_folder.h"
#include "base/text.h"
#include "core/mcap/codec.h"
#include "core/mcap/container.h"
#include "ros1_bag.h"
#include "sqlite_bag.h"
#include "standard_types.h"

namespace rehearse::bag {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kept_conversions = 8;
/// A file that decompresses to more than this multiple of its size is refused. Logs of joints reach 30.
constexpr std::uint64_t largest_ratio = 1000;
constexpr std::uint64_t always_allowed = std::uint64_t{64} << 20;  // decompressed size that no ratio limits [bytes]
constexpr std::uint64_t largest_message = std::uint64_t{1} << 30;  // decompressed [bytes]

Diagnostic not_kept(const std::string& name, const TemporaryFile& file, std::string_view why) {
  return error_in(name, fmt::format("can't convert it to MCAP in {}: {}", file.folder(), why),
                  "TMPDIR is the folder for temporary files");
}

/// Large messages that are compressed already, or that compression hardly reduces, get chunks of their own.
mcap::ChunkGroup group_of(std::string_view type) {
  for (const std::string_view large : {"Image", "PointCloud", "OccupancyGrid", "Packet"})
    if (type.find(large) != std::string_view::npos) return {1, mcap::Compression::none};
  return {0, mcap::Compression::lz4};
}

/// Copies the messages of one log after the other into a new MCAP file.
class LogCopy {
 public:
  static Result<std::unique_ptr<LogCopy>> begin(mcap::Converted& target, const std::string& name,
                                                const std::string& library, const std::string& profile = "ros2");

  /// Decompresses all messages that are compressed by zstd.
  void decompress_messages() { decompresses_ = true; }
  Result<void> add(mcap::Reader& log);
  Result<void> add(SqliteBag& log);
  Result<void> add(Ros1Bag& log);
  Result<void> finish();

 private:
  using Key =
      std::tuple<std::string, std::string, std::uint16_t, mcap::StringMap>;  // topic, encoding, schema, metadata

  LogCopy(mcap::Converted& target, std::string name, std::unique_ptr<mcap::Writer> writer)
      : target_(target), name_(std::move(name)), writer_(std::move(writer)) {}
  std::uint16_t channel_of(std::uint16_t schema, std::string_view type, const std::string& topic,
                           const std::string& encoding, const mcap::StringMap& metadata);
  std::uint16_t schema_of(const SqliteBag& log, const std::string& type);
  Result<void> write(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time, mcap::Bytes data,
                     std::optional<std::uint32_t> sequence);
  mcap::Converted& target_;
  std::string name_;
  std::unique_ptr<mcap::Writer> writer_;
  std::map<Key, std::uint16_t> channels_;
  bool decompresses_ = false;
  mcap::Decompressor decompressor_;
  mcap::RawBuffer buffer_;
};

Result<std::unique_ptr<LogCopy>> LogCopy::begin(mcap::Converted& target, const std::string& name,
                                                const std::string& library, const std::string& profile) {
  if (target.file->descriptor() < 0) return not_kept(name, *target.file, std::strerror(errno));
  mcap::WriterOptions form;
  form.library = library;
  form.profile = profile;
  form.crcs = false;  // the file is read by this process alone
  auto writer = mcap::Writer::create(target.file->path(), form);
  if (!writer) return not_kept(name, *target.file, writer.errors().front().message);
  return std::unique_ptr<LogCopy>(new LogCopy(target, name, std::move(*writer)));
}

std::uint16_t LogCopy::channel_of(std::uint16_t schema, std::string_view type, const std::string& topic,
                                  const std::string& encoding, const mcap::StringMap& metadata) {
  const auto [known, is_new] = channels_.try_emplace(Key{topic, encoding, schema, metadata}, 0);
  if (is_new) known->second = writer_->add_channel(schema, topic, encoding, metadata, group_of(type));
  return known->second;
}

Result<void> LogCopy::write(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time, mcap::Bytes data,
                            std::optional<std::uint32_t> sequence) {
  // No message of CDR begins with the magic bytes of zstd.
  if (decompresses_ && mcap::container_of(data) == mcap::Container::zstd) {
    auto whole = decompressor_.decompress_frame(data, largest_message, buffer_);
    if (whole) {
      data = *whole;
    } else if (target_.damage.empty()) {
      target_.add_damage(
          {error_in(name_, fmt::format("a message can't be decompressed: {}", whole.errors()[0].message))}, 0);
    }
  }
  const auto done = writer_->write(channel, log_time, publish_time, data, sequence);
  return done ? done : not_kept(name_, *target_.file, done.errors().front().message);
}

Result<void> LogCopy::add(mcap::Reader& log) {
  std::map<std::uint16_t, std::uint16_t> ids;
  for (const auto& [id, channel] : log.channels()) {
    const mcap::Schema* schema = log.schema_of(channel);
    const std::uint16_t copied = schema ? writer_->add_schema(schema->name, schema->encoding, schema->data) : 0;
    ids[id] = channel_of(copied, schema ? schema->name : "", channel.topic, channel.message_encoding, channel.metadata);
  }
  for (const mcap::Attachment& attachment : log.attachments())
    if (auto done = writer_->add_attachment(attachment.name, attachment.media_type, attachment.data,
                                            attachment.log_time, attachment.create_time);
        !done)
      return not_kept(name_, *target_.file, done.errors().front().message);
  for (const mcap::Metadata& record : log.metadata())
    if (auto done = writer_->add_metadata(record.name, record.values); !done)
      return not_kept(name_, *target_.file, done.errors().front().message);
  Result<void> written;
  const Result<void> read = log.for_each_message([&](const mcap::Message& message) {
    written =
        write(ids.at(message.channel->id), message.log_time, message.publish_time, message.data, message.sequence);
    return written.ok();
  });
  if (!read) target_.add_damage(read.errors(), std::nullopt);
  return written;
}

/// The definition from the log; else the definition of the standard packages; else the name alone.
std::uint16_t LogCopy::schema_of(const SqliteBag& log, const std::string& type) {
  if (type.empty()) return 0;
  if (const Definition* own = log.definition_of(type)) return writer_->add_schema(type, own->encoding, own->text);
  const auto standard = standard_definition(type);
  return writer_->add_schema(type, standard ? "ros2msg" : "", standard.value_or(""));
}

Result<void> LogCopy::add(SqliteBag& log) {
  std::vector<std::uint16_t> ids;
  for (const Topic& topic : log.topics()) {
    mcap::StringMap metadata;
    if (!topic.qos_profiles.empty()) metadata["offered_qos_profiles"] = topic.qos_profiles;
    ids.push_back(channel_of(schema_of(log, topic.type), topic.type, topic.name, topic.serialization_format, metadata));
  }
  decompress_messages();
  bool failed = false;
  const Result<void> read = log.for_each_message([&](const Message& message) {
    auto written = write(ids[message.topic], message.time, message.time, message.data, std::nullopt);
    failed = !written;
    return written;
  });
  if (failed) return read;
  if (!read) target_.add_damage(read.errors(), log.lost_messages());
  return {};
}

Result<void> LogCopy::add(Ros1Bag& log) {
  std::map<std::uint32_t, std::uint16_t> ids;
  bool failed = false;
  const Result<void> read = log.for_each_message(
      [&](const Ros1Connection& connection) {
        const auto schema = writer_->add_schema(connection.type, "ros1msg", connection.definition);
        ids[connection.id] = channel_of(schema, connection.type, connection.topic, "ros1", connection.details);
      },
      [&](std::uint32_t connection, std::uint64_t time, mcap::Bytes data) {
        auto written = write(ids.at(connection), time, time, data, std::nullopt);
        failed = !written;
        return written;
      });
  if (failed) return read;
  if (!read) target_.add_damage(read.errors(), std::nullopt);
  return {};
}

Result<void> LogCopy::finish() {
  const auto done = writer_->close();
  return done ? done : not_kept(name_, *target_.file, done.errors().front().message);
}

/// The last conversions, each with its source files.
class Conversions {
 public:
  template <class Make>
  Result<mcap::ConvertedPtr> find_or_make(const std::string& key, Make&& make) {
    const std::scoped_lock lock(mutex_);
    for (const auto& [made_of, conversion] : kept_)
      if (!key.empty() && made_of == key) return conversion;
    const auto made = std::make_shared<mcap::Converted>();
    REHEARSE_TRY(make(*made));
    if (!key.empty()) kept_.emplace_back(key, made);
    if (kept_.size() > kept_conversions) kept_.pop_front();
    return mcap::ConvertedPtr(made);
  }

 private:
  std::recursive_mutex mutex_;  // the conversion of a folder opens its files
  std::deque<std::pair<std::string, mcap::ConvertedPtr>> kept_;
};

Conversions& conversions() {
  static Conversions all;
  return all;
}

/// The file's identity, size and time; empty if the file's status can't be read.
std::string identity_of(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return "";
  return fmt::format("{}:{}:{}:{}.{};", status.st_dev, status.st_ino, status.st_size, status.st_mtim.tv_sec,
                     status.st_mtim.tv_nsec);
}

/// The identities of a database and of the files beside it.
std::string identity_of_database(const fs::path& file) {
  std::string identity;
  for (const fs::path& part : SqliteBag::files_of(file)) identity += identity_of(part);
  return identity;
}

std::uint64_t size_of_database(const fs::path& file) {
  std::uint64_t size = 0;
  std::error_code ignored;
  for (const fs::path& part : SqliteBag::files_of(file)) size += fs::file_size(part, ignored);
  return size;
}

/// A name of a file for SQLite, which doesn't open nameless files. An added name is removed with the object.
class DatabaseName {
 public:
  explicit DatabaseName(const fs::path& file) : path_(file) {
    if (!file.string().starts_with("/proc/self/fd/")) return;
    static std::atomic<int> count{0};
    std::error_code none;
    const fs::path name =
        fs::temp_directory_path(none) / fmt::format("rehearse.{}.{}.db3", ::getpid(), count.fetch_add(1));
    if (none || ::linkat(AT_FDCWD, file.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0) return;
    path_ = name;
    added_ = true;
  }
  ~DatabaseName() {
    if (added_) ::unlink(path_.c_str());
  }
  DatabaseName(const DatabaseName&) = delete;
  DatabaseName& operator=(const DatabaseName&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
  bool added_ = false;
};

Result<void> convert_database(mcap::Converted& converted, const std::string& name, const fs::path& file) {
  const DatabaseName named(file);
  auto log = REHEARSE_TRY(SqliteBag::open(named.path(), name));
  converted.form = fmt::format("rosbag2 database (SQLite, schema version {})", log->schema_version());
  auto copy = REHEARSE_TRY(LogCopy::begin(converted, name, "rosbag2 sqlite3"));
  REHEARSE_TRY(copy->add(*log));
  return copy->finish();
}

Result<void> convert_ros1(mcap::Converted& converted, const std::string& name, mcap::Bytes bytes) {
  auto log = REHEARSE_TRY(Ros1Bag::open(bytes, name));
  converted.form = "bag of ROS 1 (version 2.0)";
  auto copy = REHEARSE_TRY(LogCopy::begin(converted, name, "rosbag", "ros1"));
  REHEARSE_TRY(copy->add(*log));
  return copy->finish();
}

/// Decompresses the file into the temporary file of `plain`. A stream that is cut is damage.
Result<void> decompress(mcap::Converted& plain, const std::string& name, mcap::Bytes bytes) {
  if (plain.file->descriptor() < 0) return not_kept(name, *plain.file, std::strerror(errno));
  const std::uint64_t most = std::max(always_allowed, bytes.size() * largest_ratio);
  std::uint64_t size = 0;
  Result<void> stored;
  const Result<void> whole = mcap::decompress_frames(bytes, [&](mcap::Bytes piece) {
    size += piece.size();
    if (size > most)
      stored = error_in(name, fmt::format("it decompresses to more than {} times its size", largest_ratio),
                        "zstd -d decompresses it nevertheless");
    else if (!plain.file->append(piece))
      stored = not_kept(name, *plain.file, std::strerror(errno));
    return stored.ok();
  });
  if (!whole) plain.add_damage({error_in(name, whole.errors().front().message)}, std::nullopt);
  return stored;
}

Result<void> convert_compressed(mcap::Converted& converted, const std::string& name, mcap::Bytes bytes) {
  REHEARSE_TRY(decompress(converted, name, bytes));
  std::vector<std::byte> start(16);
  start.resize(std::max<ssize_t>(0, ::pread(converted.file->descriptor(), start.data(), start.size(), 0)));
  const mcap::Container inner = mcap::container_of(start);
  if (inner == mcap::Container::mcap) {
    converted.form = "MCAP, compressed by zstd";
    return {};
  }
  if (inner != mcap::Container::sqlite) {
    Diagnostics problems{error_in(name, "the content decompressed by zstd is neither MCAP nor a database of rosbag2")};
    problems.insert(problems.end(), converted.damage.begin(), converted.damage.end());
    return problems;
  }
  const std::unique_ptr<TemporaryFile> plain = std::exchange(converted.file, std::make_unique<TemporaryFile>());
  REHEARSE_TRY(convert_database(converted, name, plain->path()));
  converted.form += ", compressed by zstd";
  return {};
}

/// Converts all files of a folder to one file.
Result<void> join(mcap::Converted& converted, const Folder& folder, const std::string& name) {
  converted.form =
      fmt::format("rosbag2 folder{} ({} {} of {})", folder.metadata.empty() ? " without metadata.yaml" : "",
                  folder.files.size(), folder.files.size() == 1 ? "file" : "files", folder.storage);
  auto copy = REHEARSE_TRY(LogCopy::begin(converted, name, "rosbag2 " + folder.storage));
  if (folder.compressed_messages) copy->decompress_messages();
  for (const fs::path& file : folder.files) {
    converted.size += size_of_database(file);
    if (folder.storage == "sqlite3" && file.extension() == ".db3") {
      auto log = REHEARSE_TRY(SqliteBag::open(file, file.string()));
      REHEARSE_TRY(copy->add(*log));
    } else {
      auto log = REHEARSE_TRY(mcap::Reader::open(file));
      REHEARSE_TRY(copy->add(*log));
    }
  }
  return copy->finish();
}

Result<mcap::ConvertedPtr> convert_folder(const Folder& folder, const std::string& name) {
  std::string key = folder.metadata.empty() ? "" : identity_of(folder.metadata);
  for (const fs::path& file : folder.files) key += identity_of_database(file);
  return conversions().find_or_make(key, [&](mcap::Converted& converted) { return join(converted, folder, name); });
}

class BagReader : public mcap::ContainerReader {
 public:
  Result<mcap::ConvertedPtr> convert_file(mcap::Container container, mcap::Bytes bytes, const std::string& name,
                                          const fs::path& path) const override {
    return conversions().find_or_make(identity_of_database(path), [&](mcap::Converted& converted) {
      converted.size = container == mcap::Container::sqlite ? size_of_database(path) : bytes.size();
      if (container == mcap::Container::ros1_bag) return convert_ros1(converted, name, bytes);
      return container == mcap::Container::sqlite ? convert_database(converted, name, path)
                                                  : convert_compressed(converted, name, bytes);
    });
  }

  Result<mcap::OpenedFolder> open_folder(const fs::path& path, const std::string& name) const override {
    const auto folder = REHEARSE_TRY(read_folder(path));
    if (folder.files.size() == 1 && !folder.compressed_messages) return mcap::OpenedFolder{folder.files[0], nullptr};
    auto converted = REHEARSE_TRY(convert_folder(folder, name));
    return mcap::OpenedFolder{{}, std::move(converted)};
  }
};

}  // namespace
}  // namespace rehearse::bag

namespace rehearse {

void read_rosbag2_logs() {
  static const bag::BagReader reader;
  mcap::set_container_reader(reader);
}

/// For programs that load the library with the first log that needs it.
extern "C" void rehearse_read_logs() { read_rosbag2_logs(); }

}  // namespace rehearse
