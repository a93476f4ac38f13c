// BodyState: poses of links, displacements of joints and states of devices, independent of a body.
#pragma once

#include "Config.h"
#include "Device.h"
#include "EigenTypes.h"

#include <cstddef>
#include <vector>

namespace cnoid {

class Body;

class CNOID_GENERAL_EXPORT BodyState {
 public:
  /// A view of one link's pose: x, y, z, then the quaternion's x, y, z, w.
  class LinkPosition {
   public:
    static constexpr int size = 7;
    explicit LinkPosition(double* data) : data_(data) {}
    LinkPosition(const LinkPosition&) = default;
    LinkPosition& operator=(const LinkPosition&) = delete;  // ambiguous: the view or the pose? Use set(other.T()).

    Eigen::Map<Vector3> translation() const { return Eigen::Map<Vector3>(data_); }
    Eigen::Map<Quaternion> rotation() const { return Eigen::Map<Quaternion>(data_ + 3); }
    Isometry3 position() const {
      Isometry3 T = Isometry3::Identity();
      T.translation() = translation();
      T.linear() = rotation().toRotationMatrix();
      return T;
    }
    Isometry3 T() const { return position(); }
    void set(const Vector3& p, const Quaternion& q) {
      translation() = p;
      rotation() = q;
    }
    void set(const SE3& pose) { set(pose.translation(), pose.rotation()); }
    void set(const Isometry3& T) { set(T.translation(), Quaternion(T.linear())); }
    void get(Isometry3& out_T) const { out_T = position(); }
    void get(SE3& out_pose) const { out_pose.set(translation(), Quaternion(rotation())); }

   private:
    double* data_;
  };

  BodyState() = default;
  explicit BodyState(const Body* body) { storeStateOfBody(body); }

  /// All links at the origin, all joints at zero, no states of devices.
  BodyState& allocate(int numLinks, int numJoints = 0, int numDevices = 0);
  void clear() { allocate(0); }
  bool empty() const { return linkPositions_.empty() && jointDisplacements_.empty() && deviceStates_.empty(); }

  int numLinkPositions() const { return static_cast<int>(linkPositions_.size()) / LinkPosition::size; }
  bool hasLinkPositions() const { return numLinkPositions() > 0; }
  int numJointDisplacements() const { return static_cast<int>(jointDisplacements_.size()); }
  bool hasJointDisplacements() const { return numJointDisplacements() > 0; }
  int numDeviceStates() const { return static_cast<int>(deviceStates_.size()); }
  bool hasDeviceStates() const { return numDeviceStates() > 0; }

  /// Indices are those of Body::link, Body::allJoints, Body::device. They are not checked.
  LinkPosition linkPosition(int index) const {
    return LinkPosition(const_cast<double*>(linkPositions_.data()) + static_cast<std::ptrdiff_t>(index) * 7);
  }
  LinkPosition rootLinkPosition() const { return linkPosition(0); }
  double& jointDisplacement(int index) { return jointDisplacements_[static_cast<std::size_t>(index)]; }
  double jointDisplacement(int index) const { return jointDisplacements_[static_cast<std::size_t>(index)]; }
  double* jointDisplacements() { return jointDisplacements_.data(); }
  const double* jointDisplacements() const { return jointDisplacements_.data(); }
  DeviceState* deviceState(int index) const { return deviceStates_[static_cast<std::size_t>(index)]; }
  void setDeviceState(int index, DeviceState* state) { deviceStates_[static_cast<std::size_t>(index)] = state; }

  /// Copies the state of all links and joints of a body, and the states of its devices.
  void storeStateOfBody(const Body* body) { store(*body, true); }
  void storePositionOfBody(const Body* body) { store(*body, false); }
  /// Copies this state to the body: joints, the root's pose, forward kinematics, poses of other links, then devices,
  /// which are notified. False if the state contains neither a joint nor a link.
  bool restoreStateToBody(Body* body) const { return restore(*body, true); }
  bool restorePositionToBody(Body* body) const { return restore(*body, false); }

 private:
  void store(const Body& body, bool withDevices);
  bool restore(Body& body, bool withDevices) const;

  std::vector<double> linkPositions_;
  std::vector<double> jointDisplacements_;
  std::vector<DeviceStatePtr> deviceStates_;
};

CNOID_GENERAL_EXPORT BodyState& operator<<(BodyState& state, const Body& body);
CNOID_GENERAL_EXPORT const BodyState& operator>>(const BodyState& state, Body& body);
CNOID_GENERAL_EXPORT Body& operator<<(Body& body, const BodyState& state);
CNOID_GENERAL_EXPORT const Body& operator>>(const Body& body, BodyState& state);

}  // namespace cnoid
