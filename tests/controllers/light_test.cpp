#include <gtest/gtest.h>
#include <cnoid/SpotLight>

#include <algorithm>
#include <type_traits>

namespace {

using cnoid::SpotLight;
using cnoid::SpotLightPtr;
using cnoid::Vector3;

TEST(SpotLight, HasChoreonoidsDefaults) {
  const SpotLightPtr light = new SpotLight;
  EXPECT_TRUE(light->on());
  EXPECT_EQ(light->color(), cnoid::Vector3f(1, 1, 1));
  EXPECT_EQ(light->intensity(), 1.0f);
  EXPECT_EQ(light->direction(), Vector3(0, 0, -1));
  EXPECT_EQ(light->beamWidth(), 1.570796f);
  EXPECT_EQ(light->cutOffAngle(), 0.785398f);
  EXPECT_EQ(light->constantAttenuation(), 1.0f);
}

TEST(SpotLight, GivesItsBeamWidthAsAFloatThatMixesWithFloats) {
  const SpotLightPtr light = new SpotLight;
  static_assert(std::is_same_v<decltype(light->beamWidth()), float>);
  light->setBeamWidth(std::max(0.1f, light->beamWidth() - 10.0f));
  EXPECT_EQ(light->beamWidth(), 0.1f);
}

TEST(SpotLight, CopiesWhatItInherits) {
  const SpotLightPtr source = new SpotLight;
  const SpotLightPtr target = new SpotLight;
  source->on(false);
  source->setColor(Vector3(0.5, 0.25, 0.125));
  source->setQuadraticAttenuation(2.0f);
  target->copyStateFrom(*source);
  EXPECT_FALSE(target->on());
  EXPECT_EQ(target->color(), cnoid::Vector3f(0.5f, 0.25f, 0.125f));
  EXPECT_EQ(target->quadraticAttenuation(), 2.0f);
}

}  // namespace
