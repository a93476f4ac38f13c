// main() of tests that use <rehearse/gtest.h>.
#include <gtest/gtest.h>
#include <rehearse/pin.h>

int main(int argc, char** argv) {
  rehearse::pin_process(argv);  // first: it starts the program once more, and nothing may have computed by then
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
