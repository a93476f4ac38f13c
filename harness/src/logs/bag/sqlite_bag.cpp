#include "sqlite_bag.h"

#include <fmt/format.h>
#include <sqlite3.h>
#include <stdlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/text.h"

namespace rehearse::bag {

namespace {

constexpr int longest_value = 1 << 30;  // limit of a message [bytes]
constexpr std::size_t most_topics = 0xffff;
constexpr std::size_t most_findings = 20;

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
};
struct EndStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, EndStatement>;

std::uint64_t size_or_zero(const std::filesystem::path& file) {
  std::error_code missing;
  const std::uintmax_t size = std::filesystem::file_size(file, missing);
  return missing ? 0 : size;
}

constexpr const char* side_files[] = {"-wal", "-journal"};  // changes that the database doesn't contain yet

std::filesystem::path beside(const std::filesystem::path& file, const char* suffix) {
  std::filesystem::path path = file;
  return path += suffix;
}

/// A copy of a database and its side files, because SQLite writes into a database whose side files it reads.
class OwnCopy {
 public:
  OwnCopy() = default;
  ~OwnCopy() { remove(); }
  OwnCopy(const OwnCopy&) = delete;
  OwnCopy& operator=(const OwnCopy&) = delete;

  Result<std::filesystem::path> make(const std::filesystem::path& file, const std::string& name);
  /// Removes the names; an open database keeps its data.
  void remove() {
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
    folder_.clear();
  }

 private:
  std::filesystem::path folder_;
};

Result<std::filesystem::path> OwnCopy::make(const std::filesystem::path& file, const std::string& name) {
  namespace fs = std::filesystem;
  std::error_code failed;
  const fs::path temporary = fs::temp_directory_path(failed);
  std::string folder = (temporary / "rehearse.XXXXXX").string();
  if (!failed && ::mkdtemp(folder.data()) == nullptr) failed = std::error_code(errno, std::generic_category());
  if (!failed) folder_ = folder;
  const fs::path copy = folder_ / "copy.db3";
  const auto take = [&failed](const fs::path& from, const fs::path& to) {
    if (!failed) fs::copy_file(from, to, failed);
    if (!failed) fs::permissions(to, fs::perms::owner_read | fs::perms::owner_write, failed);
  };
  take(file, copy);
  for (const char* suffix : side_files)
    if (const fs::path side = beside(file, suffix); !failed && size_or_zero(side) > 0) take(side, beside(copy, suffix));
  if (!failed) return copy;
  return error_in(
      name, fmt::format("can't copy it and the changes beside it to {}: {}", temporary.string(), failed.message()),
      "TMPDIR is the folder for temporary files");
}

/// True if the header states the journal mode WAL.
bool is_in_wal_mode(const std::filesystem::path& file) {
  constexpr std::size_t at = 18;  // versions for writing and for reading
  std::array<char, at + 2> start{};
  std::ifstream(file, std::ios::binary).read(start.data(), start.size());
  return start[at] == 2 || start[at + 1] == 2;
}

/// The name of a file that nobody changes, for SQLite, which then creates no file beside it.
std::string immutable_name(const std::filesystem::path& file) {
  std::string name = "file:";
  for (const char c : std::filesystem::absolute(file).string())
    name += c == '%' || c == '?' || c == '#' ? fmt::format("%{:02x}", c) : std::string(1, c);
  return name + "?immutable=1";
}

/// True if rows after the one with this status may be readable.
bool is_damage(int status) {
  constexpr int primary = 0xff;
  switch (status & primary) {
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
    case SQLITE_IOERR:
    case SQLITE_TOOBIG: return true;
    default: return false;
  }
}

std::string text_at(sqlite3_stmt* row, int column) {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
  return text == nullptr ? std::string() : std::string(text, sqlite3_column_bytes(row, column));
}

constexpr std::string_view event_suffix = "_Event";

/// The type of a topic's messages: of a topic whose type is a service, the type of the service's events.
std::string message_type_of(std::string type) {
  if (type.find("/srv/") == std::string::npos) return type;
  for (const std::string_view suffix : {event_suffix, std::string_view("_Request"), std::string_view("_Response")})
    if (type.ends_with(suffix)) return type;
  return type.append(event_suffix);
}

/// Row ids of a part of the table that can't be read.
struct UnreadRows {
  std::int64_t first = 0;
  std::int64_t last = 0;  // the largest number: to the end of the table
};
constexpr std::int64_t no_end = std::numeric_limits<std::int64_t>::max();

/// The rows of the table of messages from a row on, in their order.
class RowCursor {
 public:
  explicit RowCursor(Statement statement) : statement_(std::move(statement)) {}

  sqlite3_stmt* row() const { return statement_.get(); }
  void seek(std::int64_t id) {
    sqlite3_reset(row());
    sqlite3_bind_int64(row(), 1, id);
  }
  /// The first row id after `bad`, which can't be read, from which on rows can be read; nullopt: there is none.
  std::optional<std::int64_t> readable_after(std::int64_t bad);

 private:
  bool reads_from(std::int64_t id) {
    seek(id);
    return !is_damage(sqlite3_step(row()));
  }

  Statement statement_;
};

std::optional<std::int64_t> RowCursor::readable_after(std::int64_t bad) {
  constexpr int single_steps = 1000;   // more rows than a page has
  constexpr std::int64_t growth = 64;  // afterwards a step is this fraction of the passed rows
  const std::int64_t first = bad;
  for (int tries = 0;; ++tries) {
    const std::int64_t step = tries < single_steps ? 1 : (bad - first) / growth;
    if (bad > no_end - step) return std::nullopt;
    std::int64_t good = bad + step;
    if (!reads_from(good)) {
      bad = good;
      continue;
    }
    while (good - bad > 1) {
      const std::int64_t middle = bad + (good - bad) / 2;
      (reads_from(middle) ? good : bad) = middle;
    }
    return good;
  }
}

/// The place of unread rows, for a message.
std::string place_of(const std::vector<UnreadRows>& unread) {
  const auto [first, last] = unread.front();
  std::string text = last == no_end  ? fmt::format("from row {} on", first)
                     : last == first ? fmt::format("row {}", first)
                                     : fmt::format("rows {} to {}", first, last);
  return unread.size() == 1 ? text : fmt::format("in {} places, the first: {}", unread.size(), text);
}

}  // namespace

struct SqliteBag::Impl {
  std::string name;
  OwnCopy copy;
  Database database;
  int schema_version = 1;
  std::vector<Topic> topics;
  std::map<std::int64_t, std::size_t> topic_index;  // by id
  std::map<std::string, Definition> definitions;
  std::optional<std::uint64_t> lost_messages = 0;

  Diagnostic wrong(std::string message, std::string hint = {}) const {
    return error_in(name, std::move(message), std::move(hint));
  }
  Diagnostic failed(std::string_view what) const {
    return wrong(fmt::format("{}: SQLite reports: {}", what, sqlite3_errmsg(database.get())));
  }

  Result<void> open(const std::filesystem::path& file);
  Result<Statement> prepare(const std::string& query) const;
  Result<std::set<std::string>> columns_of(const std::string& table) const;
  Result<void> check_tables();
  Result<void> read_topics();
  Result<void> read_definitions();
  std::optional<std::uint64_t> rows_in_index() const;
  std::optional<std::uint64_t> count_unread(const std::vector<UnreadRows>& unread, std::uint64_t read) const;
};

Result<void> SqliteBag::Impl::open(const std::filesystem::path& file) {
  std::string opened_name = file.string();
  int mode = SQLITE_OPEN_READONLY;
  if (files_of(file).size() > 1) {
    const auto copied = REHEARSE_TRY(copy.make(file, name));
    opened_name = copied.string();
    mode = SQLITE_OPEN_READWRITE;
  } else if (is_in_wal_mode(file)) {
    opened_name = immutable_name(file);
    mode |= SQLITE_OPEN_URI;
  }
  sqlite3* opened = nullptr;
  const int status = sqlite3_open_v2(opened_name.c_str(), &opened, mode | SQLITE_OPEN_NOMUTEX, nullptr);
  database.reset(opened);
  if (status != SQLITE_OK) return failed("the database can't be opened");
  // The file is foreign: its schema must not run functions, and a damaged page must be noticed. A file that is shorter
  // than it states is only read with a writable schema; nothing is written.
  sqlite3_db_config(opened, SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, longest_value);
  sqlite3_exec(opened, "PRAGMA cell_size_check = ON", nullptr, nullptr, nullptr);
  if (mode == SQLITE_OPEN_READWRITE) {
    sqlite3_exec(opened, "PRAGMA locking_mode = EXCLUSIVE", nullptr, nullptr, nullptr);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  }
  const auto tables = check_tables();  // opens the side files, too
  copy.remove();
  if (!tables) return tables;
  REHEARSE_TRY(read_topics());
  return read_definitions();
}

Result<Statement> SqliteBag::Impl::prepare(const std::string& query) const {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database.get(), query.c_str(), -1, &statement, nullptr) != SQLITE_OK)
    return failed("it can't be read");
  return Statement(statement);
}

/// The columns of a table; none if there is no such table.
Result<std::set<std::string>> SqliteBag::Impl::columns_of(const std::string& table) const {
  std::set<std::string> columns;
  auto statement = REHEARSE_TRY(prepare(fmt::format("SELECT name FROM pragma_table_info('{}')", table)));
  int status = SQLITE_ROW;
  while ((status = sqlite3_step(statement.get())) == SQLITE_ROW) columns.insert(text_at(statement.get(), 0));
  if (status != SQLITE_DONE) return failed("it can't be read");
  return columns;
}

Result<void> SqliteBag::Impl::check_tables() {
  const std::pair<const char*, std::vector<const char*>> needed[] = {
      {"topics", {"id", "name", "type", "serialization_format"}}, {"messages", {"topic_id", "timestamp", "data"}}};
  for (const auto& [table, all] : needed) {
    const auto columns = REHEARSE_TRY(columns_of(table));
    if (columns.empty())
      return wrong(fmt::format("the database has no table '{}'", table), "expected a .db3 file of rosbag2");
    for (const char* column : all)
      if (!columns.contains(column))
        return wrong(fmt::format("the table '{}' has no column '{}'", table, column),
                     "expected a .db3 file of rosbag2");
  }
  const auto topics = columns_of("topics");
  const auto definitions = columns_of("message_definitions");
  const auto metadata = columns_of("metadata");
  if (!topics || !definitions || !metadata) return failed("it can't be read");
  if (topics->contains("offered_qos_profiles")) schema_version = 2;
  if (!metadata->empty()) schema_version = 3;
  if (!definitions->empty()) schema_version = 4;
  return {};
}

Result<void> SqliteBag::Impl::read_topics() {
  const char* profiles = schema_version >= 2 ? "offered_qos_profiles" : "''";
  auto statement = REHEARSE_TRY(
      prepare(fmt::format("SELECT id, name, type, serialization_format, {} FROM topics ORDER BY id", profiles)));
  sqlite3_stmt* row = statement.get();
  int status = SQLITE_ROW;
  while ((status = sqlite3_step(row)) == SQLITE_ROW) {
    if (topics.size() == most_topics) return wrong(fmt::format("it has more than {} topics", most_topics));
    topic_index[sqlite3_column_int64(row, 0)] = topics.size();
    topics.push_back({text_at(row, 1), message_type_of(text_at(row, 2)), text_at(row, 3), text_at(row, 4)});
  }
  if (status != SQLITE_DONE) return failed("its topics can't be read");
  return {};
}

Result<void> SqliteBag::Impl::read_definitions() {
  if (schema_version < 4) return {};
  auto statement =
      REHEARSE_TRY(prepare("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"));
  sqlite3_stmt* row = statement.get();
  int status = SQLITE_ROW;
  while ((status = sqlite3_step(row)) == SQLITE_ROW)
    definitions.emplace(text_at(row, 0), Definition{text_at(row, 1), text_at(row, 2)});
  if (status != SQLITE_DONE) return failed("its message definitions can't be read");
  return {};
}

/// The number of messages by rosbag2's index of their times, which has pages of its own.
std::optional<std::uint64_t> SqliteBag::Impl::rows_in_index() const {
  const auto statement = prepare("SELECT count(*) FROM messages INDEXED BY timestamp_idx");
  if (!statement || sqlite3_step(statement->get()) != SQLITE_ROW) return std::nullopt;
  return static_cast<std::uint64_t>(sqlite3_column_int64(statement->get(), 0));
}

/// The number of messages in unread rows, of a table of which `read` rows were read. rosbag2 numbers rows without gaps.
std::optional<std::uint64_t> SqliteBag::Impl::count_unread(const std::vector<UnreadRows>& unread,
                                                           std::uint64_t read) const {
  if (unread.empty()) return 0;
  if (const auto all = rows_in_index(); all && *all >= read) return *all - read;
  if (unread.back().last == no_end) return std::nullopt;
  std::uint64_t count = 0;
  for (const UnreadRows& rows : unread) count += static_cast<std::uint64_t>(rows.last - rows.first) + 1;
  return count;
}

Result<void> SqliteBag::for_each_message(const OnMessage& callback) {
  auto statement = REHEARSE_TRY(
      impl_->prepare("SELECT rowid, topic_id, timestamp, data FROM messages WHERE rowid >= ? ORDER BY rowid"));
  RowCursor cursor(std::move(statement));
  sqlite3_stmt* row = cursor.row();
  std::map<std::string, std::pair<std::uint64_t, std::int64_t>> wrong_rows;  // number and first row, by reason
  std::uint64_t read = 0, left_out = 0;
  const auto leave_out = [&](std::string reason, std::int64_t id) {
    ++wrong_rows.try_emplace(std::move(reason), 0, id).first->second.first;
    ++left_out;
  };
  Diagnostics problems;
  std::vector<UnreadRows> unread;
  std::string damage;
  std::int64_t next = std::numeric_limits<std::int64_t>::min();  // rows before it are done
  cursor.seek(next);
  while (true) {
    const int status = sqlite3_step(row);
    Message message;
    message.id = status == SQLITE_ROW ? sqlite3_column_int64(row, 0) : 0;
    if (status == SQLITE_DONE) break;
    if (status != SQLITE_ROW && !is_damage(status)) {
      problems.push_back(impl_->failed("not all of its messages can be read"));
      break;
    }
    if (status != SQLITE_ROW || message.id < next) {
      if (unread.empty()) damage = sqlite3_errstr(status == SQLITE_ROW ? SQLITE_CORRUPT : status);
      next = std::max<std::int64_t>(next, 1);
      const auto readable = cursor.readable_after(next);
      unread.push_back({next, readable ? *readable - 1 : no_end});
      if (!readable) break;
      next = *readable;
      cursor.seek(next);
      continue;
    }
    ++read;
    const auto topic = impl_->topic_index.find(sqlite3_column_int64(row, 1));
    const std::int64_t time = sqlite3_column_int64(row, 2);
    if (topic == impl_->topic_index.end()) {
      leave_out(fmt::format("of the topic {}, which isn't in the table 'topics'", sqlite3_column_int64(row, 1)),
                message.id);
    } else if (sqlite3_column_type(row, 2) != SQLITE_INTEGER || time < 0) {
      leave_out("whose timestamp is no number of nanoseconds", message.id);
    } else if (sqlite3_column_type(row, 3) != SQLITE_BLOB) {
      leave_out("whose data isn't a BLOB", message.id);
    } else {
      message.topic = topic->second;
      message.time = static_cast<std::uint64_t>(time);
      message.data = {static_cast<const std::byte*>(sqlite3_column_blob(row, 3)),
                      static_cast<std::size_t>(sqlite3_column_bytes(row, 3))};
      REHEARSE_TRY(callback(message));
    }
    if (message.id == no_end) break;
    next = message.id + 1;
  }
  const auto lost = problems.empty() ? impl_->count_unread(unread, read) : std::nullopt;
  if (!lost && !unread.empty())
    problems.push_back(
        impl_->wrong(fmt::format("damaged: an unknown number of its messages can't be read ({}): "
                                 "SQLite reports: {}",
                                 place_of(unread), damage)));
  else if (lost && *lost > 0)
    problems.push_back(impl_->wrong(fmt::format("damaged: {} of its {} messages can't be read ({}): SQLite reports: {}",
                                                *lost, read + *lost, place_of(unread), damage)));
  impl_->lost_messages = lost ? std::optional(*lost + left_out) : std::nullopt;
  for (const auto& [reason, rows] : wrong_rows) {
    if (problems.size() == most_findings) break;
    problems.push_back(impl_->wrong(fmt::format("it has {} {} {}, the first in row {}: left out", rows.first,
                                                rows.first == 1 ? "message" : "messages", reason, rows.second)));
  }
  if (problems.empty()) return {};
  return problems;
}

std::optional<std::uint64_t> SqliteBag::lost_messages() const { return impl_->lost_messages; }

std::vector<std::string> SqliteBag::examine() {
  std::vector<std::string> findings;
  auto statement = impl_->prepare(fmt::format("PRAGMA integrity_check({})", most_findings));
  if (!statement) return {statement.errors().front().message};
  while (sqlite3_step(statement->get()) == SQLITE_ROW)
    if (std::string finding = text_at(statement->get(), 0); finding != "ok")
      findings.push_back(printable(finding, 200));
  return findings;
}

Result<std::unique_ptr<SqliteBag>> SqliteBag::open(const std::filesystem::path& file, const std::string& name) {
  auto impl = std::make_unique<Impl>();
  impl->name = name;
  REHEARSE_TRY(impl->open(file));
  return std::unique_ptr<SqliteBag>(new SqliteBag(std::move(impl)));
}

SqliteBag::SqliteBag(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SqliteBag::~SqliteBag() = default;

std::vector<std::filesystem::path> SqliteBag::files_of(const std::filesystem::path& file) {
  std::vector<std::filesystem::path> files{file};
  for (const char* suffix : side_files)
    if (size_or_zero(beside(file, suffix)) > 0) files.push_back(beside(file, suffix));
  return files;
}

int SqliteBag::schema_version() const { return impl_->schema_version; }
const std::vector<Topic>& SqliteBag::topics() const { return impl_->topics; }

const Definition* SqliteBag::definition_of(const std::string& type) const {
  auto found = impl_->definitions.find(type);
  if (found == impl_->definitions.end() && type.ends_with(event_suffix))
    found = impl_->definitions.find(type.substr(0, type.size() - event_suffix.size()));
  return found == impl_->definitions.end() ? nullptr : &found->second;
}

}  // namespace rehearse::bag
