// <equality>, <contact> and <keyframe>.
#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>

#include "base/names.h"
#include "base/text.h"
#include "mjcf_bodies.h"

namespace rehearse::mjcf {
namespace {

std::string joint_hint(const Draft& draft, const std::string& wanted) {
  std::vector<std::string> names;
  for (const MjcfDrive& drive : draft.drives) names.push_back(printable(drive.joint));
  return name_hint(wanted, names, "joints");
}

/// joint1 = its ref + polycoef[0] + polycoef[1] (joint2 - its ref).
void read_equal_joints(const Element& element, Draft& draft) {
  const std::string follower = element.text_or("joint1", ""), leader = element.text_or("joint2", "");
  urdf::JointDraft* joint = draft.find_joint(follower);
  const urdf::JointDraft* other = draft.find_joint(leader);
  for (const auto& [found, name] :
       {std::pair<const urdf::JointDraft*, std::string>(joint, follower), {other, leader}}) {
    if (found != nullptr) continue;
    if (name.empty() && joint != nullptr)
      return element.unsupported("an equality of a single joint", "joint2=\"NAME\"");
    return element.error(fmt::format("an equality of joint {}, which the model lacks", in_quotes(name)),
                         joint_hint(draft, name));
  }
  std::vector<double> factors = element.numbers("polycoef", 1, 5).value_or(std::vector<double>{0.0, 1.0});
  factors.resize(5, 0.0);
  if (factors.size() > 2 && std::any_of(factors.begin() + 2, factors.end(), [](double each) { return each != 0.0; }))
    return element.unsupported("an equality of joints that isn't linear", "polycoef=\"OFFSET FACTOR 0 0 0\"");
  if (joint->mimic)
    return element.error(fmt::format("a second equality moves joint {}", in_quotes(follower)), "give one of them");
  urdf::MimicDraft mimic;
  mimic.leader = leader;
  mimic.multiplier = factors[1];
  mimic.offset = joint->joint.start + factors[0] - factors[1] * other->joint.start;
  mimic.line = joint->joint.line;
  joint->mimic = mimic;
}

}  // namespace

void read_equalities(Files& files, const Classes& classes, Draft& draft) {
  for (const XMLElement* xml : files.in_section("equality")) {
    const Element element = classes.described(*xml);
    if (element.flag("active") == false) {
      files.ignored(*xml, "an equality that isn't active");
    } else if (element.kind() == "joint") {
      read_equal_joints(element, draft);
    } else {
      element.unsupported(fmt::format("an equality of type {}", printable(element.kind())), "joint");
    }
  }
}

void read_keyframes(Files& files, const Draft& draft, Model& model) {
  std::size_t count = 0;
  for (const Coordinate& each : draft.coordinates) count += each.count;
  std::set<std::string> names;
  std::size_t index = 0;
  for (const XMLElement* xml : files.in_section("keyframe")) {
    const Element element(files, *xml, nullptr);
    Posture posture;
    posture.name = element.text_or("name", std::to_string(index++).c_str());
    for (const char* other : {"qvel", "act", "ctrl", "time", "mpos", "mquat"})
      if (element.states(other)) files.ignored(*xml, fmt::format("the attribute {} of <key>", other));
    const auto values = element.states("qpos") ? element.numbers("qpos", count, count) : std::nullopt;
    if (!values) continue;
    if (!names.insert(posture.name).second) {
      element.error(fmt::format("a second keyframe has the name {}", in_quotes(posture.name)),
                    "give each one of its own");
      continue;
    }
    posture.q.assign(model.joints.size(), 0.0);
    const double* next = values->data();
    for (const Coordinate& each : draft.coordinates) {
      const double* const q = next;
      next += each.count;
      if (each.count == 4) continue;
      if (each.count == 1) {
        const int link = model.find_joint(each.joint);
        posture.q[static_cast<std::size_t>(model.links[static_cast<std::size_t>(link)].joint.id)] = *q;
        continue;
      }
      if (each.link != model.links.front().name) {
        files.ignored(*xml, "the place of a free body beside the root in a <key>");
        continue;
      }
      const Eigen::Quaterniond turn(q[3], q[4], q[5], q[6]);
      if (!(turn.norm() > 1e-10)) {
        element.error(fmt::format("the quaternion of keyframe {} has no length", in_quotes(posture.name)), "1 0 0 0");
        continue;
      }
      posture.root = Eigen::Isometry3d::Identity();
      posture.root->translation() = Eigen::Vector3d(q[0], q[1], q[2]);
      posture.root->linear() = turn.normalized().toRotationMatrix();
    }
    model.postures.push_back(std::move(posture));
  }
}

void apply_contact_rules(Files& files, const Draft& draft, Model& model) {
  const std::size_t count = model.links.size();
  std::vector<const std::set<Mask>*> masks(count, nullptr);
  std::map<std::string, int> links;
  for (const auto& [name, body] : draft.bodies) {
    const int link = model.find_link(body.link);
    if (link < 0) continue;
    links[name] = link;
    masks[static_cast<std::size_t>(link)] = &body.masks;
  }
  const auto match = [](const std::set<Mask>& one, const std::set<Mask>& other) {
    for (const auto& [contype, conaffinity] : one)
      for (const auto& [other_contype, other_conaffinity] : other)
        if ((contype & other_conaffinity) != 0 || (other_contype & conaffinity) != 0) return true;
    return false;
  };
  std::vector<std::array<int, 2>> apart;
  for (const XMLElement* xml : files.in_section("contact")) {
    const Element element(files, *xml, nullptr);
    if (element.kind() == "pair") {
      files.ignored(*xml, "a <pair> of <contact>");
      continue;
    }
    if (element.kind() != "exclude") {
      element.unsupported(fmt::format("{} of <contact>", urdf::tag(element.kind())), "exclude");
      continue;
    }
    std::array<int, 2> pair{};
    bool is_known = true;
    for (std::size_t i = 0; i < 2; ++i) {
      const std::string name = element.text_or(i == 0 ? "body1" : "body2", "");
      const auto found = links.find(name);
      is_known = is_known && (found != links.end() || name == "world");
      pair[i] = found == links.end() ? -1 : found->second;
      if (found != links.end() || name == "world") continue;
      std::vector<std::string> names;
      for (const auto& [each, link] : links) names.push_back(printable(each));
      element.error(fmt::format("<exclude> names body {}, which the model lacks", in_quotes(name)),
                    name_hint(name, names, "bodies"));
    }
    std::ranges::sort(pair);
    if (is_known && pair[0] >= 0) apart.push_back(pair);
  }
  std::map<std::set<Mask>, std::size_t> kinds;                   // links with the same masks touch the same links
  std::vector<std::pair<std::size_t, std::size_t>> with_shapes;  // link and kind
  for (std::size_t i = 0; i < count; ++i)
    if (masks[i] != nullptr && !masks[i]->empty())
      with_shapes.emplace_back(i, kinds.try_emplace(*masks[i], kinds.size()).first->second);
  std::vector<std::vector<bool>> touch(kinds.size(), std::vector<bool>(kinds.size()));
  for (const auto& [one, i] : kinds)
    for (const auto& [other, j] : kinds) touch[i][j] = match(one, other);
  for (const auto& [a, kind] : with_shapes)
    for (const auto& [b, other] : with_shapes)
      if (a < b && touch[kind][other]) model.links[a].collides_with_own = model.links[b].collides_with_own = true;
  for (const auto& [a, kind] : with_shapes)
    for (const auto& [b, other] : with_shapes)
      if (a < b && model.links[a].collides_with_own && model.links[b].collides_with_own && !touch[kind][other])
        apart.push_back({static_cast<int>(a), static_cast<int>(b)});
  std::ranges::sort(apart);
  apart.erase(std::unique(apart.begin(), apart.end()), apart.end());
  model.apart = std::move(apart);
}

}  // namespace rehearse::mjcf
