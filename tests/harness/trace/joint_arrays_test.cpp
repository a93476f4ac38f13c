// The numbers of joint messages, which are read without decoding names while the layout stays the same.
#include "core/kinds/joint_arrays.h"

#include <gmock/gmock.h>
#include <rehearse/cdr.h>
#include <rehearse/messages.h>

namespace rehearse {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

bool read(JointArrays& arrays, const msg::JointState& message) {
  CdrWriter writer;
  msg::encode(message, writer);
  return arrays.read(writer.bytes());
}

msg::JointState two_joints(double q, double u) {
  return {{{1, 0}, "world"}, {"HIP", "KNEE"}, {q, q + 1.0}, {}, {u, u + 1.0}};
}

TEST(JointArrays, KeepAddressesWhileNamesAndCountsStayTheSame) {
  JointArrays arrays;
  ASSERT_TRUE(read(arrays, two_joints(0.0, 5.0)));
  EXPECT_TRUE(arrays.layout_changed());
  const double* const knee = &arrays.position()[1];
  ASSERT_TRUE(read(arrays, two_joints(2.0, 7.0)));
  EXPECT_FALSE(arrays.layout_changed());
  EXPECT_EQ(knee, &arrays.position()[1]);
  EXPECT_THAT(arrays.position(), ElementsAre(2.0, 3.0));
  EXPECT_THAT(arrays.velocity(), IsEmpty());
  EXPECT_THAT(arrays.effort(), ElementsAre(7.0, 8.0));
}

TEST(JointArrays, ReportsAnArrayThatIsEmptyInALaterMessage) {
  JointArrays arrays;
  ASSERT_TRUE(read(arrays, two_joints(0.0, 5.0)));
  msg::JointState without_effort = two_joints(1.0, 0.0);
  without_effort.effort.clear();
  ASSERT_TRUE(read(arrays, without_effort));
  EXPECT_TRUE(arrays.layout_changed());
  EXPECT_THAT(arrays.effort(), IsEmpty());
}

TEST(JointArrays, ReportsOtherNamesOfTheSameLength) {
  JointArrays arrays;
  ASSERT_TRUE(read(arrays, two_joints(0.0, 5.0)));
  msg::JointState other = two_joints(0.0, 5.0);
  other.name = {"TOE", "HEAD"};
  ASSERT_TRUE(read(arrays, other));
  EXPECT_TRUE(arrays.layout_changed());
  EXPECT_THAT(arrays.names(), ElementsAre("TOE", "HEAD"));
}

TEST(JointArrays, ReadsAValidMessageAfterAnInvalidOneOfTheSameLength) {
  JointArrays arrays;
  ASSERT_TRUE(read(arrays, two_joints(0.0, 5.0)));
  CdrWriter writer;
  msg::encode(two_joints(0.0, 5.0), writer);
  std::vector<std::byte> wrong(writer.bytes().begin(), writer.bytes().end());
  std::fill(wrong.begin() + 12, wrong.end(), std::byte{0xff});
  EXPECT_FALSE(arrays.read(wrong));
  ASSERT_TRUE(read(arrays, two_joints(2.0, 7.0)));
  EXPECT_THAT(arrays.position(), ElementsAre(2.0, 3.0));
}

TEST(JointArrays, TellsArraysThatAreShorterThanTheNames) {
  JointArrays arrays;
  msg::JointState wrong = two_joints(0.0, 5.0);
  wrong.position.pop_back();
  EXPECT_TRUE(read(arrays, wrong));
  EXPECT_FALSE(arrays.fit_the_names());
}

}  // namespace
}  // namespace rehearse
