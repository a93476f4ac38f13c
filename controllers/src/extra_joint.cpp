#include <cnoid/Body>
#include <cnoid/ExtraJoint>

namespace cnoid {

ExtraJoint::ExtraJoint(ExtraJointType type, const Vector3& axis)
    : type_(type), axis_(axis.normalized()), info_(new Mapping) {}

ExtraJoint::ExtraJoint(const ExtraJoint& other)
    : ClonableReferenced(other),
      type_(other.type_),
      ends_(other.ends_),
      axis_(other.axis_),
      info_(other.info_->deepClone()) {}

ExtraJoint::~ExtraJoint() = default;

Referenced* ExtraJoint::doClone(CloneMap*) const { return new ExtraJoint(*this); }

std::string ExtraJoint::bodyName(int which) const {
  const Body* body = link(which) ? link(which)->body() : nullptr;
  return body ? body->name() : std::string();
}

}  // namespace cnoid
