#include <cnoid/Body>

#include <algorithm>

namespace cnoid {

namespace {

Link* cloneTree(const Link* original) {
  Link* link = original->clone();
  for (const Link* child = original->child(); child; child = child->sibling()) link->appendChild(cloneTree(child));
  return link;
}

/// Value under the key, or null.
Link* find(const std::map<std::string, Link*>& links, const std::string& name) {
  const auto entry = links.find(name);
  return entry == links.end() ? nullptr : entry->second;
}

}  // namespace

Body::Body() : info_(new Mapping), centerOfMass_(Vector3::Zero()) {
  auto* root = new Link;
  root->setJointType(Link::FreeJoint);
  setRootLink(root);
}

Body::Body(const std::string& name) : Body() { name_ = name; }

Body::~Body() {
  clearDevices();
  rootLink_->setBodyToSubTree(nullptr);
}

Referenced* Body::doClone(CloneMap*) const {
  auto* body = new Body;
  body->copyFrom(this);
  return body;
}

void Body::copyFrom(const Body* other) {
  if (other == this) return;
  name_ = other->name_;
  modelName_ = other->modelName_;
  centerOfMass_ = other->centerOfMass_;
  currentTimeFunction_ = other->currentTimeFunction_;
  info_ = other->info_->deepClone();
  setRootLink(cloneTree(other->rootLink_));
  for (const auto& device : other->devices_) addDevice(device->clone(), link(device->link()->index()));
  for (const auto& joint : other->extraJoints_) {
    const ExtraJointPtr copy = joint->clone();
    for (int end = 0; end < 2; ++end) {
      const Link* original = joint->link(end);
      if (original && original->body() == other) copy->setLink(end, link(original->index()));
    }
    extraJoints_.push_back(copy);
  }
}

Link* Body::link(int index) const { return index >= 0 && index < numLinks() ? linkTraverse_.link(index) : nullptr; }

Link* Body::link(const std::string& name) const { return find(linksByName_, name); }

Link* Body::joint(int id) const {
  return id >= 0 && id < numAllJoints() ? joints_[static_cast<std::size_t>(id)].get() : nullptr;
}

Link* Body::joint(const std::string& name) const {
  Link* byJointName = find(linksByJointName_, name);
  return byJointName ? byJointName : link(name);
}

Link* Body::lastSerialLink() const {
  Link* link = rootLink_;
  while (link->child() && !link->child()->sibling()) link = link->child();
  return link;
}

Link* Body::findUniqueEndLink() const {
  Link* link = lastSerialLink();
  return link->child() || link->isRoot() ? nullptr : link;
}

ExtraJoint* Body::extraJoint(int index) const {
  return index >= 0 && index < numExtraJoints() ? extraJoints_[static_cast<std::size_t>(index)].get() : nullptr;
}

Device* Body::device(int index) const {
  return index >= 0 && index < numDevices() ? devices_[static_cast<std::size_t>(index)].get() : nullptr;
}

Device* Body::findDevice(const std::string& name) const {
  const auto found = std::find_if(devices_.rbegin(), devices_.rend(),
                                  [&name](const DevicePtr& device) { return device->name() == name; });
  return found == devices_.rend() || name.empty() ? nullptr : found->get();
}

void Body::setRootLink(Link* link) {
  const LinkPtr holder(link);
  if (rootLink_) rootLink_->setBodyToSubTree(nullptr);
  clearDevices();
  clearExtraJoints();
  rootLink_ = link;
  rootLink_->setBodyToSubTree(this);
  updateLinkTree();
}

void Body::updateLinkTree() {
  linkTraverse_.find(rootLink_);
  nameLinks();
  collectJoints();
}

void Body::nameLinks() {
  linksByName_.clear();
  linksByJointName_.clear();
  int index = 0;
  for (const auto& link : links()) {
    link->index_ = index++;
    if (!link->name().empty()) linksByName_[link->name()] = link;
    if (!link->jointSpecificName().empty()) linksByJointName_[link->jointSpecificName()] = link;
  }
}

void Body::collectJoints() {
  joints_.clear();
  std::vector<LinkPtr> unidentified;
  for (const auto& link : links()) {
    if (link->jointId() >= 0) {
      const auto id = static_cast<std::size_t>(link->jointId());
      if (id >= joints_.size()) joints_.resize(id + 1);
      if (!joints_[id]) joints_[id] = link;
    } else if (!link->isRoot() && link->jointType() != Link::FixedJoint) {
      unidentified.push_back(link);
    }
  }
  numIdentifiedJoints_ = numAllJoints();
  for (int id = 0; id < numIdentifiedJoints_; ++id) {
    LinkPtr& joint = joints_[static_cast<std::size_t>(id)];
    if (joint) continue;
    joint = new Link;
    joint->setJointId(id);
  }
  joints_.insert(joints_.end(), unidentified.begin(), unidentified.end());
}

bool Body::addDevice(Device* device, Link* link) {
  const DevicePtr holder(device);
  if (!link || link->body() != this) return false;
  if (std::find(devices_.begin(), devices_.end(), holder) != devices_.end()) return true;
  device->setLink(link);
  device->setIndex(numDevices());
  devices_.push_back(device);
  return true;
}

bool Body::removeDevice(Device* device) {
  const auto place = std::find(devices_.begin(), devices_.end(), DevicePtr(device));
  if (place == devices_.end()) return false;
  device->setLink(nullptr);
  device->setIndex(-1);
  devices_.erase(place);
  numberDevices();
  return true;
}

void Body::removeDevicesOfLink(Link* link) {
  const DeviceList<> all = devices_;
  for (const auto& device : all) {
    if (device->link() == link) removeDevice(device);
  }
}

void Body::clearDevices() {
  for (const auto& device : devices_) {
    device->setLink(nullptr);
    device->setIndex(-1);
  }
  devices_.clear();
}

void Body::sortDevicesByLinkOrder() {
  std::stable_sort(devices_.begin(), devices_.end(),
                   [](const DevicePtr& a, const DevicePtr& b) { return a->link()->index() < b->link()->index(); });
  numberDevices();
}

void Body::numberDevices() {
  int index = 0;
  for (const auto& device : devices_) device->setIndex(index++);
}

bool Body::hasMovableJoints() const {
  return std::any_of(links().begin() + 1, links().end(), [](const LinkPtr& link) { return !link->isFixedJoint(); });
}

bool Body::isStaticModel() const { return isFixedRootModel() && !hasMovableJoints(); }

double Body::mass() const {
  double mass = 0.0;
  for (const auto& link : links()) mass += link->mass();
  return mass;
}

const Vector3& Body::calcCenterOfMass() {
  Vector3 firstMoment = Vector3::Zero();
  for (const auto& link : links()) {
    link->wc() = link->T() * link->c();
    firstMoment += link->m() * link->wc();
  }
  centerOfMass_ = firstMoment / mass();
  return centerOfMass_;
}

void Body::calcTotalMomentum(Vector3& P, Vector3& L) {
  P.setZero();
  L.setZero();
  for (const auto& link : links()) {
    const Vector3 momentum = link->m() * (link->v() + link->w().cross(link->R() * link->c()));
    const Matrix3 inertia = link->R() * link->I() * link->R().transpose();
    P += momentum;
    L += link->wc().cross(momentum) + inertia * link->w();
  }
}

void Body::initializePosition() {
  rootLink_->T() = rootLink_->Tb();
  for (const auto& link : links()) link->q() = link->q_initial();
  initializeState();
}

void Body::initializeState() {
  for (const auto& link : links()) link->initializeState();
  calcForwardKinematics(true, true);
  initializeDeviceStates();
}

void Body::initializeDeviceStates() {
  for (const auto& device : devices_) device->clearState();
}

void Body::clearExternalForces() {
  for (const auto& link : links()) link->F_ext().setZero();
}

void Body::setCache(const std::string& name, Referenced* object) { caches_[name] = object; }

void Body::removeCache(const std::string& name) { caches_.erase(name); }

Referenced* Body::findCacheEntry(const std::string& name) const {
  const auto entry = caches_.find(name);
  return entry == caches_.end() ? nullptr : entry->second.get();
}

}  // namespace cnoid
