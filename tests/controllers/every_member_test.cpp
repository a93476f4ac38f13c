// Members of the API that no other test calls: each is called once, and compared with a value that isn't its default.
#include <gtest/gtest.h>
#include <cnoid/AttachmentDevice>
#include <cnoid/BasicSensors>
#include <cnoid/BodyMotion>
#include <cnoid/BodyState>
#include <cnoid/Camera>
#include <cnoid/CompositeIK>
#include <cnoid/Config>
#include <cnoid/EigenTypes>
#include <cnoid/EigenUtil>
#include <cnoid/ExtJoystick>
#include <cnoid/FileUtil>
#include <cnoid/FountainDevice>
#include <cnoid/HolderDevice>
#include <cnoid/JointPath>
#include <cnoid/JointTraverse>
#include <cnoid/Joystick>
#include <cnoid/LeggedBodyHelper>
#include <cnoid/MessageOut>
#include <cnoid/MessageView>
#include <cnoid/NullOut>
#include <cnoid/RangeCamera>
#include <cnoid/RangeSensor>
#include <cnoid/Sensor>
#include <cnoid/SharedJoystick>
#include <cnoid/SimpleController>
#include <cnoid/SpotLight>

#include <algorithm>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "bodies.h"
#include "scripted_joystick.h"
#include "test_io.h"

namespace every_member {
namespace {

using namespace cnoid;
namespace test = rehearse::test;
using test::make_arm;
using test::make_biped;
using test::make_six_joint_arm;

class CNOID_SIMPLE_CONTROLLER_EXPORT Exported : public SimpleController {
 public:
  static StateType flag() { return LinkTwist; }
};

SimpleController* make_exported() { return new Exported; }

TEST(EveryMember, OfTheControllersClass) {
  const SimpleController::Factory factory = make_exported;
  const std::unique_ptr<SimpleController> made(factory());
  EXPECT_NE(dynamic_cast<Exported*>(made.get()), nullptr);
  EXPECT_EQ(static_cast<int>(Exported::flag()), 32);
}

TEST(EveryMember, OfMessages) {
  std::ostringstream text;
  test::TestIO io(make_arm());
  MessageOut* out = io.mout();
  out->put("a");
  out->putln("b");
  out->putHighlighted("c");
  out->putWarning("d");
  out->putError("e");
  out->putHighlightedln("f");
  out->putWarningln("g");
  out->putErrorln("h");
  out->notify("i");
  out->notifyHighlighted("j");
  out->notifyWarning("k");
  out->notifyError("l");
  out->cout() << "m";
  out->cerr() << "n";
  out->flush();
  const std::string all = io.messages.str();
  for (const char letter : std::string("abcdefghijklmn")) EXPECT_NE(all.find(letter), std::string::npos) << letter;
  EXPECT_TRUE(out->hasErrors());
  EXPECT_NE(MessageOut::master(), nullptr);
  nullout() << "nowhere";
  EXPECT_EQ(nullout().rdbuf(), nullptr) << "it has no place for what is written";
}

/// What it writes goes to standard output.
TEST(EveryMember, OfTheViewOfMessages) {
  testing::internal::CaptureStdout();
  MessageView* view = MessageView::mainInstance();
  EXPECT_EQ(view, MessageView::instance());
  view->put("a");
  view->putln("b", MessageView::Highlight);
  view->putln();
  view->put(MessageView::WARNING, "c");
  view->notify("d", MessageView::Error);
  view->putln(MessageView::NORMAL, "e");
  view->cout() << "f";
  mvout() << "g";
  view->flush();
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "ab\n\nWarning: cError: d\ne\nfg");
  EXPECT_TRUE(view->hasErrorMessages());
}

TEST(EveryMember, OfALinksJoint) {
  LinkPtr link = new Link;
  link->setJointName("KNEE");
  EXPECT_EQ(link->jointSpecificName(), "KNEE");
  link->setJointAxis(Vector3(0, 0.6, 0.8));
  EXPECT_EQ(link->jointAxis(), Vector3(0, 0.6, 0.8));
  EXPECT_EQ(link->d(), Vector3(0, 0.6, 0.8));
  link->setInitialJointAngle(0.5236);
  EXPECT_EQ(link->q_initial(), 0.5236);
  link->setJointRange(-1.0, 2.0);
  link->setJointVelocityRange(-3.0, 4.0);
  link->setJointEffortRange(-5.0, 6.0);
  EXPECT_EQ(link->dq_lower(), -3.0);
  EXPECT_EQ(link->dq_upper(), 4.0);
  EXPECT_EQ(link->u_lower(), -5.0);
  EXPECT_EQ(link->u_upper(), 6.0);
  EXPECT_EQ(link->llimit(), -1.0);
  EXPECT_EQ(link->ulimit(), 2.0);
  EXPECT_EQ(link->lvlimit(), -3.0);
  EXPECT_EQ(link->uvlimit(), 4.0);
  link->setUnlimitedJointVelocityRange();
  EXPECT_TRUE(Link::isUnlimitedRangeValue(link->dq_upper()));
  link->setUnlimitedEffortRange();
  EXPECT_TRUE(Link::isUnlimitedRangeValue(link->u_lower()));
  link->setOffsetTranslation(Vector3(1, 2, 3));
  link->setOffsetRotation(AngleAxis(0.5, Vector3::UnitX()));
  EXPECT_EQ(Vector3(link->offsetTranslation()), Vector3(1, 2, 3));
  EXPECT_EQ(Vector3(link->Tb().translation()), Vector3(1, 2, 3));
  const Matrix3 turned = AngleAxis(0.5, Vector3::UnitX()).toRotationMatrix();
  EXPECT_TRUE(Matrix3(link->Rb()).isApprox(turned));
  EXPECT_TRUE(Matrix3(link->offsetRotation()).isApprox(turned));
  EXPECT_EQ(link->Rs(), Matrix3::Identity());
}

TEST(EveryMember, OfALinksTypes) {
  LinkPtr link = new Link;
  link->setJointType(Link::PrismaticJoint);
  const Link::JointType type = link->jointType();
  EXPECT_EQ(type, Link::PrismaticJoint);
  EXPECT_TRUE(link->isPrismaticJoint() && link->isSlideJoint() && link->hasJoint());
  EXPECT_FALSE(link->isRevoluteJoint() || link->isRotationalJoint());
  link->setJointType(Link::RevoluteJoint);
  EXPECT_TRUE(link->isRevoluteJoint() && link->isRotationalJoint());
  EXPECT_STREQ(link->jointTypeString(), "revolute");
  link->setJointType(static_cast<Link::JointType>(Link::PseudoContinousTrack));
  EXPECT_STREQ(link->jointTypeString(), "pseudo continuous track");
  EXPECT_STREQ(link->jointTypeString(true), "pseudo_continuous_track");
  const Link::StateFlag flag = Link::JointEffort;
  EXPECT_EQ(Link::getStateModeString(flag), "Joint Effort");
  EXPECT_EQ(Link::getStateModeString(Link::JointDisplacement | Link::LinkExtWrench),
            "Joint Displacement + Link External Wrench");
  EXPECT_EQ(Link::getStateModeString(0), "None");
  EXPECT_EQ(static_cast<int>(Link::AllStateHighGainActuationMode), 16 + 32 + 128 + 1 + 2 + 8 + 512);
}

TEST(EveryMember, OfALinksBody) {
  LinkPtr link = new Link, other = new Link;
  EXPECT_EQ(link->materialId(), 0);
  link->setMaterial("Rubber");
  EXPECT_NE(link->materialId(), 0);
  other->setMaterial("Rubber");
  EXPECT_EQ(link->materialId(), other->materialId());
  other->setMaterial("Steel");
  EXPECT_NE(link->materialId(), other->materialId());
  link->wc() = Vector3(1, 2, 3);
  EXPECT_EQ(link->centerOfMassGlobal(), Vector3(1, 2, 3));
  link->externalForce() = Vector3(4, 5, 6);
  link->externalTorque() = Vector3(7, 8, 9);
  EXPECT_EQ(link->F_ext(), (Vector6() << 4, 5, 6, 7, 8, 9).finished());
  link->setInfo("grip", 0.5);
  EXPECT_EQ(link->info<double>("grip"), 0.5);
}

TEST(EveryMember, OfABody) {
  const BodyPtr body = make_arm();
  body->resetDefaultPosition(Isometry3(Translation3(0, 0, 2)));
  EXPECT_EQ(body->defaultPosition().translation().z(), 2.0);
  body->joint(0)->setInitialJointDisplacement(0.25);
  body->initializePosition();
  EXPECT_EQ(body->joint(0)->q(), 0.25);
  EXPECT_EQ(body->rootLink()->p().z(), 2.0);
  body->setInfo("owner", std::string("me"));
  EXPECT_EQ(body->info<std::string>("owner"), "me");
  body->addExtraJoint(new ExtraJoint(ExtraJoint::Ball, Vector3::UnitX()));
  EXPECT_EQ(body->numExtraJoints(), 1);
  body->clearExtraJoints();
  EXPECT_EQ(body->numExtraJoints(), 0);
  EXPECT_EQ(body->parentBody(), nullptr);
  EXPECT_EQ(body->lastSerialLink()->name(), "ARM");
  EXPECT_EQ(body->findUniqueEndLink(), nullptr);
  EXPECT_EQ(make_six_joint_arm()->findUniqueEndLink()->name(), "L6");
}

TEST(EveryMember, OfABodysDevices) {
  const BodyPtr body = make_arm();
  const ForceSensorPtr first = new ForceSensor, second = new ForceSensor, third = new ForceSensor;
  body->addDevice(first, body->link("ARM"));
  body->addDevice(second, body->link("HAND"));
  body->addDevice(third, body->link("TOOL"));
  second->F()[0] = 3.0;
  body->initializeDeviceStates();
  EXPECT_EQ(second->F()[0], 0.0);
  EXPECT_TRUE(body->removeDevice(first));
  EXPECT_EQ(body->device(0), second.get());
  body->removeDevicesOfLink(body->link("TOOL"));
  EXPECT_EQ(body->numDevices(), 1);
  body->clearDevices();
  EXPECT_EQ(body->numDevices(), 0);
  DeviceList<ForceSensor> list;
  EXPECT_TRUE(list.try_push_back(first));
  EXPECT_FALSE(list.try_push_back(RateGyroSensorPtr(new RateGyroSensor)));
}

TEST(EveryMember, OfADevice) {
  ForceSensor sensor;
  sensor.setLocalRotation(AngleAxis(0.5, Vector3::UnitZ()).toRotationMatrix());
  EXPECT_NEAR(sensor.localRotation()(1, 0), std::sin(0.5), 1e-15);
  sensor.F()[2] = 7.0;
  const DeviceStatePtr copy = sensor.cloneState();
  EXPECT_EQ(dynamic_cast<ForceSensor&>(*copy).F()[2], 7.0);
  double time = 0.0;
  sensor.sigTimeChanged().connect([&](double now) { time = now; });
  sensor.notifyTimeChange(1.5);
  EXPECT_EQ(time, 1.5);
}

TEST(EveryMember, OfVisionSensors) {
  const CameraPtr camera = new Camera;
  camera->setDelay(0.25);
  EXPECT_EQ(camera->delay(), 0.25);
  camera->setOpticalFrame(VisionSensor::CV);
  EXPECT_EQ(camera->opticalFrameRotation()(2, 2), -1.0);
  camera->setOpticalFrameRotation(2.0 * Matrix3::Identity());
  EXPECT_EQ(camera->opticalFrameRotation()(0, 0), 2.0);
  camera->setNearDistance(0.5);
  camera->setFarDistance(9.0);
  EXPECT_EQ(camera->nearDistance(), 0.5);
  EXPECT_EQ(camera->farClipDistance(), 9.0);
  EXPECT_EQ(camera->farDistance(), 9.0);
  camera->image().setSize(2, 2, 3);
  EXPECT_FALSE(camera->constImage().empty());
  camera->setImageStateClonable(true);
  EXPECT_TRUE(camera->isImageStateClonable());
  camera->clearImage();
  EXPECT_TRUE(camera->constImage().empty());
}

TEST(EveryMember, OfRangeSensors) {
  RangeCamera camera;
  camera.points().emplace_back(1.0f, 2.0f, 3.0f);
  EXPECT_EQ(camera.sharedPoints()->at(0).z(), 3.0f);
  camera.setDense(true);
  EXPECT_TRUE(camera.isDense());
  camera.clearPoints();
  EXPECT_EQ(camera.numPoints(), 0);
  RangeSensor sensor;
  sensor.rangeData().push_back(4.0);
  EXPECT_EQ(sensor.sharedRangeData()->at(0), 4.0);
  sensor.setRangeDataStateClonable(true);
  EXPECT_TRUE(sensor.isRangeDataStateClonable());
  sensor.setYawRange(-0.5, 1.0);
  EXPECT_EQ(sensor.yawRange(), 1.5);
  sensor.clearRangeData();
  EXPECT_TRUE(sensor.constRangeData().empty());
  const LightPtr light = new SpotLight;
  light->setIntensity(0.5f);
  EXPECT_EQ(light->intensity(), 0.5f);
}

TEST(EveryMember, OfHoldersAndAttachments) {
  const HolderDevicePtr holder = new HolderDevice;
  const AttachmentDevicePtr attachment = new AttachmentDevice;
  holder->addCategory("tool");
  EXPECT_TRUE(holder->hasCategories());
  holder->clearCategories();
  EXPECT_FALSE(holder->hasCategories());
  attachment->setCategory("tool");
  EXPECT_EQ(attachment->category(), "tool");
  attachment->clearCategory();
  EXPECT_EQ(attachment->category(), "");
  EXPECT_TRUE(holder->addAttachment(attachment));
  EXPECT_EQ(holder->numAttachments(), 1);
  holder->clearAttachments();
  EXPECT_EQ(holder->numAttachments(), 0);
  const FountainDevicePtr fountain = new FountainDevice;
  ParticleSystem& particles = fountain->particleSystem();
  particles.setLifeTime(2.0f);
  EXPECT_EQ(particles.lifeTime(), 2.0f);
}

TEST(EveryMember, OfAJoysticksButtons) {
  auto device = std::make_unique<test::ScriptedJoystick>();
  ExtJoystick::registerJoystick("every", device.get());
  bool isDestroyed = false;
  device->sigDestroyed().connect([&] { isDestroyed = true; });
  Joystick joystick("every");
  const Joystick::AxisID axis = Joystick::L_STICK_V_AXIS;
  const Joystick::ButtonID button = Joystick::B_BUTTON;
  const auto read = [&](double time, bool isPressed) {
    device->time = time;
    device->buttons.at(button) = isPressed;
    joystick.readCurrentState();
  };
  device->axes.at(axis) = 0.5;
  read(0.0, false);
  EXPECT_EQ(joystick.getPosition(axis), 0.5);
  joystick.setAxisEnabled(axis, false);
  EXPECT_EQ(joystick.getPosition(axis), 0.0);
  joystick.setAxisEnabled(axis, true);
  EXPECT_EQ(joystick.getPosition(axis), 0.5);
  EXPECT_FALSE(joystick.getButtonDown(button));
  read(0.1, true);
  EXPECT_TRUE(joystick.getButtonDown(button));
  EXPECT_FALSE(joystick.getButtonHoldOn(button, 50));
  read(0.15, true);
  EXPECT_FALSE(joystick.getButtonDown(button));
  EXPECT_FALSE(joystick.getButtonHoldOn(button, 50)) << "not longer than 50 ms";
  read(0.2, true);
  EXPECT_TRUE(joystick.getButtonHoldOn(button, 50));
  EXPECT_TRUE(joystick.getButtonHold(button, 50));
  EXPECT_FALSE(joystick.getButtonHold(button, 50)) << "told once for each press";
  read(0.3, false);
  EXPECT_TRUE(joystick.getButtonUp(button));
  read(0.4, false);
  EXPECT_FALSE(joystick.getButtonUp(button));
  SharedJoystick shared;
  device->buttons.at(Joystick::LOGO_BUTTON) = true;
  shared.setJoystick(&joystick);
  EXPECT_TRUE(shared.getModeButtonState());
  device.reset();
  EXPECT_TRUE(isDestroyed);
}

TEST(EveryMember, OfPathsOfJoints) {
  const BodyPtr body = make_six_joint_arm();
  JointTraverse traverse;
  traverse.appendLink(body->link("L2"));
  EXPECT_EQ(traverse.link(0)->name(), "L2");
  JointPath path(body->link("BASE"), body->link("L6"));
  EXPECT_EQ(path.linkPath().numLinks(), 7);
  EXPECT_TRUE(path.isBestEffortIkAvailable());
  EXPECT_EQ(path.getDOF(), 6);
  path.setNumericalIkMaxIkError(1e-4);
  path.setNumericalIkDeltaScale(0.5);
  path.setNumericalIkDampingConstant(1e-3);
  path.setNumericalIkMaxStagnationCount(9);
  path.setNumericalIkMaxIterations(1);
  Isometry3 goal = body->link("L6")->T();
  goal.translation() += Vector3(0.2, 0.1, 0.0);
  EXPECT_FALSE(path.calcInverseKinematics(goal));
  EXPECT_EQ(path.numIterations(), 1);
  EXPECT_EQ(JointPath::numericalIkDefaultMaxIterations(), 50);
  EXPECT_EQ(JointPath::numericalIkDefaultDeltaScale(), 0.9);
  EXPECT_EQ(JointPath::numericalIkDefaultMaxStagnationCount(), 3);
  EXPECT_EQ(JointPath::numericalIkDefaultMaxIkError(), 1.0e-7);
  EXPECT_EQ(JointPath::numericalIkDefaultDampingConstant(), 1.0e-6);
}

TEST(EveryMember, OfLegs) {
  const BodyPtr body = make_biped();
  CompositeIK ik(body, body->link("WAIST"));
  EXPECT_EQ(ik.targetLink()->name(), "WAIST");
  ASSERT_TRUE(ik.addBaseLink(body->link("LEFT6")));
  EXPECT_EQ(ik.jointPath(0)->baseLink()->name(), "LEFT6");
  ik.setMaxIkError(1e-3);
  Isometry3 goal = body->rootLink()->T();
  goal.translation().z() -= 0.01;
  EXPECT_TRUE(ik.calcInverseKinematics(goal));
  const LeggedBodyHelper legs(body);
  EXPECT_NEAR((legs.homeCopOfSole(0) - legs.footLink(0)->T() * legs.homeCopOfSoleLocal(0)).norm(), 0.0, 1e-15);
  EXPECT_GT(legs.homeCopOfSole(0).norm(), 0.1);
}

TEST(EveryMember, OfMotions) {
  BodyMotion motion;
  motion.setFrameRate(50.0);
  motion.setDimension(3, 2, 1);
  EXPECT_EQ(motion.getNumParts(), 2);
  EXPECT_EQ(motion.positionSeq(), motion.stateSeq());
  EXPECT_FALSE(motion.loadStandardYAMLformat("nowhere.seq"));
  motion.setDimension(3, 2, 1);
  const auto extra = motion.getOrCreateExtraSeq<MultiValueSeq>("Grip");
  EXPECT_EQ(extra->frameRate(), 50.0);
  EXPECT_EQ(motion.extraSeqBegin()->first, "Grip");
  EXPECT_NE(motion.extraSeqBegin(), motion.extraSeqEnd());
  auto other = std::make_shared<MultiValueSeq>();
  other->setSeqContentName("Gaze");
  motion.setExtraSeq(other);
  EXPECT_EQ(motion.extraSeq<MultiValueSeq>("Gaze"), other);
  motion.clearExtraSeq("Gaze");
  EXPECT_EQ(motion.extraSeq<MultiValueSeq>("Gaze"), nullptr);
  extra->setDimension(2, 1);
  extra->frame(1)[0] = 5.0;
  extra->popFrontFrame();
  EXPECT_EQ(extra->frame(0)[0], 5.0);
  extra->setOffsetTimeFrame(10);
  EXPECT_EQ(extra->offsetTimeFrame(), 10);
  const AbstractSeq& sequence = *extra;
  EXPECT_EQ(sequence.getOffsetTimeFrame(), 10);
  EXPECT_EQ(extra->offsetTime(), 0.2);
  extra->setTimeLength(0.5);
  EXPECT_EQ(extra->numFrames(), 25);
}

TEST(EveryMember, OfStatesOfBodies) {
  const BodyPtr body = make_arm();
  const ForceSensorPtr sensor = new ForceSensor;
  body->addDevice(sensor, body->link("ARM"));
  sensor->F()[1] = 6.0;
  body->joint(1)->q() = 0.3;
  const BodyState state(body);
  EXPECT_EQ(state.jointDisplacements()[1], 0.3);
  EXPECT_EQ(dynamic_cast<ForceSensor&>(*state.deviceState(0)).F()[1], 6.0);
  BodyState position;
  position.storePositionOfBody(body);
  EXPECT_EQ(position.numDeviceStates(), 0);
  body->joint(1)->q() = 0.0;
  EXPECT_TRUE(position.restorePositionToBody(body));
  EXPECT_EQ(body->joint(1)->q(), 0.3);
}

TEST(EveryMember, OfUtilities) {
  EXPECT_EQ(TO_DEGREE * TO_RADIAN, 1.0);
  EXPECT_NEAR(TO_RADIAN, 0.0174533, 1e-7);
  const Quat turn(0.0, 1.0, 0.0, 0.0);
  EXPECT_EQ(turn.x(), 1.0);
  EXPECT_EQ(*make_shared_aligned<Vector4>(1, 2, 3, 4), Vector4(1, 2, 3, 4));
  EXPECT_EQ(getPathString("a/b"), "a/b");
  EXPECT_EQ(std::string(DLL_SUFFIX), ".so");
  ref_ptr<Link> a = new Link, b;
  a->setName("A");
  a.swap(b);
  EXPECT_EQ(b->name(), "A");
  const ref_ptr<const Link> constant = b;
  EXPECT_EQ(const_pointer_cast<Link>(constant), b);
}

TEST(EveryMember, OfTrees) {
  const MappingPtr map = new Mapping;
  map->write("angle", 90.0);
  EXPECT_EQ(map->nodeType(), ValueNode::MAPPING);
  double angle = 0.0;
  EXPECT_TRUE(map->readAngle("angle", angle));
  EXPECT_NEAR(angle, PI / 2.0, 1e-15);
  EXPECT_NEAR(map->get("angle").toAngle(), PI / 2.0, 1e-15);
  float narrow = 0.0f;
  map->setForcedRadianMode();
  EXPECT_TRUE(map->isForcedRadianMode());
  EXPECT_FALSE(map->isDegreeMode());
  EXPECT_TRUE(map->readAngle({"none", "angle"}, narrow));
  EXPECT_EQ(narrow, 90.0f);
  const MappingPtr degrees = new Mapping;
  EXPECT_TRUE(map->readAngle({"angle"}, angle, degrees));
  EXPECT_NEAR(angle, PI / 2.0, 1e-15);
  EXPECT_FALSE(map->readAngle("none", narrow));
  map->setDegreeMode();
  EXPECT_TRUE(map->isDegreeMode());
  Listing* list = map->openSequence("list");
  list->reserve(4);
  list->append(new ScalarNode(5));
  EXPECT_EQ(map->findSequence("list")->at(0)->toInt(), 5);
  EXPECT_TRUE(list->isSequence());
  EXPECT_EQ(map->get("list").toSequence()->size(), 1);
  EXPECT_EQ(map->createSequence("list")->size(), 0);
  try {
    map->throwException("as it is");
  } catch (const ValueNode::Exception& problem) {
    EXPECT_EQ(problem.text(), "as it is");
  }
  struct Counted : ClonableReferenced {
    Referenced* doClone(CloneMap* map) const override { return map ? nullptr : new Counted; }
  };
  const ref_ptr<Referenced> copy = Counted().doClone(nullptr);
  EXPECT_NE(copy, nullptr);
}

}  // namespace
}  // namespace every_member
