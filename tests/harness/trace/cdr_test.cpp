#include <rehearse/cdr.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace rehearse;
using testing::ElementsAre;

namespace {

std::vector<int> numbers_of(std::span<const std::byte> bytes) {
  std::vector<int> numbers;
  for (const std::byte b : bytes) numbers.push_back(static_cast<int>(b));
  return numbers;
}

template <class... Byte>
std::vector<std::byte> payload(Byte... bytes) {
  return {static_cast<std::byte>(bytes)...};
}

}  // namespace

TEST(Cdr, AlignsFromBehindTheEncapsulationHeader) {
  CdrWriter writer;
  writer.put(std::uint8_t{1});
  writer.put(std::uint32_t{2});
  writer.put(std::uint64_t{3});  // at 8: already aligned
  writer.put(std::uint8_t{4});
  writer.put(std::uint16_t{5});
  EXPECT_THAT(numbers_of(writer.bytes()),
              ElementsAre(0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 4, 0, 5, 0));
}

TEST(Cdr, EndsStringsWithAZero) {
  CdrWriter writer;
  writer.put(std::string_view("hi"));
  writer.put(std::string_view(""));
  EXPECT_THAT(numbers_of(writer.bytes()), ElementsAre(0, 1, 0, 0, 3, 0, 0, 0, 'h', 'i', 0, 0, 1, 0, 0, 0, 0));
  CdrReader reader(writer.bytes());
  EXPECT_EQ(reader.get_string(), "hi");
  EXPECT_EQ(reader.get_string(), "");
  EXPECT_TRUE(reader.ok());
  EXPECT_EQ(reader.left(), 0u);
}

TEST(Cdr, DoesNotPadAfterAnEmptySequence) {
  CdrWriter writer;
  writer.put_sequence(std::span<const double>());
  writer.put(std::uint8_t{9});
  EXPECT_THAT(numbers_of(writer.bytes()), ElementsAre(0, 1, 0, 0, 0, 0, 0, 0, 9));
}

TEST(Cdr, KeepsEveryBitOfADouble) {
  const double payload_nan = std::bit_cast<double>(std::uint64_t{0xfff4dead'beef0001});
  const std::vector<double> values{payload_nan,
                                   -0.0,
                                   0.0,
                                   std::numeric_limits<double>::infinity(),
                                   -std::numeric_limits<double>::infinity(),
                                   std::numeric_limits<double>::denorm_min(),
                                   0.1};
  CdrWriter writer;
  writer.put_sequence(std::span<const double>(values));
  for (const double value : values) writer.put(value);
  CdrReader reader(writer.bytes());
  std::vector<double> sequence;
  reader.get_sequence(sequence);
  ASSERT_EQ(sequence.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(sequence[i]), std::bit_cast<std::uint64_t>(values[i]));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(reader.get<double>()), std::bit_cast<std::uint64_t>(values[i]));
  }
  EXPECT_TRUE(reader.ok());
}

TEST(Cdr, ReadsBothByteOrders) {
  const auto big = payload(0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0xff, 0xfe);
  CdrReader reader(big);
  EXPECT_TRUE(reader.swapped());
  std::vector<std::int16_t> values;
  reader.get_sequence(values);
  EXPECT_THAT(values, ElementsAre(1, -2));
  EXPECT_TRUE(reader.ok());
}

TEST(Cdr, AlignsToFourAtMostInVersion2) {
  for (const int kind : {0x07, 0x11}) {
    const auto bytes = payload(0, kind, 0, 0, 9, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 5);
    CdrReader reader(bytes);
    EXPECT_TRUE(reader.is_version_2());
    EXPECT_EQ(reader.get<std::uint8_t>(), 9);
    EXPECT_EQ(reader.get<std::uint64_t>(), 1u);
    EXPECT_EQ(reader.get<std::uint8_t>(), 5);
    EXPECT_TRUE(reader.ok());
  }
  const auto big = payload(0, 6, 0, 0, 0, 0, 0, 0, 0, 0, 0, 7);
  CdrReader reader(big);
  EXPECT_EQ(reader.get<std::uint64_t>(), 7u);
}

TEST(Cdr, RefusesOtherEncapsulations) {
  for (const int kind : {2, 3, 5, 8, 9, 0x0a, 0x12, 0x15, 0xff})
    EXPECT_FALSE(CdrReader(payload(0, kind, 0, 0, 1)).ok());
  EXPECT_FALSE(CdrReader(payload(1, 1, 0, 0, 1)).ok());
  EXPECT_FALSE(CdrReader(payload(0, 1, 0)).ok());
}

TEST(Cdr, FailsForGoodWhenAValueIsNotThere) {
  const auto bytes = payload(0, 1, 0, 0, 1, 2, 3);
  CdrReader reader(bytes);
  EXPECT_EQ(reader.get<std::uint32_t>(), 0u);
  EXPECT_FALSE(reader.ok());
  EXPECT_EQ(reader.get<std::uint8_t>(), 0) << "though there are bytes left";
}

TEST(Cdr, BelievesNoCount) {
  const auto bytes = payload(0, 1, 0, 0, 0xff, 0xff, 0xff, 0x7f, 1, 2, 3, 4);
  std::vector<double> values;
  CdrReader sequence(bytes);
  sequence.get_sequence(values);
  EXPECT_FALSE(sequence.ok());
  EXPECT_TRUE(values.empty());
  CdrReader text(bytes);
  EXPECT_EQ(text.get_string(), "");
  EXPECT_FALSE(text.ok());
}

TEST(Cdr, TakesAStringWithoutItsZero) {
  const auto bytes = payload(0, 1, 0, 0, 2, 0, 0, 0, 'h', 'i');
  CdrReader reader(bytes);
  EXPECT_EQ(reader.get_string(), "hi");
  EXPECT_TRUE(reader.ok());
}

TEST(Cdr, StartsAnewAfterReset) {
  CdrWriter writer;
  writer.put(std::uint64_t{1});
  writer.reset();
  writer.put(std::uint8_t{7});
  EXPECT_THAT(numbers_of(writer.bytes()), ElementsAre(0, 1, 0, 0, 7));
}
