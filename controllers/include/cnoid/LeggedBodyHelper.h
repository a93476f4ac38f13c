// LeggedBodyHelper: the feet of a body, as its model file describes them, and postures of its legs.
//
// Feet are the entries of `foot_links` (footLinks) in Body::info(): link, sole_center [m, in the link's frame], and
// optionally home_cop (default: sole_center), toe_offset, knee_pitch_joint. The functions that move links work on the
// helper's body, which must outlive it.
#pragma once

#include "Body.h"
#include "InverseKinematics.h"
#include "ZmpDevice.h"

#include <memory>
#include <string>
#include <vector>

namespace cnoid {

class CNOID_GENERAL_EXPORT LeggedBodyHelper : public Referenced {
 public:
  LeggedBodyHelper() = default;
  explicit LeggedBodyHelper(Body* body) { resetBody(body); }
  LeggedBodyHelper(const LeggedBodyHelper& other);
  LeggedBodyHelper& operator=(const LeggedBodyHelper&) = delete;
  ~LeggedBodyHelper() override;

  /// False, and no feet, if the body's information has none. Throws a ValueNode::Exception if an entry can't be read,
  /// and std::invalid_argument if it names a link that the body doesn't have.
  virtual bool resetBody(Body* body);
  bool isValid() const { return !feet_.empty(); }
  Body* body() const { return body_; }

  enum FootID { Left = 0, Right = 1 };
  int numFeet() const { return static_cast<int>(feet_.size()); }
  /// Numbers of feet are 0 to numFeet() - 1; others throw std::out_of_range.
  Link* footLink(int foot) const { return info(foot).link; }
  /// Null if the model doesn't name it.
  Link* kneePitchJoint(int foot) const { return info(foot).kneePitchJoint; }
  const Vector3& centerOfSoleLocal(int foot) const { return info(foot).soleCenter; }
  const Vector3& homeCopOfSoleLocal(int foot) const { return info(foot).homeCop; }
  const Isometry3& toeOffset(int foot) const { return info(foot).toeOffset; }
  /// In the world [m].
  Vector3 centerOfSole(int foot) const { return footLink(foot)->T() * centerOfSoleLocal(foot); }
  Vector3 homeCopOfSole(int foot) const { return footLink(foot)->T() * homeCopOfSoleLocal(foot); }
  /// The mean of all feet. Throws std::logic_error if there are none.
  Vector3 centerOfSoles() const;
  Vector3 homeCopOfSoles() const;

  /// A CompositeIK that moves the link while the feet stay; null if a foot has no path to it.
  std::shared_ptr<InverseKinematics> getFootBasedIK(Link* targetLink);

  /// Moves the root link, with its orientation, so that the centre of mass is at `c` within 1e-6 m (in the horizontal
  /// plane only, if `onlyProjectionToFloor`), while all feet stay. False if a leg can't reach; body() is as before
  /// then.
  bool doLegIkToMoveCm(const Vector3& c, bool onlyProjectionToFloor = false);

  /// Moves one foot beside the other, on the side where it is: `width` [m] along the other's y axis in the horizontal
  /// plane; and the root link above their middle, at its height. `baseLink`: the foot that stays; if it is no foot, the
  /// first one stays. False if the body doesn't have two feet, or if a leg can't reach; body() is as before then.
  bool setStance(double width, Link* baseLink);

  /// A ZmpDevice of the body; null if there are no feet.
  ZmpDevice* getOrCreateZmpDevice();
  /// That of the device, in the world [m]; zero without a device.
  Vector3 zmp() const;
  void setZmp(const Vector3& zmp, bool doNotify = false);

 private:
  struct Foot {
    EIGEN_MAKE_ALIGNED_OPERATOR_NEW
    LinkPtr link;
    LinkPtr kneePitchJoint;
    Vector3 homeCop;
    Vector3 soleCenter;
    Isometry3 toeOffset;
  };

  const Foot& info(int foot) const { return feet_.at(static_cast<std::size_t>(foot)); }
  using Poses = std::vector<Isometry3, Eigen::aligned_allocator<Isometry3>>;
  Link* linkOf(const std::string& name) const;
  Poses poses() const;
  /// False if a leg can't reach; links and joints are then in between.
  bool moveTo(const Isometry3& root, const Poses& feet);

  Body* body_ = nullptr;  // no owner: the body may own the helper
  std::vector<Foot, Eigen::aligned_allocator<Foot>> feet_;
  ZmpDevicePtr zmpDevice_;
};

using LeggedBodyHelperPtr = ref_ptr<LeggedBodyHelper>;

/// The helper of a body, made at the first call and kept in the body's cache.
CNOID_GENERAL_EXPORT LeggedBodyHelper* getLeggedBodyHelper(Body* body);

}  // namespace cnoid
