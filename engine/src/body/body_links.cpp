// The links of a body, and of the bodies that it contains.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/text.h"
#include "body_draft.h"
#include "model/rigid_groups.h"

namespace rehearse::body {
namespace {

class LinkReader {
 public:
  LinkReader(Files& files, Document& document, int depth) : files_(files), document_(document), depth_(depth) {}

  BodyDraft read();

 private:
  void check_head(Mapping& keys);
  Document* open(const YamlNode& at, const std::string& uri, const char* kind);
  BodyDraft read_other(Mapping& keys, const YamlNode& file);
  void read_loops(const YamlNode& loops);
  void read_loop_frame(Mapping& keys, LoopJoint& joint);
  void read_rest(Mapping& keys);
  void read_all(const YamlNode& links);
  void read_entry(const YamlNode& node, std::string type);
  void read_link(Mapping& keys);
  void read_sub_body(Mapping& keys);
  void add_sub_body(Mapping& keys, BodyDraft sub);
  void read_track(Mapping& keys);
  LinkDraft read_contents(Mapping& keys, LinkDraft draft, bool of_sub_body);
  void read_mass(Mapping& keys, std::vector<Inertial> bodies, Link& link);

  Files& files_;
  Document& document_;
  int depth_;
  BodyDraft draft_;
  CollisionRules sub_rules_;  // of the first sub-body that has any
};

constexpr std::pair<std::string_view, LoopJoint::Type> loop_types[] = {
    {"fixed", LoopJoint::Type::fixed}, {"hinge", LoopJoint::Type::revolute}, {"ball", LoopJoint::Type::spherical}};

/// Keys that only Choreonoid's other simulators or its GUI read, or no program.
const std::vector<std::string_view> link_keys_without_effect = {"density",
                                                                "jointLockForceRange",
                                                                "jointMotorForceRange",
                                                                "jointLockCompliance",
                                                                "jointLockSpookDamping",
                                                                "jointMotorSpookDamping",
                                                                "jointMotorCompliance",
                                                                "jointRangeForceRange",
                                                                "jointRangeCompliance",
                                                                "jointRangeSpookDamping",
                                                                "jointCompliance",
                                                                "jointSpookDamping",
                                                                "jointMotor",
                                                                "massType",
                                                                "autoSleep",
                                                                "convexDecomposition",
                                                                "AMOR",
                                                                "childLinks",
                                                                "import",
                                                                "description",
                                                                "force_range"};

BodyDraft LinkReader::read() {
  Mapping keys(*document_.root, "the file", document_);
  if (!keys.is_map()) return std::move(draft_);
  if (keys.find({"format"}) == nullptr)
    if (const YamlNode* file = keys.find({"model_file", "modelFile"})) return read_other(keys, *file);
  check_head(keys);
  draft_.name = keys.text({"name"}).value_or("");
  if (draft_.name.empty()) draft_.name = std::filesystem::path(document_.name()).stem().string();
  draft_.root_link = keys.text({"root_link", "rootLink"}).value_or("");
  const YamlNode* links = keys.find({"links"});
  if (links == nullptr)
    document_.error(*document_.root, "the file has no links", "links: a list of links");
  else
    read_all(*links);
  if (draft_.root_link.empty() && !draft_.links.empty()) draft_.root_link = draft_.links.front().link.name;
  if (const YamlNode* loops = keys.find({"extra_joints", "extraJoints"})) read_loops(*loops);
  read_rest(keys);
  return std::move(draft_);
}

/// The joint's place and axis in its first link; those in its second link have no effect in Choreonoid.
void LinkReader::read_loop_frame(Mapping& keys, LoopJoint& joint) {
  joint.has_other_frame = false;
  joint.frame.translation() = keys.vector({"translation_in_link1", "link1LocalPos"}).value_or(Eigen::Vector3d::Zero());
  if (const YamlNode* node = keys.find({"rotation_in_link1"}))
    joint.frame.linear() = read_rotation(*node, document_).value_or(Eigen::Matrix3d::Identity());
  const Eigen::Vector3d axis = keys.vector({"axis", "jointAxis"}).value_or(Eigen::Vector3d::UnitX());
  if (axis.isZero(0.0))
    document_.error(keys.node(), "the axis of an extra joint is zero", "as in [0, 0, 1]");
  else
    joint.axis = axis.stableNormalized();
  if (const YamlNode* node = keys.find({"rotation_in_link2"})) read_rotation(*node, document_);
  keys.vector({"translation_in_link2", "link2LocalPos"});
}

void LinkReader::read_loops(const YamlNode& loops) {
  if (loops.kind != YamlNode::Kind::list) return document_.error(loops, "extra_joints isn't a list");
  for (const YamlNodePtr& item : loops.items) {
    Mapping keys(*item, "an extra joint", document_);
    if (!keys.is_map()) continue;
    LoopDraft loop;
    const std::string kind = keys.text({"joint_type", "jointType"}).value_or("");
    loop.link1 = keys.text({"link1_name", "link1Name"}).value_or("");
    loop.link2 = keys.text({"link2_name", "link2Name"}).value_or("");
    const auto name = keys.text({"name"});
    loop.joint.name = name && !name->empty() ? *name : fmt::format("{}-{}", loop.link1, loop.link2);
    read_loop_frame(keys, loop.joint);
    keys.finish();
    const auto known = std::ranges::find_if(loop_types, [&kind](const auto& type) { return type.first == kind; });
    if (known == std::end(loop_types) && kind != "piston")
      document_.error(*item, fmt::format("the type of an extra joint is {}", in_quotes(kind)),
                      "fixed, hinge, ball or piston");
    for (const std::string& name : {loop.link1, loop.link2})
      if (std::ranges::none_of(draft_.links, [&name](const LinkDraft& draft) { return draft.link.name == name; }))
        document_.error(*item, fmt::format("an extra joint is on {}, which is not a link", in_quotes(name)));
    if (loop.link1 == loop.link2)
      document_.error(*item, fmt::format("an extra joint connects {} to itself", in_quotes(loop.link1)));
    if (kind == "piston")
      document_.warning(*item, fmt::format("the piston that closes a loop between links {} and {} isn't simulated: the "
                                           "links move freely against each other",
                                           in_quotes(loop.link1), in_quotes(loop.link2)));
    if (known == std::end(loop_types)) continue;
    loop.joint.type = known->second;
    draft_.loops.push_back(std::move(loop));
  }
}

void LinkReader::read_rest(Mapping& keys) {
  draft_.rules.rules = keys.find({"collision_detection_rules"});
  draft_.rules.old = keys.find({"collisionDetection"});
  const bool has_rules = draft_.rules.rules != nullptr || draft_.rules.old != nullptr;
  draft_.rules.document = has_rules ? &document_ : sub_rules_.document;
  if (!has_rules) draft_.rules = sub_rules_;
  if (const YamlNode* handlers = keys.find({"body_handlers"})) {
    const auto tell = [this](const YamlNode& node) {
      document_.warning(
          node, fmt::format("the body handler {} is code of Choreonoid's; it is left out", in_quotes(node.text)));
    };
    if (handlers->kind == YamlNode::Kind::list)
      for (const YamlNodePtr& handler : handlers->items) tell(*handler);
    else
      tell(*handlers);
  }
  keys.find({"geometry", "linkInfo"});
  for (const auto& [key, node] : keys.unread()) document_.passed_over(*node, "the file", key);
}

void LinkReader::check_head(Mapping& keys) {
  const std::string format = keys.text({"format"}).value_or("");
  if (format != "ChoreonoidBody")
    document_.error(keys.node(),
                    format.empty() ? "it isn't a Choreonoid body: the format is missing"
                                   : fmt::format("the format is {}", in_quotes(format)),
                    "format: ChoreonoidBody");
  const auto version = keys.number({"format_version", "formatVersion"});
  if (!version)
    document_.error(keys.node(), "the format version is missing", "format_version: 2.0");
  else if (*version >= 2.1 || *version < 1.0)
    document_.error(keys.node(), fmt::format("the format version {} isn't known", *version), "1.0 and 2.0 are known");
  const std::string unit = keys.text({"angle_unit", "angleUnit"}).value_or("degree");
  if (unit != "degree" && unit != "radian")
    document_.error(keys.node(), fmt::format("the unit of angles {} isn't known", in_quotes(unit)), "degree or radian");
  document_.degrees = unit != "radian";
  if (!document_.degrees && version.value_or(1.0) >= 2.0)
    document_.error(keys.node(), "radian is not allowed from format version 2.0 on", "angles in degrees");
}

void LinkReader::read_all(const YamlNode& links) {
  if (links.kind == YamlNode::Kind::list) {
    for (const YamlNodePtr& link : links.items) read_entry(*link, "");
  } else {
    Mapping by_type(links, "links", document_);
    for (const auto& [type, node] : by_type.unread()) read_entry(*node, type);
  }
  if (draft_.links.empty() && !files_.has_error()) document_.error(links, "the body has no link");
}

void LinkReader::read_entry(const YamlNode& node, std::string type) {
  if (draft_.links.size() > max_body_links || (depth_ > 0 && files_.has_error())) return;
  Mapping keys(node, "a link", document_);
  if (!keys.is_map()) return;
  type = keys.text({"type"}).value_or(type.empty() ? "Link" : type);
  if (type == "Link")
    read_link(keys);
  else if (type == "SubBody")
    read_sub_body(keys);
  else if (type == "ContinuousTrack")
    read_track(keys);
  else if (type != "Skip")
    document_.error(node, fmt::format("links can't contain a node of the type {}", in_quotes(type)),
                    "Link, SubBody, ContinuousTrack or Skip");
  if (draft_.links.size() > max_body_links)
    document_.error(node, fmt::format("the body has more than {} links", max_body_links));
}

void LinkReader::read_link(Mapping& keys) {
  LinkDraft draft;
  draft.link.line = draft.link.joint.line = keys.node().line;
  draft.link.name = keys.text({"name"}).value_or("");
  draft.link.joint.name = keys.text({"joint_name"}).value_or("");
  if (draft.link.name.empty()) {
    document_.error(keys.node(), "a link has no name", "name: a text that no other link has");
    return;
  }
  if (draft.link.joint.name.empty()) draft.link.joint.name = draft.link.name;
  draft.parent = keys.text({"parent"}).value_or("");
  draft.link.joint.type = JointType::fixed;
  draft.link.joint.axis = Eigen::Vector3d::UnitZ();
  draft.link.joint.controller_id = -1;
  draft_.links.push_back(read_contents(keys, std::move(draft), false));
  keys.finish(link_keys_without_effect);
}

LinkDraft LinkReader::read_contents(Mapping& keys, LinkDraft draft, bool of_sub_body) {
  Link& link = draft.link;
  Joint& joint = link.joint;
  if (const YamlNode* translation = keys.find({"translation"}))
    joint.origin.translation() = read_translation(*translation, document_).value_or(Eigen::Vector3d::Zero());
  const YamlNode* rotation = keys.find({"rotation"});
  if (rotation != nullptr && !(rotation->kind == YamlNode::Kind::list && rotation->items.empty()))
    joint.origin.linear() = read_rotation(*rotation, document_).value_or(Eigen::Matrix3d::Identity());
  read_joint(keys, of_sub_body, joint);
  if (const auto material = keys.text({"material"})) link.material = *material == "default" ? "Default" : *material;
  Contents contents;
  if (const YamlNode* elements = keys.find({"elements"})) read_elements(files_, document_, *elements, contents);
  link.visuals.insert(link.visuals.end(), contents.visuals.begin(), contents.visuals.end());
  link.collisions.insert(link.collisions.end(), contents.collisions.begin(), contents.collisions.end());
  draft.devices.insert(draft.devices.end(), contents.devices.begin(), contents.devices.end());
  if (contents.replaced_body)
    draft.mass_hint = fmt::format(
        "its second RigidBody, of line {}, replaces the first, of line {}: write elements as a "
        "list",
        contents.replaced_body->second, contents.replaced_body->first);
  if (!of_sub_body) read_mass(keys, std::move(contents.bodies), link);
  return draft;
}

void LinkReader::read_mass(Mapping& keys, std::vector<Inertial> bodies, Link& link) {
  const auto center = keys.vector({"center_of_mass", "centerOfMass"});
  const auto mass = keys.number({"mass"});
  const YamlNode* node = keys.find({"inertia"});
  const auto inertia = node == nullptr ? std::nullopt : read_inertia(*node, document_);
  if (mass && !(*mass >= 0.0 && std::isfinite(*mass)))
    document_.error(keys.node(), fmt::format("the mass of link {} is {} kg", in_quotes(link.name), *mass),
                    "0 or above");
  const bool is_alone = bodies.empty();
  if (is_alone || center || mass || node != nullptr) {
    Inertial own;
    own.mass = mass.value_or(is_alone ? 1.0 : 0.0);
    own.center = center.value_or(Eigen::Vector3d::Zero());
    own.inertia = inertia.value_or((is_alone ? 1.0 : 0.0) * Eigen::Matrix3d::Identity());
    bodies.push_back(own);
  }
  link.inertial = merged(bodies);
  if (is_alone && !mass && link.joint.type != JointType::fixed)
    document_.warning(keys.node(), fmt::format("link {} has no mass: it gets 1 kg{}, as in Choreonoid",
                                               in_quotes(link.name), node == nullptr ? " and the inertia 1 1 1" : ""));
}

/// The document of another body; null, with an error, if it can't be read.
Document* LinkReader::open(const YamlNode& at, const std::string& uri, const char* kind) {
  const Result<NamedFile> file = files_.find(uri, document_);
  Diagnostic problem;
  Document* opened = nullptr;
  if (!file)
    problem = file.errors().front();
  else if (depth_ >= 10)
    problem = error("its sub-bodies contain each other");
  else
    opened = files_.open(*file, {}, problem);
  if (opened != nullptr) return opened;
  const std::string where = problem.line > 0 ? fmt::format("line {}: ", problem.line) : "";
  document_.error(at, fmt::format("the {} {} can't be used: {}{}", kind, in_quotes(uri), where, problem.message),
                  problem.hint);
  return nullptr;
}

/// A file that adds rules and notes to the body of another file.
BodyDraft LinkReader::read_other(Mapping& keys, const YamlNode& file) {
  if (!is_body_name(file.text)) {
    document_.error(file, fmt::format("modelFile names {}, which is no body file", in_quotes(file.text)),
                    "a .body, .yaml, .yml or .wrl is read; name a file of another format instead of this one");
    return std::move(draft_);
  }
  Document* other = open(file, file.text, "model");
  if (other == nullptr) return std::move(draft_);
  draft_ = LinkReader(files_, *other, depth_ + 1).read();
  sub_rules_ = std::exchange(draft_.rules, {});
  read_rest(keys);
  return std::move(draft_);
}

void LinkReader::read_sub_body(Mapping& keys) {
  const auto uri = keys.text({"uri"});
  if (!uri || uri->empty()) return document_.error(keys.node(), "a SubBody has no uri", "uri: the path of a .body");
  Document* sub = open(keys.node(), *uri, "sub-body");
  if (sub == nullptr) return;
  add_sub_body(keys, LinkReader(files_, *sub, depth_ + 1).read());
  keys.finish({"name", "mass", "centerOfMass", "center_of_mass", "inertia"});
}

void LinkReader::add_sub_body(Mapping& keys, BodyDraft sub) {
  const std::string prefix = keys.text({"prefix"}).value_or(""), suffix = keys.text({"suffix"}).value_or("");
  const std::string device_prefix = keys.text({"device_prefix", "devicePrefix"}).value_or(prefix);
  const int offset = static_cast<int>(std::clamp(keys.soft_number({"joint_id_offset", "jointIdOffset"}, 0.0),
                                                 -1.0 * max_body_links, 1.0 * max_body_links));
  if (sub_rules_.document == nullptr) sub_rules_ = sub.rules;
  const auto renamed = [&](const std::string& name) { return prefix + name + suffix; };
  for (LinkDraft& draft : sub.links) {
    Joint& joint = draft.link.joint;
    const bool is_root = draft.link.name == sub.root_link;
    joint.name = renamed(joint.name);
    draft.link.name = renamed(draft.link.name);
    draft.link.line = joint.line = keys.node().line;
    if (joint.controller_id.value_or(-1) >= 0) joint.controller_id = std::max(-1, *joint.controller_id + offset);
    for (Device& device : draft.devices) device.name = device_prefix + device.name;
    draft.parent = is_root ? keys.text({"parent"}).value_or("") : renamed(draft.parent);
    if (is_root) draft = read_contents(keys, std::move(draft), true);
    draft_.links.push_back(std::move(draft));
  }
  for (LoopDraft& loop : sub.loops)
    loop.joint.name = renamed(loop.joint.name), loop.link1 = renamed(loop.link1), loop.link2 = renamed(loop.link2);
  std::move(sub.loops.begin(), sub.loops.end(), std::back_inserter(draft_.loops));
}

/// A belt of AGX: a chain of links, the first of them free.
void LinkReader::read_track(Mapping& keys) {
  const double count = keys.soft_number({"numJoints"}, 0.0);
  const auto offset = keys.vector({"joint_offset", "jointOffset"});
  const auto angles = keys.numbers({"initialJointAngles"}).value_or(std::vector<double>());
  LinkDraft first;
  first.link.name = keys.text({"name"}).value_or("");
  first.parent = keys.text({"parent"}).value_or("");
  if (first.parent.empty() || !offset || !(count >= 3.0 && count <= max_body_links) || first.link.name.empty())
    return document_.error(keys.node(),
                           "a ContinuousTrack needs a name, a parent, jointOffset, and 3 or more numJoints");
  first.link.line = first.link.joint.line = keys.node().line;
  first.link.joint.axis = Eigen::Vector3d::UnitZ();
  first.link.joint.controller_id = -1;
  first = read_contents(keys, std::move(first), false);
  keys.finish(link_keys_without_effect);
  const std::string name = first.link.name;
  std::string parent = first.parent;
  for (int i = 0; i < static_cast<int>(count); ++i) {
    LinkDraft draft = first;
    draft.parent = std::exchange(parent, draft.link.joint.name = draft.link.name = fmt::format("{}{}", name, i));
    draft.link.joint.type = i == 0 ? JointType::free : JointType::continuous;
    if (i > 0) draft.link.joint.origin.translation() = *offset;
    if (i > 0 && static_cast<std::size_t>(i) <= angles.size())
      draft.link.joint.start = keys.radians(angles[static_cast<std::size_t>(i - 1)]);
    draft_.links.push_back(std::move(draft));
  }
}

}  // namespace

std::optional<Eigen::Matrix3d> read_inertia(const YamlNode& node, Document& document) {
  const bool is_short = node.kind == YamlNode::Kind::list && node.items.size() == 6;
  const auto v = read_numbers(node, is_short ? 6 : 9, "inertia", document);
  if (!v) return std::nullopt;
  Eigen::Matrix3d inertia;
  if (is_short) {
    inertia << (*v)[0], (*v)[1], (*v)[2], (*v)[1], (*v)[3], (*v)[4], (*v)[2], (*v)[4], (*v)[5];
    return inertia;
  }
  inertia = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(v->data());
  if ((inertia - inertia.transpose()).cwiseAbs().maxCoeff() > 1e-9 * inertia.cwiseAbs().maxCoeff())
    document.warning(node, "the inertia isn't symmetric; the mean of both sides is taken");
  return Eigen::Matrix3d((inertia + inertia.transpose()) / 2.0);
}

Inertial merged(const std::vector<Inertial>& bodies) {
  if (bodies.size() == 1) return bodies.front();
  Inertial all;
  for (const Inertial& body : bodies) {
    all.mass += body.mass;
    all.center += body.mass * body.center;
  }
  if (!(all.mass > 0.0)) return Inertial();
  all.center /= all.mass;
  for (const Inertial& body : bodies) {
    const Eigen::Vector3d arm = body.center - all.center;
    all.inertia += body.inertia;
    all.inertia += body.mass * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
  }
  return all;
}

BodyDraft read_body(Files& files, Document& document) { return LinkReader(files, document, 0).read(); }

}  // namespace rehearse::body
