// ExtraJoint: a joint between two links that the tree connects already. It closes a loop.
#pragma once

#include "ClonableReferenced.h"
#include "Link.h"
#include "ValueTree.h"

#include <array>
#include <string>

namespace cnoid {

class CNOID_GENERAL_EXPORT ExtraJoint : public ClonableReferenced {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  enum ExtraJointType {
    Fixed,
    Hinge,
    Ball,
    Piston,
    EJ_BALL [[deprecated("Use Ball.")]] = Ball,
    EJ_PISTON [[deprecated("Use Piston.")]] = Piston
  };

  ExtraJoint() : ExtraJoint(Hinge) {}
  explicit ExtraJoint(ExtraJointType type) : ExtraJoint(type, Vector3::UnitX()) {}
  ExtraJoint(ExtraJointType type, const Vector3& axis);
  ExtraJoint& operator=(const ExtraJoint&) = delete;
  ~ExtraJoint() override;

  /// A copy between the same links.
  ExtraJoint* clone() const { return static_cast<ExtraJoint*>(doClone(nullptr)); }

  ExtraJointType type() const { return type_; }
  void setType(ExtraJointType type) { type_ = type; }

  /// `which` is 0 or 1; others throw std::out_of_range.
  Link* link(int which) const { return end(which).link; }
  void setLink(int which, Link* link) { end(which).link = link; }
  /// Empty without a link.
  std::string linkName(int which) const { return link(which) ? link(which)->name() : std::string(); }
  std::string bodyName(int which) const;
  bool isForLinksOfSameBody() const { return link(0) && link(1) && link(0)->body() == link(1)->body(); }

  /// The joint's frame in the link's frame.
  const Isometry3& localPosition(int which) const { return end(which).T; }
  Isometry3::ConstLinearPart localRotation(int which) const { return localPosition(which).linear(); }
  Isometry3::ConstTranslationPart localTranslation(int which) const { return localPosition(which).translation(); }
  Isometry3::ConstTranslationPart point(int which) const { return localTranslation(which); }
  void setLocalPosition(int which, const Isometry3& T) { end(which).T = T; }
  void setLocalRotation(int which, const Matrix3& R) { end(which).T.linear() = R; }
  void setLocalTranslation(int which, const Vector3& p) { end(which).T.translation() = p; }
  void setPoint(int which, const Vector3& p) { setLocalTranslation(which, p); }

  /// Unit vector in the joint's frame; of a hinge and a piston.
  const Vector3& axis() const { return axis_; }
  void setAxis(const Vector3& axis) { axis_ = axis.normalized(); }

  /// Never null.
  Mapping* info() { return info_; }
  const Mapping* info() const { return info_; }
  void resetInfo(Mapping* info) { info_ = info; }

 protected:
  ExtraJoint(const ExtraJoint& other);
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  struct End {
    EIGEN_MAKE_ALIGNED_OPERATOR_NEW
    LinkPtr link;
    Isometry3 T = Isometry3::Identity();
  };
  End& end(int which) { return ends_.at(static_cast<std::size_t>(which)); }
  const End& end(int which) const { return ends_.at(static_cast<std::size_t>(which)); }

  ExtraJointType type_;
  std::array<End, 2> ends_;
  Vector3 axis_;
  MappingPtr info_;
};

using ExtraJointPtr = ref_ptr<ExtraJoint>;

}  // namespace cnoid
