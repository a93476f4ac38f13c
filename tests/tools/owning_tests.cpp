// Tests whose names a search of the sources can't find: parameterised, typed, made by a macro. golden_owners_test.cpp
// runs this program.
#include <rehearse/gtest.h>

class Fall : public testing::TestWithParam<const char*> {};
TEST_P(Fall, Ends) { EXPECT_MATCHES_GOLDEN(rehearse::record(GetParam())); }
INSTANTIATE_TEST_SUITE_P(All, Fall, testing::Values("fall.yaml"));

template <class Number>
class Typed : public testing::Test {};
TYPED_TEST_SUITE(Typed, testing::Types<float>);
TYPED_TEST(Typed, Falls) { EXPECT_MATCHES_GOLDEN(rehearse::record("fall.yaml")); }

#define TEST_OF_FALL(suite) \
  TEST(suite, Falls) { EXPECT_MATCHES_GOLDEN(rehearse::record("fall.yaml")); }
TEST_OF_FALL(Macro)
