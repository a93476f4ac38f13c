// Body: a robot or object as a tree of links, with its joints and devices.
//
// The body that a controller gets is a separate copy: reading it shows only quantities that were enabled as input, and
// writing to it changes the simulation only through enabled outputs. Links, joints and devices live as long as the
// body.
#pragma once

#include "ClonableReferenced.h"
#include "DeviceList.h"
#include "ExtraJoint.h"
#include "LinkTraverse.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace cnoid {

class Body;
using BodyPtr = ref_ptr<Body>;

class CNOID_GENERAL_EXPORT Body : public ClonableReferenced {
 public:
  /// Creates a body of one free link without a name.
  Body();
  explicit Body(const std::string& name);
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;
  ~Body() override;

  /// A deep copy with state and devices; the caller becomes its first owner. Caches and images are not copied (see
  /// Camera).
  Body* clone() const { return static_cast<Body*>(doClone(nullptr)); }
  /// Makes this body such a copy of the other one. What it had before is lost, except its caches.
  void copyFrom(const Body* other);

  /// In a scenario: the body's name there. modelName() is the name in the model file.
  const std::string& name() const { return name_; }
  const std::string& modelName() const { return modelName_; }

  // --- Links: depth first, children of a link in order; link 0 is the root

  int numLinks() const { return linkTraverse_.numLinks(); }
  /// Null if the index is out of range.
  Link* link(int index) const;
  /// Null if there is no link of that name. Of several links of that name: the last.
  Link* link(const std::string& name) const;
  const std::vector<LinkPtr>& links() const { return linkTraverse_.links(); }
  const LinkTraverse& linkTraverse() const { return linkTraverse_; }
  Link* rootLink() const { return rootLink_; }
  /// The end of a body whose links have one child each; null if a link has several, or the root has none.
  Link* findUniqueEndLink() const;
  /// The last link before the first that has several children.
  Link* lastSerialLink() const;

  // --- Joints: by joint id

  /// The largest joint id plus one.
  int numJoints() const { return numIdentifiedJoints_; }
  /// Null if the number is out of range (Choreonoid does not check). If no link has that id: a dummy, a fixed link with
  /// index -1 that belongs to no body; it can't be enabled on an IO object.
  Link* joint(int id) const;
  /// Finds a link by the name of its joint, then by its own name; null if there is neither.
  Link* joint(const std::string& name) const;

  class JointRange {
   public:
    using iterator = std::vector<LinkPtr>::iterator;
    JointRange(iterator begin, iterator end) : begin_(begin), end_(end) {}
    iterator begin() const { return begin_; }
    iterator end() const { return end_; }

   private:
    iterator begin_;
    iterator end_;
  };
  /// joint(0) to joint(numJoints() - 1), for a range-based for.
  JointRange joints() { return JointRange(joints_.begin(), joints_.begin() + numIdentifiedJoints_); }

  /// Moving links without a joint id follow those with one.
  const std::vector<LinkPtr>& allJoints() const { return joints_; }
  int numAllJoints() const { return static_cast<int>(joints_.size()); }
  int numVirtualJoints() const { return numAllJoints() - numIdentifiedJoints_; }

  // --- Joints that close loops

  int numExtraJoints() const { return static_cast<int>(extraJoints_.size()); }
  /// Null: bodies that are attached to others in Choreonoid are connected by a joint of the scenario here.
  Body* parentBody() const { return nullptr; }
  Link* parentBodyLink() const { return nullptr; }
  /// Null if the index is out of range.
  ExtraJoint* extraJoint(int index) const;
  void addExtraJoint(ExtraJoint* joint) { extraJoints_.push_back(joint); }
  void clearExtraJoints() { extraJoints_.clear(); }

  // --- Devices: in the order of the model, those of a link before those of the next

  int numDevices() const { return static_cast<int>(devices_.size()); }
  /// Null if the index is out of range.
  Device* device(int index) const;
  const DeviceList<>& devices() const { return devices_; }
  template <class DeviceType>
  DeviceList<DeviceType> devices() const {
    return devices_;
  }

  /// Null if there is no device of that name. Of several devices of that name: the last.
  Device* findDevice(const std::string& name) const;
  /// Also null if the device of that name has a different type.
  template <class DeviceType>
  DeviceType* findDevice(const std::string& name) const {
    return dynamic_cast<DeviceType*>(findDevice(name));
  }
  /// The first device of the type; with a predicate, the first one for which it returns true.
  template <class DeviceType>
  DeviceType* findDevice(std::function<bool(DeviceType* device)> accepts = nullptr) const {
    for (const auto& device : devices_) {
      auto* matching = dynamic_cast<DeviceType*>(device.get());
      if (matching && (!accepts || accepts(matching))) return matching;
    }
    return nullptr;
  }
  template <class DeviceType>
  DeviceList<DeviceType> findDevices(std::function<bool(DeviceType* device)> accepts = nullptr) const {
    DeviceList<DeviceType> found;
    for (const auto& device : devices<DeviceType>()) {
      if (!accepts || accepts(device)) found.push_back(device);
    }
    return found;
  }

  // --- The whole body

  /// True if the root link is fixed to the world.
  bool isFixedRootModel() const { return rootLink_->isFixedJoint(); }
  /// True if no link of the body can move.
  bool isStaticModel() const;
  bool hasMovableJoints() const;

  double mass() const;  // [kg]
  /// Centre of mass in the world [m], from the links' T(). Updates Link::wc().
  const Vector3& calcCenterOfMass();
  /// The result of the last calcCenterOfMass().
  const Vector3& centerOfMass() const { return centerOfMass_; }
  /// Momentum [kg·m/s] and angular momentum about the world's origin [kg·m²/s], from the links' T(), v(), w(), and
  /// wc(): call calcCenterOfMass() first.
  void calcTotalMomentum(Vector3& P, Vector3& L);

  /// Computes poses (and velocities, accelerations) of all links from the root's and the joints' q (dq, ddq).
  void calcForwardKinematics(bool calcVelocity = false, bool calcAcceleration = false) {
    linkTraverse_.calcForwardKinematics(calcVelocity, calcAcceleration);
  }

  /// The root link's pose in the model.
  const Isometry3& defaultPosition() const { return rootLink_->Tb(); }
  void resetDefaultPosition(const Isometry3& pose) { rootLink_->setOffsetPosition(pose); }
  /// Puts the root at defaultPosition() and the joints at q_initial(), then does the same as initializeState().
  void initializePosition();
  /// Sets all links to rest at their current poses (Link::initializeState), computes forward kinematics, clears
  /// devices.
  void initializeState();
  void initializeDeviceStates();
  void clearExternalForces();

  /// Simulated time [s].
  double currentTime() const { return currentTimeFunction_ ? currentTimeFunction_() : 0.0; }
  void setCurrentTimeFunction(std::function<double()> function) { currentTimeFunction_ = std::move(function); }

  // --- Additional information in the model

  /// Never null.
  Mapping* info() { return info_; }
  const Mapping* info() const { return info_; }
  /// Throws ValueNode::KeyNotFoundException if there is no value of that key and type.
  template <typename T>
  T info(const std::string& key) const {
    return info_->get<T>(key);
  }
  template <typename T>
  T info(const std::string& key, const T& defaultValue) const {
    return info_->get(key, defaultValue);
  }
  template <typename T>
  void setInfo(const std::string& key, const T& value) {
    info_->write(key, value);
  }
  void resetInfo(Mapping* newInfo) { info_ = newInfo; }

  // --- Objects stored with the body under a name; also used for the IO object's shared objects

  template <class T>
  T* findCache(const std::string& name) {
    return dynamic_cast<T*>(findCacheEntry(name));
  }
  template <class T>
  const T* findCache(const std::string& name) const {
    return dynamic_cast<const T*>(findCacheEntry(name));
  }
  /// Makes a new T if there is no object of that name, or one of a different type.
  template <class T>
  T* getOrCreateCache(const std::string& name) {
    if (T* existing = findCache<T>(name)) return existing;
    T* created = new T();
    setCache(name, created);
    return created;
  }
  void setCache(const std::string& name, Referenced* object);
  void removeCache(const std::string& name);

  // --- For building a body

  /// A new link that belongs to no body: a copy of `original`, without its children, if it isn't null.
  Link* createLink(const Link* original = nullptr) const { return original ? original->clone() : new Link; }
  void setName(const std::string& name) { name_ = name; }
  void setModelName(const std::string& name) { modelName_ = name; }
  /// Replaces the whole tree.
  void setRootLink(Link* link);
  void setRootLinkFixed(bool on) { rootLink_->setJointType(on ? Link::FixedJoint : Link::FreeJoint); }
  /// Numbers links and joints anew. To be called after a change of the tree, or of a link's name or joint id.
  void updateLinkTree();

  /// False if the link belongs to a different body. Sets the index of the device.
  bool addDevice(Device* device, Link* link);
  /// False if the device doesn't belong to this body.
  bool removeDevice(Device* device);
  void removeDevicesOfLink(Link* link);
  void clearDevices();
  void sortDevicesByLinkOrder();

 protected:
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  void nameLinks();
  void collectJoints();
  void numberDevices();
  Referenced* findCacheEntry(const std::string& name) const;

  std::string name_;
  std::string modelName_;
  LinkPtr rootLink_;
  LinkTraverse linkTraverse_;
  std::vector<LinkPtr> joints_;  // by joint id, then joints without an id
  int numIdentifiedJoints_ = 0;
  std::map<std::string, Link*> linksByName_;
  std::map<std::string, Link*> linksByJointName_;
  DeviceList<> devices_;
  std::vector<ExtraJointPtr> extraJoints_;
  MappingPtr info_;
  std::map<std::string, ReferencedPtr> caches_;
  Vector3 centerOfMass_;
  std::function<double()> currentTimeFunction_;
};

}  // namespace cnoid
