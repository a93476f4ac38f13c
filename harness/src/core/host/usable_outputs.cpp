#include "usable_outputs.h"

#include <fmt/format.h>

#include <cnoid/Link>

namespace rehearse {
namespace {

using CnoidLink = cnoid::Link;

constexpr int joint_flags = CnoidLink::JointDisplacement | CnoidLink::JointVelocity | CnoidLink::JointAcceleration |
                            CnoidLink::JointEffort | CnoidLink::DeprecatedJointSurfaceVelocity;
constexpr int velocity_flags = CnoidLink::JointVelocity | CnoidLink::DeprecatedJointSurfaceVelocity;

class Judge {
 public:
  Judge(const ScenarioBody& body, int link, int mode)
      : body_(body), link_(body.model->links[link]), is_root_(link == 0), mode_(mode) {}

  std::vector<std::string> judge() {
    if (wants(CnoidLink::HighGainActuation))
      say("HighGainActuation has no effect on link '{}': the other flags of its mode drive it; Choreonoid's AIST item "
          "warns of it, and drives the link by nothing",
          link_.name);
    judge_joint();
    judge_link();
    return std::move(findings_);
  }

 private:
  bool wants(int flags) const { return (mode_ & flags) != 0; }

  void judge_joint() {
    const Joint& joint = link_.joint;
    if (!wants(joint_flags)) return;
    if (joint.id < 0) {
      say("link '{}' has no joint to command{}", link_.name,
          wants(CnoidLink::DeprecatedJointSurfaceVelocity)
              ? fmt::format("; its surface runs if the scenario's body has belts: [{{link: {}, axis: [0, 1, 0]}}]",
                            link_.name)
              : "");
    } else if (joint.mimic) {
      const Model& model = *body_.model;
      say("joint '{}' follows joint '{}': a command to it has no effect", joint.name,
          model.links[model.joints[joint.mimic->leader]].joint.name);
    } else if (joint.type == JointType::track) {
      if (wants(joint_flags & ~velocity_flags))
        say("track '{}' can be commanded by JointVelocity, and by nothing else", joint.name);
    } else {
      if (wants(CnoidLink::JointAcceleration)) say("JointAcceleration doesn't drive joint '{}'", joint.name);
      if (wants(CnoidLink::JointEffort) && body_.kinematic)
        say("joint '{}' can't be driven by JointEffort: its body is kinematic, and moves by JointDisplacement or "
            "JointVelocity",
            joint.name);
    }
  }

  void judge_link() {
    if (wants(CnoidLink::LinkAcceleration)) say("LinkAcceleration doesn't drive link '{}'", link_.name);
    if (wants(CnoidLink::LinkExtWrench) && body_.kinematic)
      say("a wrench on link '{}' has no effect: its body is kinematic", link_.name);
    if (!wants(CnoidLink::LinkPosition | CnoidLink::LinkTwist)) return;
    if (is_root_ ? body_.fixed : link_.joint.type == JointType::fixed)
      say("link '{}' can't be moved by command: it is fixed to {}", link_.name, is_root_ ? "the world" : "its parent");
    else if (!is_root_ && body_.kinematic)
      say("link '{}' can't be moved by command: of a kinematic body only the root link can", link_.name);
    else if (!is_root_ && link_.joint.type != JointType::free)
      say("link '{}' can't be moved by command: joint '{}' connects it to its parent", link_.name, link_.joint.name);
  }

  template <class... Values>
  void say(fmt::format_string<Values...> format, Values&&... values) {
    findings_.push_back(fmt::format(format, std::forward<Values>(values)...));
  }

  const ScenarioBody& body_;
  const Link& link_;
  bool is_root_;
  int mode_;
  std::vector<std::string> findings_;
};

}  // namespace

std::vector<std::string> useless_outputs(const ScenarioBody& body, int link, int mode) {
  return Judge(body, link, mode).judge();
}

std::string joint_mode_names(int mode) {
  std::string names;
  const auto add = [&](int flags, const char* name) {
    if (mode & flags) names += (names.empty() ? "" : " and ") + std::string(name);
  };
  add(CnoidLink::JointDisplacement, "JointDisplacement");
  add(velocity_flags, "JointVelocity");
  add(CnoidLink::JointEffort, "JointEffort");
  return names.empty() ? "no mode" : names;
}

}  // namespace rehearse
