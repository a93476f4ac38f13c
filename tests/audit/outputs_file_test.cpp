// The output files of an audit's processes, and the differences between two of them.
#include "audit/audit/outputs_file.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const std::vector<OutputField> fields{{"Arm/Reach", "/Arm/Reach/output/joints", "J1/u", "N·m", CellKind::floating},
                                      {"Arm/Reach", "/Arm/Reach/output/Lamp/state", "commanded", "", CellKind::boolean},
                                      {"Box/Push", "/Box/Push/output/BASE/wrench", "force/x", "N", CellKind::floating}};

std::uint64_t word(double number) { return std::bit_cast<std::uint64_t>(number); }

class OutputsFile : public ::testing::Test {
 protected:
  /// A file of such rows, tick by tick.
  Outputs written(const std::string& name, const std::vector<std::vector<std::uint64_t>>& rows) const {
    auto writer = OutputsWriter::create(folder_ / name);
    EXPECT_TRUE(writer.ok());
    writer->begin(fields);
    for (std::size_t tick = 0; tick < rows.size(); ++tick) writer->add(static_cast<std::int64_t>(tick), rows[tick]);
    EXPECT_TRUE(writer->complete());
    auto outputs = Outputs::read(folder_ / name);
    EXPECT_TRUE(outputs.ok());
    return *std::move(outputs);
  }

  const test::TemporaryFolder folder_;
};

TEST_F(OutputsFile, HoldsAllRowsThoughItIsStillOpen) {
  std::vector<std::vector<std::uint64_t>> rows;
  for (int tick = 0; tick < 5000; ++tick) rows.push_back({word(0.1 * tick), 0, word(-tick)});
  const Outputs outputs = written("many", rows);
  ASSERT_EQ(outputs.rows(), 5000);
  ASSERT_EQ(outputs.fields().size(), 3u);
  EXPECT_EQ(outputs.fields()[0].unit, "N·m");
  EXPECT_EQ(outputs.tick(4999), 4999);
  EXPECT_EQ(outputs.row(4999)[2], word(-4999));
  EXPECT_FALSE(outputs.unfinished());
}

TEST_F(OutputsFile, NamesTheCallThatItsProcessDidNotComeBackFrom) {
  auto writer = OutputsWriter::create(folder_ / "call");
  ASSERT_TRUE(writer.ok());
  writer->enter("Arm/Reach", "initialize", 0);
  writer->leave();
  writer->enter("Box/Push", "control", 7);
  const auto outputs = Outputs::read(folder_ / "call");
  ASSERT_TRUE(outputs.ok());
  EXPECT_EQ(outputs->rows(), 0);
  ASSERT_TRUE(outputs->unfinished());
  EXPECT_EQ(outputs->unfinished()->controller, "Box/Push");
  EXPECT_EQ(outputs->unfinished()->function, "control");
  EXPECT_EQ(outputs->unfinished()->tick, 7);
  EXPECT_EQ(heartbeat_of(folder_ / "call"), 3u);
  EXPECT_FALSE(heartbeat_of(folder_ / "nothing"));
}

TEST_F(OutputsFile, DifferenceIsTheFirstOfTheController) {
  const Outputs a = written("a", {{word(1.0), 0, word(2.0)}, {word(1.25), 0, word(2.0)}});
  const Outputs b = written("b", {{word(1.0), 0, word(3.0)}, {word(1.5), 0, word(2.0)}});
  const auto of_arm = first_difference(a, b, 0.001, "Arm/Reach");
  ASSERT_TRUE(of_arm);
  EXPECT_EQ(of_arm->tick, 1);
  EXPECT_EQ(of_arm->time, 0.001);
  EXPECT_EQ(of_arm->element, "J1/u");
  EXPECT_EQ(of_arm->expected, 1.25);
  EXPECT_EQ(of_arm->actual, 1.5);
  const auto of_all = first_difference(a, b, 0.001, "");
  ASSERT_TRUE(of_all);
  EXPECT_EQ(of_all->tick, 0);
  EXPECT_EQ(of_all->element, "force/x");
  EXPECT_FALSE(first_difference(a, a, 0.001, ""));
}

TEST_F(OutputsFile, DifferenceIsOfBitsNotOfNumbers) {
  const Outputs plus = written("plus", {{word(0.0), 0, word(0.0)}}),
                minus = written("minus", {{word(-0.0), 0, word(0.0)}});
  EXPECT_TRUE(first_difference(plus, minus, 0.001, "Arm/Reach"));
  const Outputs nan = written("nan", {{word(std::nan("")), 0, word(0.0)}});
  EXPECT_FALSE(first_difference(nan, nan, 0.001, ""));
}

TEST_F(OutputsFile, DifferenceMayBeThatOneEndedOrToldADevice) {
  const Outputs whole = written("whole", {{word(1.0), 0, word(2.0)}, {word(1.0), 0, word(2.0)}});
  const Outputs half = written("half", {{word(1.0), 0, word(2.0)}}),
                told = written("told", {{word(1.0), 1, word(2.0)}});
  const auto shorter = first_difference(whole, half, 0.001, "Arm/Reach");
  ASSERT_TRUE(shorter);
  EXPECT_EQ(shorter->tick, 1);
  EXPECT_THAT(shorter->note, HasSubstr("only one of two runs came to this tick"));
  const auto lamp = first_difference(half, told, 0.001, "Arm/Reach");
  ASSERT_TRUE(lamp);
  EXPECT_THAT(lamp->note, HasSubstr("the device is commanded, expected no command"));
}

TEST_F(OutputsFile, RefusesWhatItDidNotWrite) {
  EXPECT_FALSE(Outputs::read(folder_ / "nothing").ok());
  std::ofstream(folder_ / "text") << "not a file of outputs, but long enough to be taken for one? "
                                  << std::string(1000, 'x');
  EXPECT_FALSE(Outputs::read(folder_ / "text").ok());
  written("cut", {{word(1.0), 0, word(2.0)}, {word(1.0), 0, word(2.0)}});
  fs::resize_file(folder_ / "cut", 600);
  EXPECT_FALSE(Outputs::read(folder_ / "cut").ok());
  EXPECT_FALSE(OutputsWriter::create(folder_ / "no such folder" / "file").ok());
}

}  // namespace
}  // namespace rehearse
