// Logs in other containers than an MCAP file, opened as every verb opens them.
#include <rehearse/trace.h>

#include <gmock/gmock.h>

#include <numeric>

#include "bag_files.h"

namespace rehearse::test {
namespace {

using testing::HasSubstr;

/// The positions of KNEE in a log, in the order of time.
std::vector<double> knee_in(const fs::path& log) {
  const auto trace = Trace::load(log);
  EXPECT_TRUE(trace) << to_string(trace.errors());
  return trace && trace->find_series("joint_states/KNEE/q") ? trace->values("joint_states/KNEE/q")
         : trace && trace->find_series("KNEE/q")            ? trace->values("KNEE/q")
                                                            : std::vector<double>();
}

std::vector<double> upto(int end) {
  std::vector<double> numbers;
  for (int i = 0; i < end; ++i) numbers.push_back(i);
  return numbers;
}

std::string form_of(const fs::path& log) {
  const auto reader = mcap::Reader::open(log);
  return reader ? (*reader)->form() : to_string(reader.errors());
}

class Databases : public testing::TestWithParam<int> {};

TEST_P(Databases, OfEachVersionAreRead) {
  const TemporaryFolder folder;
  {
    Database bag(folder / "joints_0.db3", GetParam());
    bag.topic(3, "/joint_states", "sensor_msgs/msg/JointState");
    for (int i = 0; i < 10; ++i) bag.message(3, i * 1'000'000, joint_state(i));
  }
  EXPECT_EQ(knee_in(folder / "joints_0.db3"), upto(10));
  EXPECT_EQ(form_of(folder / "joints_0.db3"),
            "rosbag2 database (SQLite, schema version " + std::to_string(GetParam()) + ")");
}

INSTANTIATE_TEST_SUITE_P(Versions, Databases, testing::Values(1, 2, 3, 4));

TEST(Database, KeepsTopicTypeTimesProfilesAndBytes) {
  const TemporaryFolder folder;
  const Buffer payload = joint_state(0.25);
  {
    Database bag(folder / "a.db3");
    bag.topic(7, "/joint_states", "sensor_msgs/msg/JointState");
    bag.message(7, 1'700'000'000'123'456'789, payload);
  }
  const auto reader = mcap::Reader::open(folder / "a.db3");
  ASSERT_TRUE(reader) << to_string(reader.errors());
  EXPECT_EQ((*reader)->size(), fs::file_size(folder / "a.db3"));
  int messages = 0;
  EXPECT_TRUE((*reader)->for_each_message([&](const mcap::Message& message) {
    ++messages;
    EXPECT_EQ(message.channel->topic, "/joint_states");
    EXPECT_EQ(message.channel->message_encoding, "cdr");
    EXPECT_EQ(message.channel->metadata.at("offered_qos_profiles"), "- history: 3");
    EXPECT_EQ((*reader)->schema_of(*message.channel)->name, "sensor_msgs/msg/JointState");
    EXPECT_EQ(message.log_time, 1'700'000'000'123'456'789u);
    EXPECT_EQ(Buffer(message.data.begin(), message.data.end()), payload);
    return true;
  }));
  EXPECT_EQ(messages, 1);
}

TEST(Database, UsesItsOwnDefinitionBeforeAStandardOne) {
  const TemporaryFolder folder;
  {
    Database bag(folder / "a.db3");
    bag.topic(1, "/a", "sensor_msgs/msg/JointState");
    bag.topic(2, "/b", "my_msgs/msg/Load");
    bag.topic(3, "/c", "my_msgs/msg/Unknown");
    bag.topic(4, "/d", "sensor_msgs/msg/Joy");
    bag.definition("sensor_msgs/msg/JointState", "float64 only");
    bag.definition("my_msgs/msg/Load", "float64 newton");
  }
  const auto reader = mcap::Reader::open(folder / "a.db3");
  ASSERT_TRUE(reader) << to_string(reader.errors());
  std::map<std::string, mcap::Schema> schemas;
  for (const auto& [id, schema] : (*reader)->schemas()) schemas[schema.name] = schema;
  EXPECT_EQ(schemas["sensor_msgs/msg/JointState"].data, "float64 only");
  EXPECT_EQ(schemas["my_msgs/msg/Load"].data, "float64 newton");
  EXPECT_EQ(schemas["my_msgs/msg/Unknown"].encoding, "");
  EXPECT_EQ(schemas["my_msgs/msg/Unknown"].data, "");
  EXPECT_THAT(schemas["sensor_msgs/msg/Joy"].data, HasSubstr("float32[] axes"));
}

TEST(Database, ReportsRowsThatAreNoMessagesAndDeliversTheOthers) {
  const TemporaryFolder folder;
  {
    Database bag(folder / "a.db3");
    bag.topic(1, "/joint_states", "sensor_msgs/msg/JointState");
    bag.message(1, 0, joint_state(0));
    bag.message(9, 1, joint_state(5));
    bag.run("INSERT INTO messages(topic_id, timestamp, data) VALUES(1, -5, x'00')");
    bag.run("INSERT INTO messages(topic_id, timestamp, data) VALUES(1, 7, 'text')");
    bag.message(1, 1'000'000, joint_state(1));
  }
  const auto reader = mcap::Reader::open(folder / "a.db3");
  ASSERT_TRUE(reader) << to_string(reader.errors());
  int messages = 0;
  const auto read = (*reader)->for_each_message([&](const mcap::Message&) { return ++messages > 0; });
  EXPECT_EQ(messages, 2);
  ASSERT_FALSE(read);
  const std::string text = to_string(read.errors());
  EXPECT_THAT(text, HasSubstr("a.db3: error: it has 1 message of the topic 9, which isn't in the table 'topics', the "
                              "first in row 2: left out"));
  EXPECT_THAT(text, HasSubstr("whose timestamp is no number of nanoseconds, the first in row 3"));
  EXPECT_THAT(text, HasSubstr("whose data isn't a BLOB, the first in row 4"));
}

TEST(Database, OfCompressedMessagesIsDecompressed) {
  const TemporaryFolder folder;
  {
    Database bag(folder / "a.db3");
    bag.topic(1, "/joint_states", "sensor_msgs/msg/JointState");
    for (int i = 0; i < 5; ++i) bag.message(1, i * 1'000'000, compressed(joint_state(i)));
  }
  EXPECT_EQ(knee_in(folder / "a.db3"), upto(5));
}

TEST(Database, ThatWasCutIsReportedAfterItsReadableMessages) {
  const TemporaryFolder folder;
  {
    Database bag(folder / "a.db3");
    bag.topic(1, "/joint_states", "sensor_msgs/msg/JointState");
    for (int i = 0; i < 2000; ++i) bag.message(1, i * 1'000'000, joint_state(i));
  }
  fs::resize_file(folder / "a.db3", fs::file_size(folder / "a.db3") * 3 / 4);
  const auto reader = mcap::Reader::open(folder / "a.db3");
  ASSERT_TRUE(reader) << to_string(reader.errors());
  int messages = 0;
  const auto read = (*reader)->for_each_message([&](const mcap::Message&) { return ++messages > 0; });
  ASSERT_FALSE(read);
  EXPECT_GT(messages, 100);
  EXPECT_THAT(to_string(read.errors()), HasSubstr("damaged: an unknown number of its messages can't be read ("));
}

void write_database(const fs::path& file, int messages) {
  Database bag(file);
  bag.topic(1, "/joint_states", "sensor_msgs/msg/JointState");
  bag.run("BEGIN");
  for (int i = 0; i < messages; ++i) bag.message(1, std::int64_t{1'000'000} * i, joint_state(i));
  bag.run("COMMIT");
}

/// The times of a log's readable messages [ms].
std::vector<std::uint64_t> times_in(const fs::path& log) {
  std::vector<std::uint64_t> times;
  const auto reader = mcap::Reader::open(log);
  EXPECT_TRUE(reader) << to_string(reader.errors());
  if (reader)
    static_cast<void>((*reader)->for_each_message([&](const mcap::Message& message) {
      times.push_back(message.log_time / 1'000'000);
      return true;
    }));
  return times;
}

TEST(Database, WithDamagedPagesLosesTheMessagesInThemAlone) {
  const TemporaryFolder folder;
  write_database(folder / "a.db3", 6000);
  zero_page(folder / "a.db3", 0.3);
  zero_page(folder / "a.db3", 0.6);
  const std::vector<std::uint64_t> times = times_in(folder / "a.db3");
  ASSERT_GT(times.size(), 5800u);
  EXPECT_EQ(times.front(), 0u);
  EXPECT_EQ(times.back(), 5999u);
  const auto reader = mcap::Reader::open(folder / "a.db3");
  ASSERT_TRUE(reader) << to_string(reader.errors());
  EXPECT_THAT(to_string((*reader)->damage()),
              HasSubstr("damaged: " + std::to_string(6000 - times.size()) +
                        " of its 6000 messages can't be read (in 2 places, the first: rows "));
}

/// Where the pages begin that have rows of messages, in the order of the file.
std::vector<std::size_t> pages_of_messages(const Buffer& bytes) {
  constexpr std::byte leaf_of_table{0x0d};
  constexpr std::size_t page = 4096, in_use = 10;  // the other tables have fewer rows
  std::vector<std::size_t> pages;
  for (std::size_t at = page; at < bytes.size(); at += page)
    if (bytes[at] == leaf_of_table && std::to_integer<std::size_t>(bytes[at + 4]) > in_use) pages.push_back(at);
  return pages;
}

std::vector<std::uint64_t> all_times(std::uint64_t messages) {
  std::vector<std::uint64_t> times(messages);
  std::iota(times.begin(), times.end(), 0u);
  return times;
}

TEST(Database, WithAFlippedBitInAnyByteOfARowIdIsReadWhole) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db3";
  write_database(file, 2000);
  const Buffer whole = read_bytes(file);
  const std::size_t page = pages_of_messages(whole)[20];
  for (const std::size_t cell : {0u, 1u, 7u}) {
    const auto pointer = [&](std::size_t i) { return std::to_integer<std::size_t>(whole[page + 8 + 2 * cell + i]); };
    std::size_t id = page + (pointer(0) << 8 | pointer(1));
    while (std::to_integer<int>(whole[id]) >= 0x80) ++id;  // the size of the payload
    ++id;
    for (const std::byte bit : {std::byte{0x01}, std::byte{0x10}, std::byte{0x40}}) {
      Buffer damaged = whole;
      damaged[id] ^= bit;
      write_bytes(file, damaged);
      EXPECT_EQ(times_in(file), all_times(2000)) << cell;
      EXPECT_THAT(to_string((*mcap::Reader::open(file))->damage()),
                  HasSubstr("damaged: all of its 2000 messages are read from their pages: SQLite reports: "));
    }
  }
}

TEST(Database, WithExchangedPagesIsReadWholeAndInOrder) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db3";
  write_database(file, 2000);
  Buffer bytes = read_bytes(file);
  const std::vector<std::size_t> pages = pages_of_messages(bytes);
  const auto at = [&bytes](std::size_t offset) { return bytes.begin() + static_cast<std::ptrdiff_t>(offset); };
  std::swap_ranges(at(pages[10]), at(pages[10] + 4096), at(pages[30]));
  write_bytes(file, bytes);
  EXPECT_EQ(times_in(file), all_times(2000));
}

TEST(Database, WithADamagedPageKeepsMessagesThatContinueInOtherPages) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db3";
  const auto payload = [](std::size_t i) { return Buffer(300 + i * 61, std::byte(i)); };  // up to three pages
  constexpr std::size_t count = 200;
  {
    Database bag(file);
    bag.topic(1, "/blob", "my_msgs/msg/Blob");
    bag.run("BEGIN");
    for (std::size_t i = 0; i < count; ++i) bag.message(1, static_cast<std::int64_t>(i), payload(i));
    bag.run("COMMIT");
  }
  zero_page(file, 0.2);
  const auto reader = mcap::Reader::open(file);
  ASSERT_TRUE(reader) << to_string(reader.errors());
  std::size_t messages = 0;
  static_cast<void>((*reader)->for_each_message([&](const mcap::Message& message) {
    EXPECT_EQ(Buffer(message.data.begin(), message.data.end()), payload(message.log_time)) << message.log_time;
    return ++messages > 0;
  }));
  EXPECT_GT(messages, count - 10);
  EXPECT_THAT(to_string((*reader)->damage()), HasSubstr(std::to_string(count - messages) + " of its 200 messages"));
}

TEST(Database, WithADamagedLastPageCountsItsMessagesByTheIndex) {
  const TemporaryFolder folder;
  write_database(folder / "a.db3", 1000);
  zero_page(folder / "a.db3", 0.95);
  const std::vector<std::uint64_t> times = times_in(folder / "a.db3");
  ASSERT_GT(times.size(), 900u);
  ASSERT_LT(times.size(), 1000u);
  EXPECT_THAT(to_string((*mcap::Reader::open(folder / "a.db3"))->damage()),
              HasSubstr(std::to_string(1000 - times.size()) + " of its 1000 messages can't be read ("));
}

TEST(Database, IsReadWithTheRowsOfItsWalFileAndNothingBesideItIsChanged) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "log");
  {
    Database bag(folder / "a.db3");
    bag.run("PRAGMA journal_mode = WAL");
    bag.run("PRAGMA wal_autocheckpoint = 0");
    bag.topic(1, "/joint_states", "sensor_msgs/msg/JointState");
    for (int i = 0; i < 10; ++i) bag.message(1, i * 1'000'000, joint_state(i));
    fs::copy(folder / "a.db3", folder / "log/a.db3");  // as a recorder leaves it that is killed
    fs::copy(folder / "a.db3-wal", folder / "log/a.db3-wal");
  }
  fs::permissions(folder / "log/a.db3", fs::perms::owner_read);
  const Buffer database = read_bytes(folder / "log/a.db3"), wal = read_bytes(folder / "log/a.db3-wal");
  EXPECT_EQ(knee_in(folder / "log/a.db3"), upto(10));
  EXPECT_EQ(read_bytes(folder / "log/a.db3"), database);
  EXPECT_EQ(read_bytes(folder / "log/a.db3-wal"), wal);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "log"), fs::directory_iterator()), 2);
}

TEST(Database, InWalModeIsReadWithoutAFileBesideIt) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "log 50%");
  {
    Database bag(folder / "log 50%/a?b#.db3");
    bag.run("PRAGMA journal_mode = WAL");
    bag.topic(1, "/joint_states", "sensor_msgs/msg/JointState");
    for (int i = 0; i < 10; ++i) bag.message(1, i * 1'000'000, joint_state(i));
  }
  EXPECT_EQ(knee_in(folder / "log 50%/a?b#.db3"), upto(10));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "log 50%"), fs::directory_iterator()), 1);
}

TEST(Folder, OfSplitFilesIsOneLog) {
  const TemporaryFolder folder;
  write_joints(folder / "bag_0.mcap", 0, 4);
  write_joints(folder / "bag_1.mcap", 4, 3);
  write_joints(folder / "bag_2.mcap", 7, 3);
  write_metadata(folder.path(), {.files = {"bag_0.mcap", "bag_1.mcap", "bag_2.mcap"}, .messages = 10});
  EXPECT_EQ(knee_in(folder.path()), upto(10));
  EXPECT_EQ(form_of(folder.path()), "rosbag2 folder (3 files of mcap)");
  const auto reader = mcap::Reader::open(folder.path());
  ASSERT_TRUE(reader);
  EXPECT_EQ((*reader)->channels().size(), 1u);
}

TEST(Folder, OfOneFileIsThatFile) {
  const TemporaryFolder folder;
  write_joints(folder / "bag_0.mcap", 0, 4);
  write_metadata(folder.path(), {.files = {"bag_0.mcap"}, .messages = 4});
  EXPECT_EQ(knee_in(folder.path()), upto(4));
  EXPECT_EQ(form_of(folder.path()), "MCAP");
}

TEST(Folder, OfSplitDatabasesIsOneLog) {
  const TemporaryFolder folder;
  for (int part = 0; part < 2; ++part) {
    Database bag(folder / ("bag_" + std::to_string(part) + ".db3"));
    bag.topic(1, "/joint_states", "sensor_msgs/msg/JointState");
    for (int i = 5 * part; i < 5 * part + 5; ++i) bag.message(1, i * 1'000'000, joint_state(i));
  }
  write_metadata(folder.path(), {.storage = "sqlite3", .files = {"bag_0.db3", "bag_1.db3"}, .messages = 10});
  EXPECT_EQ(knee_in(folder.path()), upto(10));
  EXPECT_EQ(form_of(folder.path()), "rosbag2 folder (2 files of sqlite3)");
}

TEST(Folder, WithoutMetadataIsItsPartsInTheOrderOfTheirNumbers) {
  const TemporaryFolder folder;
  for (std::uint64_t part = 0; part < 11; ++part)
    write_joints(folder / ("friday_" + std::to_string(part) + ".mcap"), part, 1);
  write_text(folder / "notes.txt", "of mine");
  EXPECT_EQ(times_in(folder.path()), (std::vector<std::uint64_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
  EXPECT_EQ(form_of(folder.path()), "rosbag2 folder without metadata.yaml (11 files of mcap)");
}

TEST(Folder, WithoutMetadataOfOneFileIsThatFile) {
  const TemporaryFolder folder;
  write_database(folder / "a.db3", 10);
  EXPECT_EQ(knee_in(folder.path()), upto(10));
}

TEST(Folder, WithoutMetadataOfSeveralRecordingsIsRefused) {
  const TemporaryFolder folder;
  write_joints(folder / "friday_0.mcap", 0, 4);
  write_joints(folder / "monday_1.mcap", 4, 4);
  EXPECT_THAT(form_of(folder.path()),
              HasSubstr("it has no metadata.yaml, and 'friday_0.mcap' and 'monday_1.mcap' aren't the parts of one "
                        "recording (name one of its files; merge joins several)"));
}

TEST(Folder, WhoseMetadataStatesNoStorageIsRead) {
  const TemporaryFolder folder;
  write_database(folder / "bag_0.db3", 4);
  write_joints(folder / "bag_1.mcap", 4, 3);
  write_metadata(folder.path(), {.storage = "\"\"", .files = {"bag_0.db3"}, .messages = 4});
  EXPECT_EQ(knee_in(folder.path()), upto(4));
  write_metadata(folder.path(), {.storage = "\"\"", .files = {"bag_0.db3", "bag_1.mcap"}, .messages = 7});
  EXPECT_EQ(times_in(folder.path()), (std::vector<std::uint64_t>{0, 1, 2, 3, 4, 5, 6}));
}

TEST(Folder, IsOpenedByTheNameOfItsMetadata) {
  const TemporaryFolder folder;
  write_joints(folder / "bag_0.mcap", 0, 4);
  write_joints(folder / "bag_1.mcap", 4, 3);
  write_metadata(folder.path(), {.files = {"bag_0.mcap", "bag_1.mcap"}, .messages = 7});
  EXPECT_EQ(knee_in(folder / "metadata.yaml"), upto(7));
  EXPECT_EQ(form_of(folder / "metadata.yaml"), "rosbag2 folder (2 files of mcap)");
}

TEST(Folder, OfCompressedFilesIsRead) {
  const TemporaryFolder folder;
  write_joints(folder / "a.mcap", 0, 4);
  write_bytes(folder / "a.mcap.zstd", compressed(read_bytes(folder / "a.mcap")));
  {
    Database bag(folder / "b.db3");
    bag.topic(1, "/joint_states", "sensor_msgs/msg/JointState");
    for (int i = 0; i < 3; ++i) bag.message(1, i * 1'000'000, joint_state(i));
  }
  write_bytes(folder / "b.db3.zstd", compressed(read_bytes(folder / "b.db3")));
  write_metadata(folder.path(), {.files = {"a.mcap.zstd"}, .messages = 4, .mode = "FILE", .format = "zstd"});
  EXPECT_EQ(knee_in(folder.path()), upto(4));
  EXPECT_EQ(form_of(folder.path()), "MCAP, compressed by zstd");
  write_metadata(folder.path(),
                 {.storage = "sqlite3", .files = {"b.db3.zstd"}, .messages = 3, .mode = "FILE", .format = "zstd"});
  EXPECT_EQ(knee_in(folder.path()), upto(3));
}

TEST(Folder, OfCompressedMessagesIsRead) {
  const TemporaryFolder folder;
  auto writer = mcap::Writer::create(folder / "a.mcap");
  const auto schema = (*writer)->add_schema(msg::JointState::type_name, "ros2msg", msg::schema_text<msg::JointState>());
  const auto channel = (*writer)->add_channel(schema, "/joint_states", "cdr");
  for (int i = 0; i < 3; ++i) EXPECT_TRUE((*writer)->write(channel, i, i, compressed(joint_state(i))));
  ASSERT_TRUE((*writer)->close());
  write_metadata(folder.path(), {.files = {"a.mcap"}, .messages = 3, .mode = "MESSAGE", .format = "zstd"});
  EXPECT_EQ(knee_in(folder.path()), upto(3));
}

TEST(Folder, DeliversAllPartsAndReportsTheCutOne) {
  const TemporaryFolder folder;
  write_joints(folder / "bag_0.mcap", 0, 4);
  write_joints(folder / "bag_1.mcap", 4, 3);
  fs::resize_file(folder / "bag_0.mcap", fs::file_size(folder / "bag_0.mcap") - 30);
  write_metadata(folder.path(), {.files = {"bag_0.mcap", "bag_1.mcap"}, .messages = 7});
  const auto reader = mcap::Reader::open(folder.path());
  ASSERT_TRUE(reader) << to_string(reader.errors());
  int messages = 0;
  const auto read = (*reader)->for_each_message([&](const mcap::Message&) { return ++messages > 0; });
  EXPECT_EQ(messages, 7);
  ASSERT_FALSE(read);
  EXPECT_THAT(to_string(read.errors()), HasSubstr("bag_0.mcap: error: truncated at byte"));
}

TEST(Zstd, ThatIsCutDeliversWhatItHas) {
  const TemporaryFolder folder;
  write_joints(folder / "a.mcap", 0, 40'000);
  Buffer bytes = compressed(read_bytes(folder / "a.mcap"));
  bytes.resize(bytes.size() / 2);
  write_bytes(folder / "a.mcap.zst", bytes);
  const auto reader = mcap::Reader::open(folder / "a.mcap.zst");
  ASSERT_TRUE(reader) << to_string(reader.errors());
  EXPECT_THAT(to_string((*reader)->damage()), HasSubstr("its zstd frame isn't whole"));
}

TEST(Zstd, BombIsRefused) {
  const TemporaryFolder folder;
  write_bytes(folder / "bomb.zst", compressed(Buffer(std::size_t{200} << 20)));
  const auto reader = mcap::Reader::open(folder / "bomb.zst");
  ASSERT_FALSE(reader);
  EXPECT_THAT(to_string(reader.errors()), HasSubstr("it decompresses to more than 1000 times its size"));
}

TEST(Container, ThatChangesIsConvertedAgain) {
  const TemporaryFolder folder;
  const auto add = [&](int time) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open((folder / "a.db3").c_str(), &database), SQLITE_OK);
    const std::string insert = "INSERT INTO messages(topic_id, timestamp, data) SELECT topic_id, " +
                               std::to_string(time) + ", data FROM messages LIMIT 1";
    EXPECT_EQ(sqlite3_exec(database, insert.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(database);
  };
  {
    Database bag(folder / "a.db3");
    bag.topic(1, "/joint_states", "sensor_msgs/msg/JointState");
    bag.message(1, 0, joint_state(0));
  }
  EXPECT_EQ(knee_in(folder / "a.db3").size(), 1u);
  add(5'000'000);
  EXPECT_EQ(knee_in(folder / "a.db3").size(), 2u);
}

}  // namespace
}  // namespace rehearse::test
