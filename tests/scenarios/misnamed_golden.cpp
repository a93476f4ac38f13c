// A user's test that doesn't compile: the compiler prints how a golden is named.
#include <rehearse/gtest.h>

TEST(Walker, StopsBeforeTheEdge) { EXPECT_MATCHES_GOLDEN(rehearse::record("walk.yaml"), "Walker.Walks"); }
