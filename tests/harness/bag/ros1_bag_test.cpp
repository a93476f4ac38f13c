// Bags of ROS 1, whole and broken.
#include <bzlib.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <lz4frame.h>
#include <rehearse/trace.h>

#include "bag_files.h"
#include "ros1_files.h"

namespace rehearse::test {
namespace {

using namespace ros1;
using testing::ElementsAre;
using testing::HasSubstr;

std::string by_bz2(std::string raw_bytes) {
  std::string out(raw_bytes.size() + 1000, '\0');
  auto size = static_cast<unsigned int>(out.size());
  EXPECT_EQ(BZ2_bzBuffToBuffCompress(out.data(), &size, raw_bytes.data(), static_cast<unsigned int>(raw_bytes.size()),
                                     9, 0, 0),
            BZ_OK);
  out.resize(size);
  return out;
}
std::string by_lz4(const std::string& raw_bytes) {
  std::string out(LZ4F_compressFrameBound(raw_bytes.size(), nullptr), '\0');
  out.resize(LZ4F_compressFrame(out.data(), out.size(), raw_bytes.data(), raw_bytes.size(), nullptr));
  return out;
}

/// A chunk in that compression.
std::string packed(const std::string& records, const std::string& compression) {
  return chunk_of(records, compression,
                  compression == "bz2"   ? by_bz2(records)
                  : compression == "lz4" ? by_lz4(records)
                                         : records);
}
std::string chunk(const std::string& records) { return chunk_of(records, "none", records); }
std::string knee(std::uint32_t from, std::uint32_t until) {
  std::string messages;
  for (std::uint32_t i = from; i < until; ++i) messages += message(3, i, 0.25 * i);
  return messages;
}

class Ros1Bags : public ::testing::Test {
 protected:
  fs::path write(const std::string& bytes) const {
    std::ofstream(folder_ / "run.bag", std::ios::binary) << bytes;
    return folder_ / "run.bag";
  }
  /// The log times [ms] and topics of a bag's messages, and the damage as the last text.
  std::vector<std::string> contents(const std::string& bytes) const {
    const auto reader = mcap::Reader::open(write(bytes));
    if (!reader) return {without_folder(to_string(reader.errors()[0]))};
    std::vector<std::string> messages;
    const auto read = (*reader)->for_each_message([&](const mcap::Message& message) {
      messages.push_back(
          fmt::format("{} {}", message.channel->topic, (message.log_time - 100'500'000'000) / 1'000'000));
      return true;
    });
    if (!read) messages.push_back(without_folder(to_string(read.errors()[0])));
    return messages;
  }
  std::string without_folder(std::string text) const {
    const std::string folder = folder_.path().string() + "/";
    if (const auto at = text.find(folder); at != std::string::npos) text.erase(at, folder.size());
    return text;
  }
  TemporaryFolder folder_;
};

TEST_F(Ros1Bags, AreReadInEachCompression) {
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const std::string bag = header() + packed(connection(3, "/joints") + knee(0, 2), compression) +
                            record(op(4) + field("conn", raw<std::uint32_t>(3)), "index") +
                            packed(knee(2, 3), compression) + connection(3, "/joints") +
                            record(op(6), "information on chunks");
    EXPECT_THAT(contents(bag), ElementsAre("/joints 0", "/joints 1", "/joints 2")) << compression;
    const auto trace = Trace::load(folder_ / "run.bag");
    ASSERT_TRUE(trace) << compression;
    const TraceChannel& channel = *trace->find_channel("/joints");
    EXPECT_EQ(channel.type, "sensor_msgs/JointState");
    EXPECT_EQ(channel.metadata.at("callerid"), "/robot");
    ASSERT_EQ(channel.columns.size(), 1u);
    EXPECT_EQ(channel.columns[0].element, "position/0");
    EXPECT_EQ(channel.number(2, 0), 0.5);
  }
}

TEST_F(Ros1Bags, ThatWereNotClosedAreReadUpToTheirEnd) {
  const std::string bag = header() + chunk(connection(3, "/joints") + knee(0, 2));
  EXPECT_THAT(contents(bag + chunk(knee(2, 4)).substr(0, 60)),
              ElementsAre("/joints 0", "/joints 1",
                          fmt::format("run.bag: error: damaged at byte {}: the record that begins there isn't whole",
                                      bag.size())));
}

TEST_F(Ros1Bags, WithADamagedChunkAreReadBehindIt) {
  for (const char* compression : {"bz2", "lz4"}) {
    std::string broken = packed(knee(2, 100), compression);
    for (std::size_t i = broken.size() / 2; i < broken.size() / 2 + 20; ++i) broken[i] = static_cast<char>(~broken[i]);
    const auto found =
        contents(header() + chunk(connection(3, "/joints") + knee(0, 2)) + broken + chunk(knee(100, 101)));
    ASSERT_EQ(found.size(), 4u) << compression;
    EXPECT_EQ(found[2], "/joints 100");
    EXPECT_THAT(found[3], HasSubstr("run.bag: error: damaged at byte "));
  }
}

TEST_F(Ros1Bags, WithAMistakeReportIt) {
  const std::string good = chunk(connection(3, "/joints") + knee(0, 1));
  const auto problem = [&](const std::string& mistake) { return contents(header() + good + mistake).back(); };
  const std::size_t place = (header() + good).size();
  const auto expect = [&](const std::string& mistake, const std::string& message) {
    EXPECT_EQ(problem(mistake), fmt::format("run.bag: error: damaged at byte {}: {}", place, message));
  };
  expect(record(field("kind", "x"), ""), "a record without a kind");
  expect(record(block("no sign of equality"), ""), "the record that begins there isn't whole");
  expect(record(op(2) + field("conn", raw<std::uint32_t>(3)), "x"), "a message without its connection or its time");
  expect(message(9, 0, 0.0), "messages of connection 9, which no record before describes");
  expect(record(op(7) + field("conn", raw<std::uint32_t>(4)), "???"), "a connection that isn't whole");
  expect(record(op(5) + field("compression", "none"), ""), "a chunk without its size");
  expect(record(op(5) + field("compression", "zip") + field("size", raw<std::uint32_t>(1)), "x"),
         "a chunk of the unknown compression 'zip'");
  expect(record(op(5) + field("compression", "lz4") + field("size", raw<std::uint32_t>(0xffffffff)), "x"),
         "a chunk of 4294967295 bytes");
  expect(chunk(chunk("")), "a chunk within a chunk");
  expect(chunk(knee(5, 6).substr(0, 40)), "in its chunk the record at byte 0 isn't whole");
}

TEST_F(Ros1Bags, OfOtherVersionsAndEncryptedOnesAreRefused) {
  EXPECT_THAT(contents("#ROSBAG V1.2\nrest"),
              ElementsAre("run.bag: error: a bag of ROS 1 of another version than 2.0: it begins with \"#ROSBAG V1.2\" "
                          "(rosbag fix, or rosbag migrate, of ROS 1 converts it)"));
  EXPECT_THAT(contents(header(field("encryptor", "rosbag/AesCbcEncryptor"))),
              ElementsAre("run.bag: error: it is encrypted by rosbag/AesCbcEncryptor (rosbag decrypt of ROS 1 decrypts "
                          "it)"));
}

TEST_F(Ros1Bags, CutAnywhereAreReadWithoutACrash) {
  const std::string bag = header() + packed(connection(3, "/joints") + knee(0, 3), "lz4") + packed(knee(3, 5), "bz2");
  for (std::size_t size = 13; size < bag.size(); ++size) contents(bag.substr(0, size));
}

}  // namespace
}  // namespace rehearse::test
