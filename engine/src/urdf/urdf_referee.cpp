#include "urdf_draft.h"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <tinyxml2.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

namespace rehearse::urdf {
namespace {

/// During its lifetime urdfdom's messages are collected here and printed nowhere. console_bridge has one handler per
/// process, hence the lock.
class CapturedConsole : private console_bridge::OutputHandler {
 public:
  CapturedConsole() : lock_(mutex()), level_(console_bridge::getLogLevel()) {
    console_bridge::useOutputHandler(this);
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
  }
  ~CapturedConsole() override {
    console_bridge::setLogLevel(level_);
    console_bridge::restorePreviousOutputHandler();
  }
  CapturedConsole(const CapturedConsole&) = delete;
  CapturedConsole& operator=(const CapturedConsole&) = delete;

  const std::vector<std::string>& messages() const { return messages_; }

 private:
  void log(const std::string& text, console_bridge::LogLevel, const char*, int) override { messages_.push_back(text); }

  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }

  std::lock_guard<std::mutex> lock_;
  console_bridge::LogLevel level_;
  std::vector<std::string> messages_;
};

/// Parses the document with urdfdom; null, with errors, if urdfdom refuses it.
::urdf::ModelInterfaceSharedPtr parse(const tinyxml2::XMLDocument& document, Findings& findings) {
  tinyxml2::XMLPrinter printer(nullptr, true);
  document.Print(&printer);
  CapturedConsole console;
  ::urdf::ModelInterfaceSharedPtr robot;
  try {
    robot = ::urdf::parseURDF(printer.CStr());
  } catch (const std::exception& problem) {
    findings.error(0, fmt::format("urdfdom fails: {}", printable(problem.what())));
    return nullptr;
  }
  for (const std::string& message : console.messages()) findings.error(0, "urdfdom reports: " + printable(message));
  if (robot == nullptr && console.messages().empty()) findings.error(0, "urdfdom refuses the file without a reason");
  return console.messages().empty() ? robot : nullptr;
}

bool same(const Eigen::Isometry3d& ours, const ::urdf::Pose& theirs) {
  constexpr double rounding = 1e-12;
  const auto& [p, q] = std::tie(theirs.position, theirs.rotation);
  const Eigen::Matrix3d rotation = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
  return ours.translation() == Eigen::Vector3d(p.x, p.y, p.z) &&
         (ours.linear() - rotation).cwiseAbs().maxCoeff() < rounding;
}

bool same(const Geometry& ours, const ::urdf::Geometry& theirs) {
  struct Match {
    const ::urdf::Geometry& theirs;
    bool operator()(const Box& box) const {
      const auto* other = dynamic_cast<const ::urdf::Box*>(&theirs);
      return other != nullptr && box.size == Eigen::Vector3d(other->dim.x, other->dim.y, other->dim.z);
    }
    bool operator()(const Sphere& sphere) const {
      const auto* other = dynamic_cast<const ::urdf::Sphere*>(&theirs);
      return other != nullptr && sphere.radius == other->radius;
    }
    bool round(double radius, double length) const {
      const auto* other = dynamic_cast<const ::urdf::Cylinder*>(&theirs);
      return other != nullptr && radius == other->radius && length == other->length;
    }
    bool operator()(const Cylinder& cylinder) const { return round(cylinder.radius, cylinder.length); }
    bool operator()(const Capsule& capsule) const { return round(capsule.radius, capsule.length); }
    bool operator()(const Mesh& mesh) const {
      const auto* other = dynamic_cast<const ::urdf::Mesh*>(&theirs);
      return other != nullptr && mesh.file == other->filename &&
             mesh.scale == Eigen::Vector3d(other->scale.x, other->scale.y, other->scale.z);
    }
  };
  return std::visit(Match{theirs}, ours);
}

template <class Theirs>
bool same(const std::vector<Shape>& ours, const std::vector<Theirs>& theirs) {
  return std::ranges::equal(ours, theirs, [](const Shape& shape, const Theirs& other) {
    return other != nullptr && other->geometry != nullptr && same(shape.geometry, *other->geometry) &&
           same(shape.pose, other->origin);
  });
}

bool same_inertial(const LinkDraft& draft, const ::urdf::Link& theirs) {
  if (!draft.has_inertial || theirs.inertial == nullptr) return !draft.has_inertial && theirs.inertial == nullptr;
  const auto& p = theirs.inertial->origin.position;
  return draft.link.inertial.mass == theirs.inertial->mass &&
         draft.link.inertial.center == Eigen::Vector3d(p.x, p.y, p.z);
}

void compare_links(const Draft& draft, const ::urdf::ModelInterface& robot, Findings& findings) {
  if (robot.links_.size() != draft.links.size()) {
    findings.error(0, fmt::format("urdfdom finds {} links and we find {}", robot.links_.size(), draft.links.size()));
  }
  for (const LinkDraft& ours : draft.links) {
    const Link& link = ours.link;
    const auto theirs = robot.getLink(link.name);
    std::string what;
    if (theirs == nullptr) {
      what = "the link itself";
    } else if (!same_inertial(ours, *theirs)) {
      what = "its <inertial>";
    } else if (!same(link.visuals, theirs->visual_array)) {
      what = fmt::format("its visuals ({}, we read {})", theirs->visual_array.size(), link.visuals.size());
    } else if (!same(link.collisions, theirs->collision_array)) {
      what = fmt::format("its collisions ({}, we read {})", theirs->collision_array.size(), link.collisions.size());
    } else {
      continue;
    }
    findings.error(link.line, fmt::format("urdfdom reads link {} differently: {}", in_quotes(link.name), what));
  }
}

int type_code(JointType type) {
  switch (type) {
    case JointType::free: return ::urdf::Joint::FLOATING;
    case JointType::fixed: return ::urdf::Joint::FIXED;
    case JointType::revolute: return ::urdf::Joint::REVOLUTE;
    case JointType::track:
    case JointType::continuous: return ::urdf::Joint::CONTINUOUS;
    case JointType::prismatic: return ::urdf::Joint::PRISMATIC;
  }
  REHEARSE_ASSERT(false, "a JointType outside its enumeration");
}

bool same_axis(const Joint& ours, const ::urdf::Joint& theirs) {
  constexpr double rounding = 1e-12;
  const Eigen::Vector3d axis(theirs.axis.x, theirs.axis.y, theirs.axis.z);
  return (axis.stableNormalized() - ours.axis).norm() < rounding;
}

/// In the document, infinite limits are the largest finite numbers.
bool same_limits(const Joint& ours, const ::urdf::Joint& theirs) {
  constexpr double greatest = std::numeric_limits<double>::max();
  if (ours.type == JointType::continuous) return true;  // the two readers differ in a range that has no meaning
  return theirs.limits != nullptr && std::max(ours.lower, -greatest) == theirs.limits->lower &&
         std::min(ours.upper, greatest) == theirs.limits->upper;
}

bool same_mimic(const std::optional<MimicDraft>& ours, const ::urdf::JointMimicSharedPtr& theirs) {
  if (!ours || theirs == nullptr) return !ours && theirs == nullptr;
  return ours->leader == theirs->joint_name && ours->multiplier == theirs->multiplier && ours->offset == theirs->offset;
}

void compare_joints(const Draft& draft, const ::urdf::ModelInterface& robot, Findings& findings) {
  if (robot.joints_.size() != draft.joints.size()) {
    findings.error(0, fmt::format("urdfdom finds {} joints and we find {}", robot.joints_.size(), draft.joints.size()));
  }
  for (const JointDraft& draft_joint : draft.joints) {
    const Joint& ours = draft_joint.joint;
    const auto theirs = robot.getJoint(ours.name);
    std::string_view what;
    if (theirs == nullptr) {
      what = "the joint itself";
    } else if (theirs->type != type_code(ours.type)) {
      what = "its type";
    } else if (theirs->parent_link_name != draft_joint.parent || theirs->child_link_name != draft_joint.child) {
      what = "its links";
    } else if (!same(ours.origin, theirs->parent_to_joint_origin_transform)) {
      what = "its origin";
    } else if (is_movable(ours.type) && !same_axis(ours, *theirs)) {
      what = "its axis";
    } else if (is_movable(ours.type) && !same_limits(ours, *theirs)) {
      what = "its limits";
    } else if (!same_mimic(draft_joint.mimic, theirs->mimic)) {
      what = "its <mimic>";
    } else {
      continue;
    }
    findings.error(ours.line, fmt::format("urdfdom reads joint {} differently: {}", in_quotes(ours.name), what));
  }
}

}  // namespace

void compare_with_urdfdom(const tinyxml2::XMLDocument& document, const Draft& draft, Findings& findings) {
  const auto robot = parse(document, findings);
  if (robot == nullptr) return;
  compare_links(draft, *robot, findings);
  compare_joints(draft, *robot, findings);
}

}  // namespace rehearse::urdf
