// The definitions of the standard types, compared with those of the recordings.
#include <rehearse/messages.h>

#include <gmock/gmock.h>

#include "logs/bag/standard_types.h"

namespace rehearse {
namespace {

template <class T>
class StandardTypes : public testing::Test {};

using Recorded = testing::Types<msg::Time, msg::Header, msg::Pose, msg::Twist, msg::Accel, msg::Wrench,
                                msg::TransformStamped, msg::PoseStamped, msg::TwistStamped, msg::AccelStamped,
                                msg::WrenchStamped, msg::TFMessage, msg::JointState, msg::Imu, msg::Image,
                                msg::CompressedImage, msg::CameraInfo, msg::LaserScan, msg::PointCloud2, msg::Joy>;
TYPED_TEST_SUITE(StandardTypes, Recorded);

TYPED_TEST(StandardTypes, AreThoseOfRecordings) {
  EXPECT_EQ(bag::standard_definition(TypeParam::type_name), msg::schema_text<TypeParam>());
}

TEST(StandardType, ThatIsUnknownHasNoDefinition) {
  EXPECT_EQ(bag::standard_definition("my_msgs/msg/Load"), std::nullopt);
  EXPECT_EQ(bag::standard_definition("sensor_msgs/JointState"), std::nullopt);
  EXPECT_EQ(bag::standard_definition("sensor_msgs/srv/SetCameraInfo"), std::nullopt);
}

}  // namespace
}  // namespace rehearse
