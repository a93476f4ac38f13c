// The functions of rehearse/controller.h, by calls of the classes in <cnoid/...>.
#include "rehearse/c_controller.h"

#include <cnoid/Camera>
#include <cnoid/EigenUtil>
#include <cnoid/RangeCamera>
#include <cnoid/RangeSensor>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

using cnoid::Device;
using cnoid::Link;

struct rehearse_io {
  cnoid::SimpleControllerIO* io = nullptr;
  std::string name;
  std::string options;
  bool initializing = false;
  mutable std::string error;  // of the last failure
};

namespace rehearse {
namespace {

/// The bits of a quantity, and its flags in a link.
struct QuantityFlags {
  int quantity;
  int input;
  int output;  // 0: it can't be commanded
};
constexpr QuantityFlags all_quantities[] = {
    {REHEARSE_Q, Link::JointDisplacement, Link::JointDisplacement},
    {REHEARSE_DQ, Link::JointVelocity, Link::JointVelocity},
    {REHEARSE_DDQ, Link::JointAcceleration, 0},
    {REHEARSE_U, Link::JointEffort, Link::JointEffort},
    {REHEARSE_POSE, Link::LinkPosition, Link::LinkPosition},
    {REHEARSE_TWIST, Link::LinkTwist, Link::LinkTwist},
    {REHEARSE_ACCELERATION, Link::LinkAcceleration, 0},
    {REHEARSE_WRENCH, 0, Link::LinkExtWrench},
};
constexpr int joint_quantities = REHEARSE_Q | REHEARSE_DQ | REHEARSE_DDQ | REHEARSE_U;

int fail(const rehearse_io& io, int code, std::string sentence) {
  io.error = std::move(sentence);
  return code;
}

/// Calls `body`, which returns a code or a count. An exception of the classes that it calls is a bad argument.
template <class Body>
int guarded(const rehearse_io* io, Body body) {
  if (!io) return REHEARSE_BAD_ARGUMENT;
  try {
    return body();
  } catch (const std::exception& exception) {
    return fail(*io, REHEARSE_BAD_ARGUMENT, exception.what());
  }
}

Link* link_of(rehearse_io& io, int handle) {
  Link* link = handle >= 0 ? io.io->body()->link(handle) : nullptr;
  if (!link) fail(io, REHEARSE_BAD_ARGUMENT, "no link has the handle " + std::to_string(handle));
  return link;
}

/// As link_of(), and null if nothing moves the link.
Link* joint_of(rehearse_io& io, int handle) {
  Link* link = link_of(io, handle);
  if (!link || link->jointId() >= 0) return link;
  fail(io, REHEARSE_BAD_ARGUMENT, "link '" + link->name() + "' has no joint");
  return nullptr;
}

Device* device_of(rehearse_io& io, int handle) {
  Device* device = handle >= 0 && handle < io.io->body()->numDevices() ? io.io->body()->device(handle) : nullptr;
  if (!device) fail(io, REHEARSE_BAD_ARGUMENT, "no device has the handle " + std::to_string(handle));
  return device;
}

template <class Type>
Type* device_as(rehearse_io& io, int handle, const char* type) {
  Device* device = device_of(io, handle);
  auto* const wanted = dynamic_cast<Type*>(device);
  if (device && !wanted)
    fail(io, REHEARSE_BAD_ARGUMENT, "device '" + device->name() + "' is a " + device->typeName() + ", no " + type);
  return wanted;
}

/// The handle of an object found by its name. `names` is called if there is none.
template <class Object, class Names>
int handle_of(const rehearse_io& io, const char* kind, const char* name, const Object* found, Names names) {
  if (found) return found->index();
  std::string all;
  names([&](const std::string& known) { all += (all.empty() ? "" : ", ") + known; });
  return fail(io, REHEARSE_NOT_FOUND,
              std::string("the robot has no ") + kind + " '" + name + "'" +
                  (all.empty() ? ", and no other one" : "; it has " + all));
}

/// The flags of quantities; -1: one of them isn't known, or has no flag.
int flags_of(int quantities, int QuantityFlags::*flag) {
  int flags = 0;
  for (const QuantityFlags& known : all_quantities) {
    if (!(quantities & known.quantity)) continue;
    if (known.*flag == 0) return -1;
    flags |= known.*flag;
    quantities &= ~known.quantity;
  }
  return quantities == 0 ? flags : -1;
}

int enable(rehearse_io* io, int handle, int quantities, int QuantityFlags::*flag) {
  return guarded(io, [&] {
    if (!io->initializing) return fail(*io, REHEARSE_TOO_LATE, "inputs and outputs are fixed after initialize()");
    const bool is_input = flag == &QuantityFlags::input;
    const int flags = flags_of(quantities, flag);
    if (flags < 0)
      return fail(*io, REHEARSE_BAD_ARGUMENT,
                  "the quantities " + std::to_string(quantities) + " can't be " + (is_input ? "read" : "commanded"));
    Link* const link = quantities & joint_quantities ? joint_of(*io, handle) : link_of(*io, handle);
    if (!link) return int{REHEARSE_BAD_ARGUMENT};
    if (is_input)
      io->io->enableInput(link, flags);
    else
      io->io->enableOutput(link, flags);
    return int{REHEARSE_OK};
  });
}

/// The numbers of a vector quantity: 7 or 6; 0: the quantity isn't one.
int size_of(int quantity) {
  if (quantity == REHEARSE_POSE) return 7;
  return quantity == REHEARSE_TWIST || quantity == REHEARSE_ACCELERATION || quantity == REHEARSE_WRENCH ? 6 : 0;
}

Link* link_for_numbers(rehearse_io& io, int handle, int quantity, const double* numbers, int size) {
  Link* const link = link_of(io, handle);
  if (!link) return nullptr;
  const int needed = size_of(quantity);
  if (needed != 0 && needed == size && numbers) return link;
  fail(io, REHEARSE_BAD_ARGUMENT,
       needed == 0 ? "the quantity " + std::to_string(quantity) + " has no list of numbers"
                   : "the quantity has " + std::to_string(needed) + " numbers, not " + std::to_string(size));
  return nullptr;
}

void put(const cnoid::Vector3& v, double* numbers) { std::copy(v.data(), v.data() + 3, numbers); }
cnoid::Vector3 vector(const double* numbers) { return {numbers[0], numbers[1], numbers[2]}; }

class CController final : public cnoid::SimpleController {
 public:
  explicit CController(const rehearse_controller_functions& functions) : functions_(functions) {
    if (functions.create) self_ = functions.create();
  }
  ~CController() override {
    if (functions_.destroy) functions_.destroy(self_);
  }

  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_.io = io;
    io_.name = io->controllerName();
    io_.options = io->optionString();
    io_.initializing = true;
    const bool accepted = is_accepted(functions_.initialize(self_, &io_));
    io_.initializing = false;
    return accepted;
  }
  bool start() override { return !functions_.start || is_accepted(functions_.start(self_)); }
  bool control() override {
    io_.error.clear();
    const int result = functions_.control(self_);
    if (result >= 0) return result != REHEARSE_FINISHED;
    throw ReportedFailure("returned " + std::to_string(result) + (io_.error.empty() ? "" : ": " + io_.error));
  }
  void stop() override {
    if (functions_.stop) functions_.stop(self_);
  }

 private:
  bool is_accepted(int result) const {
    if (result >= 0) return true;
    if (!io_.error.empty()) io_.io->os() << io_.name << ": " << io_.error << std::endl;
    return false;
  }

  const rehearse_controller_functions& functions_;
  void* self_ = nullptr;
  rehearse_io io_;
};

}  // namespace

ReportedFailure::~ReportedFailure() = default;

std::string problem_of(const rehearse_controller_functions& functions) {
  if (functions.abi != REHEARSE_CONTROLLER_ABI)
    return "its rehearse_controller states version " + std::to_string(functions.abi) +
           "; this Rehearse knows version " + std::to_string(REHEARSE_CONTROLLER_ABI);
  if (functions.initialize && functions.control) return "";
  return std::string("its rehearse_controller has no ") + (functions.initialize ? "control" : "initialize");
}

cnoid::SimpleController* make_c_controller(const rehearse_controller_functions& functions) {
  return new CController(functions);
}

}  // namespace rehearse

using rehearse::fail;
using rehearse::guarded;

double rehearse_time_step(const rehearse_io* io) { return io->io->timeStep(); }
double rehearse_time(const rehearse_io* io) { return io->io->currentTime(); }
const char* rehearse_name(const rehearse_io* io) { return io->name.c_str(); }
const char* rehearse_options(const rehearse_io* io) { return io->options.c_str(); }

int rehearse_set_no_delay(rehearse_io* io, int on) {
  return guarded(io, [&] {
    if (!io->initializing) return fail(*io, REHEARSE_TOO_LATE, "the delay is fixed after initialize()");
    io->io->setNoDelayMode(on != 0);
    return int{REHEARSE_OK};
  });
}

void rehearse_print(rehearse_io* io, const char* text) { io->io->os() << (text ? text : "") << std::flush; }

const char* rehearse_error(const rehearse_io* io) { return io ? io->error.c_str() : "the rehearse_io is null"; }
int rehearse_set_error(rehearse_io* io, const char* text) {
  return guarded(io, [&] { return fail(*io, REHEARSE_FAILED, text ? text : ""); });
}

int rehearse_joint_count(const rehearse_io* io) {
  return guarded(io, [&] { return io->io->body()->numJoints(); });
}

int rehearse_joint_of_id(rehearse_io* io, int id) {
  return guarded(io, [&] {
    const Link* joint = id >= 0 && id < io->io->body()->numJoints() ? io->io->body()->joint(id) : nullptr;
    if (joint && joint->isValid()) return joint->index();
    return fail(*io, REHEARSE_NOT_FOUND, "the robot has no joint with the id " + std::to_string(id));
  });
}

int rehearse_joint(rehearse_io* io, const char* name) {
  return guarded(io, [&] {
    if (!name) return fail(*io, REHEARSE_BAD_ARGUMENT, "the name is null");
    cnoid::Body& body = *io->io->body();
    const Link* found = body.joint(std::string(name));
    if (found && found->jointId() < 0) found = nullptr;
    return rehearse::handle_of(*io, "joint", name, found, [&](auto add) {
      for (const Link* joint : body.joints())
        if (joint->isValid()) add(joint->jointName());
    });
  });
}

int rehearse_link_count(const rehearse_io* io) {
  return guarded(io, [&] { return io->io->body()->numLinks(); });
}

int rehearse_link(rehearse_io* io, const char* name) {
  return guarded(io, [&] {
    if (!name) return fail(*io, REHEARSE_BAD_ARGUMENT, "the name is null");
    cnoid::Body& body = *io->io->body();
    return rehearse::handle_of(*io, "link", name, body.link(std::string(name)), [&](auto add) {
      for (int i = 0; i < body.numLinks(); ++i) add(body.link(i)->name());
    });
  });
}

const char* rehearse_joint_name(rehearse_io* io, int joint) {
  const Link* found = io ? rehearse::joint_of(*io, joint) : nullptr;
  return found ? found->jointName().c_str() : nullptr;
}

const char* rehearse_link_name(rehearse_io* io, int link) {
  const Link* found = io ? rehearse::link_of(*io, link) : nullptr;
  return found ? found->name().c_str() : nullptr;
}

int rehearse_read(rehearse_io* io, int link, int quantities) {
  return rehearse::enable(io, link, quantities, &rehearse::QuantityFlags::input);
}

int rehearse_command(rehearse_io* io, int link, int quantities) {
  return rehearse::enable(io, link, quantities, &rehearse::QuantityFlags::output);
}

double rehearse_get(rehearse_io* io, int joint, int quantity) {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  const Link* found = io ? rehearse::joint_of(*io, joint) : nullptr;
  if (!found) return nothing;
  switch (quantity) {
    case REHEARSE_Q: return found->q();
    case REHEARSE_DQ: return found->dq();
    case REHEARSE_DDQ: return found->ddq();
    case REHEARSE_U: return found->u();
    default: break;
  }
  fail(*io, REHEARSE_BAD_ARGUMENT, "the quantity " + std::to_string(quantity) + " is no number of a joint");
  return nothing;
}

int rehearse_set(rehearse_io* io, int joint, int quantity, double value) {
  return guarded(io, [&] {
    Link* found = rehearse::joint_of(*io, joint);
    if (!found) return int{REHEARSE_BAD_ARGUMENT};
    switch (quantity) {
      case REHEARSE_Q: found->q_target() = value; return int{REHEARSE_OK};
      case REHEARSE_DQ: found->dq_target() = value; return int{REHEARSE_OK};
      case REHEARSE_U: found->u() = value; return int{REHEARSE_OK};
      default: break;
    }
    return fail(*io, REHEARSE_BAD_ARGUMENT, "the quantity " + std::to_string(quantity) + " is no command of a joint");
  });
}

int rehearse_get_numbers(rehearse_io* io, int link, int quantity, double* numbers, int size) {
  return guarded(io, [&] {
    const Link* found = rehearse::link_for_numbers(*io, link, quantity, numbers, size);
    if (!found) return int{REHEARSE_BAD_ARGUMENT};
    if (quantity == REHEARSE_POSE) {
      const Eigen::Quaterniond rotation(Eigen::Matrix3d(found->R()));
      rehearse::put(found->p(), numbers);
      std::copy(rotation.coeffs().data(), rotation.coeffs().data() + 4, numbers + 3);
    } else if (quantity == REHEARSE_WRENCH) {
      std::copy(found->F_ext().data(), found->F_ext().data() + 6, numbers);
    } else {
      rehearse::put(quantity == REHEARSE_TWIST ? found->v() : found->dv(), numbers);
      rehearse::put(quantity == REHEARSE_TWIST ? found->w() : found->dw(), numbers + 3);
    }
    return int{REHEARSE_OK};
  });
}

int rehearse_set_numbers(rehearse_io* io, int link, int quantity, const double* numbers, int size) {
  return guarded(io, [&] {
    Link* found = rehearse::link_for_numbers(*io, link, quantity, numbers, size);
    if (!found) return int{REHEARSE_BAD_ARGUMENT};
    if (quantity == REHEARSE_ACCELERATION)
      return fail(*io, REHEARSE_BAD_ARGUMENT, "an acceleration can't be commanded");
    if (quantity == REHEARSE_POSE) {
      const Eigen::Quaterniond rotation(numbers[6], numbers[3], numbers[4], numbers[5]);
      if (!(rotation.norm() > 1e-6)) return fail(*io, REHEARSE_BAD_ARGUMENT, "the quaternion is zero, or no number");
      found->T().translation() = rehearse::vector(numbers);
      found->T().linear() = rotation.normalized().toRotationMatrix();
    } else if (quantity == REHEARSE_TWIST) {
      found->v() = rehearse::vector(numbers);
      found->w() = rehearse::vector(numbers + 3);
    } else {
      std::copy(numbers, numbers + 6, found->F_ext().data());
    }
    return int{REHEARSE_OK};
  });
}

int rehearse_limits(rehearse_io* io, int joint, int quantity, double* lower, double* upper) {
  return guarded(io, [&] {
    const Link* found = rehearse::joint_of(*io, joint);
    if (!found || !lower || !upper)
      return found ? fail(*io, REHEARSE_BAD_ARGUMENT, "the place for a limit is null") : int{REHEARSE_BAD_ARGUMENT};
    constexpr double infinite = std::numeric_limits<double>::infinity();
    const auto give = [&](bool is_limited, double low, double high) {
      *lower = is_limited ? low : -infinite;
      *upper = is_limited ? high : infinite;
      return int{REHEARSE_OK};
    };
    switch (quantity) {
      case REHEARSE_Q: return give(found->hasJointDisplacementLimits(), found->q_lower(), found->q_upper());
      case REHEARSE_DQ: return give(found->hasJointVelocityLimits(), found->dq_lower(), found->dq_upper());
      case REHEARSE_U: return give(found->hasJointEffortLimits(), found->u_lower(), found->u_upper());
      default: break;
    }
    return fail(*io, REHEARSE_BAD_ARGUMENT, "the quantity " + std::to_string(quantity) + " has no limits");
  });
}

int rehearse_device_count(const rehearse_io* io) {
  return guarded(io, [&] { return io->io->body()->numDevices(); });
}

int rehearse_device(rehearse_io* io, const char* name) {
  return guarded(io, [&] {
    if (!name) return fail(*io, REHEARSE_BAD_ARGUMENT, "the name is null");
    cnoid::Body& body = *io->io->body();
    return rehearse::handle_of(*io, "device", name, body.findDevice<Device>(name), [&](auto add) {
      for (int i = 0; i < body.numDevices(); ++i) add(body.device(i)->name());
    });
  });
}

const char* rehearse_device_name(rehearse_io* io, int device) {
  const Device* found = io ? rehearse::device_of(*io, device) : nullptr;
  return found ? found->name().c_str() : nullptr;
}

const char* rehearse_device_type(rehearse_io* io, int device) {
  const Device* found = io ? rehearse::device_of(*io, device) : nullptr;
  return found ? found->typeName() : nullptr;
}

int rehearse_read_device(rehearse_io* io, int device) {
  return guarded(io, [&] {
    if (!io->initializing) return fail(*io, REHEARSE_TOO_LATE, "inputs and outputs are fixed after initialize()");
    Device* found = rehearse::device_of(*io, device);
    if (!found) return int{REHEARSE_BAD_ARGUMENT};
    io->io->enableInput(found);
    return int{REHEARSE_OK};
  });
}

int rehearse_device_numbers(rehearse_io* io, int device, double* numbers, int size) {
  return guarded(io, [&] {
    const Device* found = rehearse::device_of(*io, device);
    if (!found) return int{REHEARSE_BAD_ARGUMENT};
    if (size < 0 || (size > 0 && !numbers))
      return fail(*io, REHEARSE_BAD_ARGUMENT, "the place for the numbers is null, or its size is negative");
    if (const auto* range = dynamic_cast<const cnoid::RangeSensor*>(found)) {
      const auto& distances = range->constRangeData();
      std::copy_n(distances.begin(), std::min<std::size_t>(distances.size(), static_cast<std::size_t>(size)), numbers);
      return static_cast<int>(distances.size());
    }
    const int count = found->stateSize();
    if (size >= count) {
      found->writeState(numbers);
    } else {
      std::vector<double> state(static_cast<std::size_t>(count));
      found->writeState(state.data());
      std::copy_n(state.begin(), size, numbers);
    }
    return count;
  });
}

int rehearse_set_device_numbers(rehearse_io* io, int device, const double* numbers, int size) {
  return guarded(io, [&] {
    Device* found = rehearse::device_of(*io, device);
    if (!found) return int{REHEARSE_BAD_ARGUMENT};
    if (dynamic_cast<const cnoid::RangeSensor*>(found))
      return fail(*io, REHEARSE_BAD_ARGUMENT, "the numbers of a range sensor are measured, and can't be set");
    if (size != found->stateSize() || !numbers)
      return fail(*io, REHEARSE_BAD_ARGUMENT,
                  "device '" + found->name() + "' has " + std::to_string(found->stateSize()) + " numbers, not " +
                      std::to_string(size));
    found->readState(numbers, size);
    found->notifyStateChange();
    return int{REHEARSE_OK};
  });
}

const unsigned char* rehearse_image(rehearse_io* io, int device, int shape[3]) {
  const auto* camera = io && shape ? rehearse::device_as<cnoid::Camera>(*io, device, "camera") : nullptr;
  if (!camera || camera->constImage().empty()) return nullptr;
  const cnoid::Image& image = camera->constImage();
  shape[0] = image.height();
  shape[1] = image.width();
  shape[2] = image.numComponents();
  return image.pixels();
}

const float* rehearse_points(rehearse_io* io, int device, int shape[3]) {
  const auto* camera = io && shape ? rehearse::device_as<cnoid::RangeCamera>(*io, device, "range camera") : nullptr;
  if (!camera || camera->numPoints() == 0) return nullptr;
  const bool is_grid = camera->isOrganized();
  shape[0] = is_grid ? camera->resolutionY() : 1;
  shape[1] = is_grid ? camera->resolutionX() : camera->numPoints();
  shape[2] = 3;
  return camera->constPoints().front().data();
}
