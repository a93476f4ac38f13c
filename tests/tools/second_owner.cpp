// A second program with a test of the name that a test of owning_tests.cpp has. golden_owners_test.cpp runs both.
#include <rehearse/gtest.h>

TEST(Macro, Falls) { EXPECT_MATCHES_GOLDEN(rehearse::record("fall.yaml")); }
