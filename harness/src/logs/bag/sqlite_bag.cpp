#include "sqlite_bag.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <optional>
#include <set>
#include <utility>

#include "model/text.h"

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

std::string text_at(sqlite3_stmt* row, int column) {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
  return text == nullptr ? std::string() : std::string(text, sqlite3_column_bytes(row, column));
}

}  // namespace

struct SqliteBag::Impl {
  std::string name;
  Database database;
  int schema_version = 1;
  std::vector<Topic> topics;
  std::map<std::int64_t, std::size_t> topic_index;  // by id
  std::map<std::string, Definition> definitions;

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
};

Result<void> SqliteBag::Impl::open(const std::filesystem::path& file) {
  sqlite3* opened = nullptr;
  const int status = sqlite3_open_v2(file.c_str(), &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX, nullptr);
  database.reset(opened);
  if (status != SQLITE_OK) return failed("the database can't be opened");
  // The file is foreign: its schema must not run functions, and a damaged page must be noticed. A file that is shorter
  // than it states is only read with a writable schema; nothing is written.
  sqlite3_db_config(opened, SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, longest_value);
  sqlite3_exec(opened, "PRAGMA cell_size_check = ON", nullptr, nullptr, nullptr);
  if (auto done = check_tables(); !done) return done;
  if (auto done = read_topics(); !done) return done;
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
  auto statement = prepare(fmt::format("SELECT name FROM pragma_table_info('{}')", table));
  if (!statement) return statement.errors();
  int status = SQLITE_ROW;
  while ((status = sqlite3_step(statement->get())) == SQLITE_ROW) columns.insert(text_at(statement->get(), 0));
  if (status != SQLITE_DONE) return failed("it can't be read");
  return columns;
}

Result<void> SqliteBag::Impl::check_tables() {
  const std::pair<const char*, std::vector<const char*>> needed[] = {
      {"topics", {"id", "name", "type", "serialization_format"}}, {"messages", {"topic_id", "timestamp", "data"}}};
  for (const auto& [table, all] : needed) {
    const auto columns = columns_of(table);
    if (!columns) return columns.errors();
    if (columns->empty())
      return wrong(fmt::format("the database has no table '{}'", table), "expected a .db3 file of rosbag2");
    for (const char* column : all)
      if (!columns->contains(column))
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
  auto statement =
      prepare(fmt::format("SELECT id, name, type, serialization_format, {} FROM topics ORDER BY id", profiles));
  if (!statement) return statement.errors();
  sqlite3_stmt* row = statement->get();
  int status = SQLITE_ROW;
  while ((status = sqlite3_step(row)) == SQLITE_ROW) {
    if (topics.size() == most_topics) return wrong(fmt::format("it has more than {} topics", most_topics));
    topic_index[sqlite3_column_int64(row, 0)] = topics.size();
    topics.push_back({text_at(row, 1), text_at(row, 2), text_at(row, 3), text_at(row, 4)});
  }
  if (status != SQLITE_DONE) return failed("its topics can't be read");
  return {};
}

Result<void> SqliteBag::Impl::read_definitions() {
  if (schema_version < 4) return {};
  auto statement = prepare("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions");
  if (!statement) return statement.errors();
  sqlite3_stmt* row = statement->get();
  int status = SQLITE_ROW;
  while ((status = sqlite3_step(row)) == SQLITE_ROW)
    definitions.emplace(text_at(row, 0), Definition{text_at(row, 1), text_at(row, 2)});
  if (status != SQLITE_DONE) return failed("its message definitions can't be read");
  return {};
}

Result<void> SqliteBag::for_each_message(const OnMessage& callback) {
  auto statement = impl_->prepare("SELECT rowid, topic_id, timestamp, data FROM messages ORDER BY rowid");
  if (!statement) return statement.errors();
  sqlite3_stmt* row = statement->get();
  std::map<std::string, std::pair<std::uint64_t, std::int64_t>> wrong_rows;  // number and first row, by reason
  const auto leave_out = [&wrong_rows](std::string reason, std::int64_t id) {
    ++wrong_rows.try_emplace(std::move(reason), 0, id).first->second.first;
  };
  int status = SQLITE_ROW;
  while ((status = sqlite3_step(row)) == SQLITE_ROW) {
    Message message;
    message.id = sqlite3_column_int64(row, 0);
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
      if (auto done = callback(message); !done) return done;
    }
  }
  Diagnostics problems;
  if (status != SQLITE_DONE) problems.push_back(impl_->failed("damaged: not all of its messages can be read"));
  for (const auto& [reason, rows] : wrong_rows) {
    if (problems.size() == most_findings) break;
    problems.push_back(impl_->wrong(fmt::format("it has {} {} {}, the first in row {}: left out", rows.first,
                                                rows.first == 1 ? "message" : "messages", reason, rows.second)));
  }
  if (problems.empty()) return {};
  return problems;
}

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
  if (auto done = impl->open(file); !done) return done.errors();
  return std::unique_ptr<SqliteBag>(new SqliteBag(std::move(impl)));
}

SqliteBag::SqliteBag(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SqliteBag::~SqliteBag() = default;

int SqliteBag::schema_version() const { return impl_->schema_version; }
const std::vector<Topic>& SqliteBag::topics() const { return impl_->topics; }
const std::map<std::string, Definition>& SqliteBag::definitions() const { return impl_->definitions; }

}  // namespace rehearse::bag
