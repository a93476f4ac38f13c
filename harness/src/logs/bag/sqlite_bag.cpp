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
#include "sqlite_pages.h"

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
  std::int64_t last = 0;
};

/// The place of unread rows, for a message.
std::string place_of(const std::vector<UnreadRows>& unread) {
  const auto [first, last] = unread.front();
  std::string text = last == first ? fmt::format("row {}", first) : fmt::format("rows {} to {}", first, last);
  return unread.size() == 1 ? text : fmt::format("in {} places, the first: {}", unread.size(), text);
}

}  // namespace

/// The messages that were delivered in a pass, and the rows that weren't.
class SqliteBag::Pass {
 public:
  Pass(const std::map<std::int64_t, std::size_t>& topics, const OnMessage& callback)
      : topics_(topics), callback_(callback) {}

  /// Delivers the message of a row: nullopt for a time that is none, and for data that are no bytes.
  Result<void> deliver(std::int64_t id, std::int64_t topic, std::optional<std::int64_t> time,
                       std::optional<std::span<const std::byte>> data);
  void miss(UnreadRows rows) {
    unread_.push_back(rows);
    next_ = rows.last + 1;
  }
  void note_damage(int status) {
    if (damage_.empty()) damage_ = sqlite3_errstr(status);
  }

  std::int64_t next() const { return next_; }  // rows before it are done
  std::uint64_t read() const { return read_; }
  std::uint64_t left_out() const { return left_out_; }
  const std::vector<UnreadRows>& unread() const { return unread_; }
  std::uint64_t missed() const {
    std::uint64_t count = 0;
    for (const UnreadRows& rows : unread_) count += static_cast<std::uint64_t>(rows.last - rows.first) + 1;
    return count;
  }
  const std::string& damage() const { return damage_; }
  std::vector<std::string> rows_left_out() const;

 private:
  const std::map<std::int64_t, std::size_t>& topics_;
  const OnMessage& callback_;
  std::map<std::string, std::pair<std::uint64_t, std::int64_t>> wrong_rows_;  // number and first row, by reason
  std::vector<UnreadRows> unread_;
  std::string damage_;  // empty: none
  std::int64_t next_ = std::numeric_limits<std::int64_t>::min();
  std::uint64_t read_ = 0, left_out_ = 0;
};

Result<void> SqliteBag::Pass::deliver(std::int64_t id, std::int64_t topic, std::optional<std::int64_t> time,
                                      std::optional<std::span<const std::byte>> data) {
  ++read_;
  next_ = id == std::numeric_limits<std::int64_t>::max() ? id : id + 1;
  const auto known = topics_.find(topic);
  std::string reason;
  if (known == topics_.end())
    reason = fmt::format("of the topic {}, which isn't in the table 'topics'", topic);
  else if (!time || *time < 0)
    reason = "whose timestamp is no number of nanoseconds";
  else if (!data)
    reason = "whose data isn't a BLOB";
  if (reason.empty()) return callback_({id, known->second, static_cast<std::uint64_t>(*time), *data});
  ++wrong_rows_.try_emplace(std::move(reason), 0, id).first->second.first;
  ++left_out_;
  return {};
}

std::vector<std::string> SqliteBag::Pass::rows_left_out() const {
  std::vector<std::string> sentences;
  for (const auto& [reason, rows] : wrong_rows_)
    sentences.push_back(fmt::format("it has {} {} {}, the first in row {}: left out", rows.first,
                                    rows.first == 1 ? "message" : "messages", reason, rows.second));
  return sentences;
}

struct SqliteBag::Impl {
  std::string name;
  OwnCopy copy;
  std::ifstream pages;         // the database's bytes; of a copy also after its name is removed
  bool is_count_exact = true;  // the number of messages that the last pass missed is known
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
  Result<bool> has_rising_ids(Pass& pass) const;
  Result<bool> read_rows(Pass& pass) const;
  Result<void> read_pages(Pass& pass);
  Result<TableForm> form_of_messages() const;
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
  pages.open(mode == SQLITE_OPEN_READWRITE ? std::filesystem::path(opened_name) : file, std::ios::binary);
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

/// True if the tree has all rows in the order of their ids. Bytes that continue in other pages aren't read.
Result<bool> SqliteBag::Impl::has_rising_ids(Pass& pass) const {
  const auto statement = REHEARSE_TRY(prepare("SELECT rowid FROM messages NOT INDEXED ORDER BY rowid"));
  std::optional<std::int64_t> before;
  int status = SQLITE_ROW;
  while ((status = sqlite3_step(statement.get())) == SQLITE_ROW) {
    const std::int64_t id = sqlite3_column_int64(statement.get(), 0);
    if (before && id <= *before) status = SQLITE_CORRUPT;
    if (status == SQLITE_CORRUPT) break;
    before = id;
  }
  if (status == SQLITE_DONE) return true;
  if (!is_damage(status)) return failed("its messages can't be read");
  pass.note_damage(status);
  return false;
}

/// Delivers the rows of a tree with rising ids; false: a damage ended it.
Result<bool> SqliteBag::Impl::read_rows(Pass& pass) const {
  const auto statement =
      REHEARSE_TRY(prepare("SELECT rowid, topic_id, timestamp, data FROM messages NOT INDEXED ORDER BY rowid"));
  sqlite3_stmt* const row = statement.get();
  int status = SQLITE_ROW;
  while ((status = sqlite3_step(row)) == SQLITE_ROW) {
    const auto time =
        sqlite3_column_type(row, 2) == SQLITE_INTEGER ? std::optional(sqlite3_column_int64(row, 2)) : std::nullopt;
    std::optional<std::span<const std::byte>> data;
    if (sqlite3_column_type(row, 3) == SQLITE_BLOB)
      data = {static_cast<const std::byte*>(sqlite3_column_blob(row, 3)),
              static_cast<std::size_t>(sqlite3_column_bytes(row, 3))};
    REHEARSE_TRY(pass.deliver(sqlite3_column_int64(row, 0), sqlite3_column_int64(row, 1), time, data));
  }
  if (status == SQLITE_DONE) return true;
  if (!is_damage(status)) return failed("not all of its messages can be read");
  pass.note_damage(status);
  return false;
}

/// The form of the table of messages, without which its cells aren't known.
Result<TableForm> SqliteBag::Impl::form_of_messages() const {
  TableForm form;
  form.is_topic = [this](std::int64_t id) { return topic_index.contains(id); };
  const auto statement = REHEARSE_TRY(prepare("SELECT name, cid FROM pragma_table_info('messages')"));
  const std::pair<const char*, std::size_t&> places[] = {
      {"topic_id", form.topic}, {"timestamp", form.time}, {"data", form.data}};
  while (sqlite3_step(statement.get()) == SQLITE_ROW) {
    ++form.columns;
    for (const auto& [name, place] : places)
      if (text_at(statement.get(), 0) == name)
        place = static_cast<std::size_t>(sqlite3_column_int64(statement.get(), 1));
  }
  return form;
}

/// Delivers the rows that are in pages of the file, whatever its trees state, and notes those that are missing.
Result<void> SqliteBag::Impl::read_pages(Pass& pass) {
  constexpr std::int64_t most_missing = 1 << 24;  // a larger gap is an id that was changed
  // of a copy: the changes of the WAL file become part of the database
  sqlite3_exec(database.get(), "PRAGMA wal_checkpoint(TRUNCATE)", nullptr, nullptr, nullptr);
  TablePages table(pages, REHEARSE_TRY(form_of_messages()));
  const auto miss_until = [&pass](std::int64_t id) {
    const std::int64_t first = std::max<std::int64_t>(pass.next(), 1);  // rosbag2 numbers rows from 1, without gaps
    if (first < id && id - first < most_missing) pass.miss({first, id - 1});
  };
  const std::int64_t begin = pass.next();
  for (const PageRow& row : table.rows()) {
    if (row.id < begin) continue;
    const auto data = table.data_of(row);
    if (!data) continue;
    miss_until(row.id);
    REHEARSE_TRY(pass.deliver(row.id, row.topic, row.time, data));
  }
  const auto all = table.is_cut() ? std::nullopt : rows_in_index();
  is_count_exact = all && *all >= pass.read();
  if (is_count_exact) miss_until(static_cast<std::int64_t>(*all) + 1);
  return {};
}

Result<void> SqliteBag::for_each_message(const OnMessage& callback) {
  Pass pass(impl_->topic_index, callback);
  impl_->lost_messages.reset();
  impl_->is_count_exact = true;
  const bool has_order = REHEARSE_TRY(impl_->has_rising_ids(pass));
  const bool is_whole = has_order && REHEARSE_TRY(impl_->read_rows(pass));
  if (!is_whole) REHEARSE_TRY(impl_->read_pages(pass));
  const std::uint64_t missed = pass.missed();
  if (impl_->is_count_exact) impl_->lost_messages = missed + pass.left_out();
  Diagnostics problems;
  if (!is_whole) {
    std::string lost = fmt::format("all of its {} messages are read from their pages", pass.read());
    if (!impl_->is_count_exact && missed == 0)
      lost = fmt::format("an unknown number of its messages can't be read (from row {} on)", pass.next());
    else if (!impl_->is_count_exact)
      lost = fmt::format("at least {} of its messages can't be read ({})", missed, place_of(pass.unread()));
    else if (missed > 0)
      lost = fmt::format("{} of its {} messages can't be read ({})", missed, pass.read() + missed,
                         place_of(pass.unread()));
    problems.push_back(impl_->wrong(fmt::format("damaged: {}: SQLite reports: {}", lost, pass.damage())));
  }
  for (std::string& sentence : pass.rows_left_out())
    if (problems.size() < most_findings) problems.push_back(impl_->wrong(std::move(sentence)));
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
