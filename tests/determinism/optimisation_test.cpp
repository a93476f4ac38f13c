// The world's sources give the same bits, however they were optimised.

#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <string>

namespace rehearse {
namespace {

std::string chain_of(const std::string& program, const std::string& method) {
  const std::string command = program + " '" FIXTURES_DIR "/models/sr1.urdf' " + method;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  char line[64] = "";
  EXPECT_NE(std::fgets(line, sizeof line, pipe.get()), nullptr) << command;
  return line;
}

class Optimisation : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Solver, Optimisation, ::testing::Values("quick", "exact"),
                         [](const auto& solver) { return std::string(solver.param); });

TEST_P(Optimisation, ChangesNoBitOfThePhysics) {
  const std::string library = chain_of(PHYSICS_LIBRARY, GetParam());
  EXPECT_EQ(library.size(), 17u);
  EXPECT_EQ(chain_of(PHYSICS_O0, GetParam()), library);
  EXPECT_EQ(chain_of(PHYSICS_O3, GetParam()), library);
}

}  // namespace
}  // namespace rehearse
