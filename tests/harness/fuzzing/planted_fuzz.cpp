// A fuzz test with a finding, one with a mistake, and a test that is none.
#include <rehearse/fuzz.h>

FUZZ_CONTROLLER(Planted, ComparesFloats, PLANTED_CONTROLLERS "/Planted.so", PLANTED_MODEL)
    .joint("A", q.in(-1, 1), dq.in(-3, 3))
    .options("Equality")
    .ticks(16)
    .runs(320);

FUZZ_CONTROLLER(Planted, NamesNoJoint, PLANTED_CONTROLLERS "/Planted.so", PLANTED_MODEL)
    .joint("D", q.in(-1, 1))
    .options("Equality");

TEST(Planted, IsNoFuzzTest) {}
