// A controller as a user writes it: two include paths, no library of Rehearse. It uses all features that may break
// between two separately compiled libraries: type information, Eigen members, signals, reference counts, shared
// objects.

#include <cnoid/BasicSensors>
#include <cnoid/Link>
#include <cnoid/RangeCamera>
#include <cnoid/SimpleController>
#include <cnoid/SpotLight>
#include <vector>

using namespace cnoid;

class StepCounter : public Referenced {
 public:
  int steps = 0;
};

class UserController : public SimpleController {
  BodyPtr ioBody;
  SimpleControllerIO* io;
  double dt;
  std::vector<double> qref;
  std::vector<double> qold;
  DeviceList<ForceSensor> forceSensors;
  DeviceList<Camera> cameras;
  AccelerationSensor* accelSensor;
  SpotLightPtr light;
  ref_ptr<StepCounter> counter;

 public:
  virtual bool configure(SimpleControllerConfig* config) override {
    config->os() << "configured " << config->body()->name() << std::endl;
    return true;
  }

  virtual bool initialize(SimpleControllerIO* io) override {
    this->io = io;
    ioBody = io->body();
    dt = io->timeStep();
    for (auto& option : io->options()) io->os() << "option " << option << std::endl;

    for (int i = 0; i < ioBody->numJoints(); ++i) {
      Link* joint = ioBody->joint(i);
      joint->setActuationMode(JointTorque);
      io->enableIO(joint);
      qref.push_back(joint->q());
    }
    qold = qref;
    io->enableInput(ioBody->rootLink(), LinkPosition | LinkTwist | LinkAcceleration);

    forceSensors << ioBody->devices();
    for (size_t i = 0; i < forceSensors.size(); ++i) {
      ForceSensor* forceSensor = forceSensors[i];
      io->enableInput(forceSensor);
    }
    cameras << ioBody->devices();
    accelSensor = ioBody->findDevice<AccelerationSensor>("accel");
    io->enableInput(accelSensor);
    DevicePtr device = ioBody->findDevice("lamp");
    light = dynamic_pointer_cast<SpotLight>(device);
    counter = io->getOrCreateSharedObject<StepCounter>("counter");
    return light && accelSensor && forceSensors.size() == 1 && cameras.size() == 1;
  }

  virtual bool control() override {
    for (int i = 0; i < ioBody->numJoints(); ++i) {
      Link* joint = ioBody->joint(i);
      double q = joint->q();
      double dq = (q - qold[i]) / dt;
      qold[i] = q;
      joint->u() = (qref[i] - q) * 100.0 + (0.0 - dq) * 10.0;
    }
    Isometry3 T = ioBody->rootLink()->position();
    Vector3 p = T.translation();
    Vector3 dv = accelSensor->dv();
    ioBody->joint(0)->q_target() = p.z() + dv.z() + forceSensors[0]->f().z();
    if (!cameras[0]->constImage().empty()) light->on(false);
    light->setBeamWidth(std::max(0.1f, light->beamWidth() - 0.5f));
    light->notifyStateChange();
    ++counter->steps;
    return true;
  }
};

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(UserController)
