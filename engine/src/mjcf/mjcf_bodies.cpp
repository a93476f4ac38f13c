#include "mjcf_bodies.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "model/rigid_groups.h"
#include "urdf/urdf_values.h"

namespace rehearse::mjcf {
namespace {

std::string_view kind_of(const XMLElement& xml) { return xml.Name(); }

std::string named(const XMLElement& xml) {
  const char* name = xml.Attribute("name");
  return name ? name : "";
}

/// The motion of a joint by a displacement, in the joint's frame.
Eigen::Isometry3d motion_of(const Joint& joint, double displacement) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (joint.type == JointType::prismatic)
    motion.translation() = displacement * joint.axis;
  else
    motion.linear() = Eigen::AngleAxisd(displacement, joint.axis).toRotationMatrix();
  return motion;
}

}  // namespace

urdf::JointDraft* Draft::find_joint(const std::string& name) {
  for (urdf::JointDraft& joint : tree.joints)
    if (joint.joint.name == name && is_movable(joint.joint.type)) return &joint;
  return nullptr;
}

std::vector<Bodies::Child> Bodies::children_of(const XMLElement& xml, const std::string& childclass,
                                               const Eigen::Isometry3d& frame, int depth) {
  std::vector<Child> found;
  for (const XMLElement* child : files_.children(xml)) {
    if (kind_of(*child) != "frame") {
      found.push_back({child, childclass, frame});
      continue;
    }
    if (depth > max_urdf_depth) {
      files_.error(*child, "too many frames within frames", fmt::format("expected at most {}", max_urdf_depth));
      return found;
    }
    check_attributes(files_, *child);
    const Element element(files_, *child, nullptr);
    const auto inner = children_of(*child, element.text_or("childclass", childclass.c_str()),
                                   frame * element.pose(compiler_), depth + 1);
    found.insert(found.end(), inner.begin(), inner.end());
  }
  return found;
}

void Bodies::collect_names(const XMLElement& xml, int depth) {
  if (depth > max_urdf_depth) return;
  for (const XMLElement* child : files_.children(xml)) {
    const std::string_view kind = kind_of(*child);
    if (kind == "body") body_names_.insert(named(*child));
    if (kind == "joint" || kind == "freejoint") joint_names_.insert(named(*child));
    if (kind == "body" || kind == "frame") collect_names(*child, depth + 1);
  }
}

std::string Bodies::unique(std::set<std::string>& names, const std::string& wanted) {
  std::string name = wanted;
  for (int i = 2; !names.insert(name).second; ++i) name = fmt::format("{}_{}", wanted, i);
  return name;
}

std::string Bodies::type_of(const Child& joint) const {
  if (kind_of(*joint.xml) == "freejoint") return "free";
  return classes_.described(*joint.xml, joint.childclass).text_or("type", "hinge");
}

std::vector<Bodies::Child> Bodies::joints_of(const std::vector<Child>& children) const {
  std::vector<Child> joints;
  for (const Child& child : children)
    if (kind_of(*child.xml) == "joint" || kind_of(*child.xml) == "freejoint") joints.push_back(child);
  return joints;
}

/// `reference`: the displacement in the posture that the file describes; `anchor`: in the body's frame.
std::optional<Joint> Bodies::read_joint(const Child& child, const std::string& body, double& reference,
                                        Eigen::Vector3d& anchor) {
  const Element element = classes_.described(*child.xml, child.childclass);
  check_attributes(files_, *child.xml);
  const std::string type = type_of(child);
  Joint joint;
  joint.name = named(*child.xml);
  joint.line = files_.line_in_main(*child.xml);
  const bool has_name = !joint.name.empty();
  if (!has_name) joint.name = unique(joint_names_, body + (type == "free" ? "_free" : "_joint"));
  joint.type = JointType::free;
  if (type == "free") return joint;
  if (type == "ball") {
    element.unsupported("a <joint> of type ball",
                        "write three hinges, about x, y and z; they are singular at 90 degrees of the second");
    return std::nullopt;
  }
  if (type != "hinge" && type != "slide") {
    element.error(fmt::format("the type of a <joint> is {}", in_quotes(type)), "free, hinge or slide");
    return std::nullopt;
  }
  const bool turns = type == "hinge";
  const auto in_file = [&](double value) { return turns ? compiler_.radians(value) : value; };
  const Eigen::Vector3d axis = element.vector("axis").value_or(Eigen::Vector3d::UnitZ());
  if (!(axis.norm() > 1e-10)) {
    element.error(fmt::format("the axis of joint {} is zero", in_quotes(joint.name)),
                  "expected a direction, as in 0 0 1");
    return std::nullopt;
  }
  joint.axis = child.frame.linear() * axis.normalized();
  anchor = child.frame * element.vector("pos").value_or(Eigen::Vector3d::Zero());
  const auto range = element.range("range", "limited", compiler_);
  joint.type = !turns ? JointType::prismatic : range ? JointType::revolute : JointType::continuous;
  if (range) joint.lower = in_file((*range)[0]), joint.upper = in_file((*range)[1]);
  reference = in_file(element.number("ref").value_or(0.0));
  joint.start = reference;
  const auto positive = [&](const char* attribute) {
    const double value = element.numbers(attribute, 1, 3).value_or(std::vector<double>{0.0})[0];
    if (value < 0.0)
      element.error(fmt::format("{} of joint {} is {}", attribute, in_quotes(joint.name), value), "expected 0 or more");
    return std::max(value, 0.0);
  };
  joint.damping = positive("damping");
  joint.friction = positive("frictionloss");
  joint.armature = positive("armature");
  joint.spring_stiffness = positive("stiffness");
  if (joint.spring_stiffness > 0.0) joint.spring_reference = in_file(element.number("springref").value_or(0.0));
  if (const auto spring = element.numbers("springdamper", 2, 2); spring && ((*spring)[0] != 0.0 || (*spring)[1] != 0.0))
    element.unsupported("springdamper of <joint>", "state stiffness and damping");
  if (element.flag("actuatorgravcomp") == true) element.unsupported("actuatorgravcomp of <joint>");

  MjcfDrive& drive = draft_.drives.emplace_back();
  drive.joint = joint.name;
  const auto stated = [](double value) { return value != 0.0 ? std::optional(value) : std::nullopt; };
  drive.damping = stated(joint.damping);
  drive.coulomb = stated(joint.friction);
  drive.armature = stated(joint.armature);
  if (const auto forces = element.range("actuatorfrcrange", "actuatorfrclimited", compiler_))
    drive.effort = std::max(std::abs((*forces)[0]), std::abs((*forces)[1]));
  return joint;
}

std::optional<Inertial> Bodies::read_inertial(const Child& child) {
  const Element element(files_, *child.xml, nullptr);
  check_attributes(files_, *child.xml);
  const auto mass = element.number("mass");
  if (!mass || *mass < 0.0) {
    if (!element.states("mass") || mass)
      element.error(mass ? fmt::format("<inertial> has the mass {}", *mass) : "<inertial> has no mass",
                    "mass=\"1.5\" [kg]");
    return std::nullopt;
  }
  Inertial inertial;
  inertial.mass = *mass;
  const Eigen::Isometry3d pose = child.frame * element.pose(compiler_);
  if (const auto v = element.numbers("fullinertia", 6, 6)) {
    inertial.inertia << (*v)[0], (*v)[3], (*v)[4], (*v)[3], (*v)[1], (*v)[5], (*v)[4], (*v)[5], (*v)[2];
    if (!is_positive_definite(inertial.inertia))
      element.error("fullinertia of <inertial> isn't positive definite", "ixx iyy izz ixy ixz iyz [kg·m²]");
  } else if (const auto diagonal = element.vector("diaginertia")) {
    inertial.inertia = diagonal->asDiagonal();
    if (diagonal->minCoeff() < 0.0) element.error("diaginertia of <inertial> is negative", "expected 0 or more");
  }
  return moved(inertial, pose);
}

/// The inertial with the least mass and moments that <compiler> states.
Inertial Bodies::bounded(Inertial inertial) const {
  inertial.mass = std::max(inertial.mass, compiler_.least_mass);
  if (compiler_.least_inertia <= 0.0 && !compiler_.balances_inertia) return inertial;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertial.inertia);
  Eigen::Vector3d moments = solver.eigenvalues().cwiseMax(compiler_.least_inertia);
  if (compiler_.balances_inertia && moments[0] + moments[1] < moments[2]) moments.setConstant(moments.mean());
  inertial.inertia = solver.eigenvectors() * moments.asDiagonal() * solver.eigenvectors().transpose();
  return inertial;
}

/// The first colliding geom that states friction decides for its link.
void Bodies::set_surface(const Element& element, const Geom& geom, Surface& surface) {
  if (!geom.friction) return;
  if (!surface.friction) {
    surface.friction = geom.friction;
    surface.torsional_friction = geom.torsional_friction;
    surface.rolling_friction = geom.rolling_friction;
  } else if (surface.friction != geom.friction) {
    files_.warning(element.xml(),
                   fmt::format("a second <geom> of its body has another friction, {}; the first counts, {}",
                               *geom.friction, *surface.friction));
  }
}

void Bodies::read_camera(const Child& child, const Place& place) {
  const Element element = classes_.described(*child.xml, child.childclass);
  check_attributes(files_, *child.xml);
  if (place.link.empty()) return files_.ignored(*child.xml, "a <camera> of <worldbody>");
  const std::string mode = element.text_or("mode", "fixed");
  if (mode != "fixed") return files_.ignored(*child.xml, fmt::format("a <camera> of mode {}", printable(mode)));
  urdf::DeviceDraft& draft = draft_.tree.devices.emplace_back();
  Camera camera;
  camera.width = 320;
  camera.height = 240;
  constexpr double usual_angle = 45.0;
  const double angle = element.number("fovy").value_or(usual_angle) * 3.14159265358979323846 / 180.0;
  if (const auto pixels = element.numbers("resolution", 2, 2)) {
    const auto is_side = [](double side) { return side >= 1.0 && side <= max_image_side && side == std::floor(side); };
    if (!is_side((*pixels)[0]) || !is_side((*pixels)[1]))
      element.error(fmt::format("resolution of <camera> is {}", in_quotes(*element.text("resolution"))),
                    fmt::format("expected whole numbers up to {}", max_image_side));
    else if ((*pixels)[0] > 1.0 || (*pixels)[1] > 1.0)
      camera.width = static_cast<int>((*pixels)[0]), camera.height = static_cast<int>((*pixels)[1]);
  }
  if (!(angle > 0.0) || !(angle < 3.1))
    element.error(fmt::format("fovy of <camera> is {}", in_quotes(element.text_or("fovy", ""))),
                  "expected degrees above 0, below 177");
  camera.field_of_view =
      camera.width >= camera.height ? angle : 2.0 * std::atan(std::tan(0.5 * angle) * camera.width / camera.height);
  draft.device.name = unique(camera_names_, named(*child.xml).empty() ? place.link + "_camera" : named(*child.xml));
  draft.device.kind = camera;
  draft.device.line = files_.line_in_main(*child.xml);
  draft.device.pose = place.frame * child.frame * element.pose(compiler_);
  draft.reference = place.link;
  draft.meaning = urdf::Reference::link;
}

void Bodies::read_parts(const std::vector<Child>& children, const Place& place, bool is_world, urdf::LinkDraft& link,
                        Inertial& of_geoms, std::optional<Inertial>& stated) {
  for (const Child& child : children) {
    const std::string_view kind = kind_of(*child.xml);
    if (urdf::is_one_of(kind, {"body", "joint", "freejoint"})) continue;
    const auto described = [&] { return classes_.described(*child.xml, child.childclass); };
    if (kind == "geom") {
      if (is_world && place.link.empty()) {
        files_.ignored(*child.xml, "a <geom> of <worldbody>, which a body of the scenario replaces,");
        continue;
      }
      const Element element = described();
      const auto read = geoms_.read(element, is_world);
      if (!read) continue;
      Geom geom = *read;
      of_geoms = sum(of_geoms, moved(geom.inertial, place.frame * child.frame));
      geom.shape.pose = place.frame * child.frame * geom.shape.pose;
      if (geom.is_seen) link.link.visuals.push_back(geom.shape);
      if (!geom.touches()) continue;
      geom.shape.color = std::nullopt;
      link.link.collisions.push_back(geom.shape);
      set_surface(element, geom, link.link.surface);
      draft_.bodies[link.link.name].masks.insert({geom.contype, geom.conaffinity});
    } else if (kind == "site") {
      const Element element = described();
      check_attributes(files_, *child.xml);
      Eigen::Isometry3d pose = element.pose(compiler_);
      if (const auto ends = element.numbers("fromto", 6, 6)) {
        const Eigen::Map<const Eigen::Vector3d> from(ends->data()), to(ends->data() + 3);
        pose.translation() = 0.5 * (from + to);
        if ((from - to).norm() > 1e-10) pose.linear() = rotation_of_z(from - to);
      }
      draft_.sites[named(*child.xml)] = {place.link, place.frame * child.frame * pose};
    } else if (kind == "camera") {
      read_camera(child, place);
    } else if (kind == "inertial") {
      if (stated) files_.error(*child.xml, "a second <inertial> of a body", "give one");
      stated = read_inertial(child);
      if (stated) *stated = moved(*stated, place.frame);
    } else if (kind == "light") {
      files_.ignored(*child.xml, "a <light>");
    } else {
      files_.unsupported(*child.xml, fmt::format("{} in a body", urdf::tag(kind)));
    }
  }
}

void Bodies::read_body(const Child& body, const Place& parent, bool is_root, int depth) {
  if (depth > max_urdf_depth)
    return files_.error(*body.xml, "too many bodies within bodies", fmt::format("expected at most {}", max_urdf_depth));
  if (draft_.tree.links.size() > max_urdf_links) return;
  check_attributes(files_, *body.xml);
  const Element element(files_, *body.xml, nullptr);
  if (element.flag("mocap") == true) element.unsupported("a body with mocap", "a kinematic body of the scenario");
  const std::string childclass = element.text_or("childclass", body.childclass.c_str());
  std::string name = named(*body.xml);
  if (name.empty()) name = unique(body_names_, fmt::format("body_{}", ++unnamed_bodies_));
  const std::vector<Child> children = children_of(*body.xml, childclass, Eigen::Isometry3d::Identity(), 0);

  // The frame of the link above the next joint, then that of the body, as the joints pass.
  Eigen::Isometry3d origin = parent.frame * body.frame * element.pose(compiler_);
  std::string above = parent.link;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  std::vector<urdf::JointDraft> joints;
  for (const Child& child : joints_of(children)) {
    double reference = 0.0;
    Eigen::Vector3d anchor = Eigen::Vector3d::Zero();
    auto joint = read_joint(child, name, reference, anchor);
    if (!joint) {
      if (type_of(child) == "ball") draft_.coordinates.push_back({"", name, 4});
      continue;
    }
    const bool is_free = joint->type == JointType::free;
    if (is_free && depth > 0)
      files_.error(*child.xml, fmt::format("body {} has a free joint within another body", in_quotes(name)),
                   "only bodies of <worldbody> are free");
    if ((is_free && !joints.empty()) || (!joints.empty() && joints.back().joint.type == JointType::free))
      files_.error(*child.xml, fmt::format("body {} has a free joint and another one", in_quotes(name)),
                   "a free body has no other joint");
    joint->origin = origin * Eigen::Translation3d(anchor - shift);
    if (!is_free) joint->origin = joint->origin * motion_of(*joint, -reference);
    draft_.coordinates.push_back({joint->name, name, is_free ? 7u : 1u});
    joints.push_back({*joint, "", "", std::nullopt});
    origin = Eigen::Isometry3d::Identity();
    shift = anchor;
  }
  if (is_root) {
    draft_.root_is_free = !joints.empty();
    draft_.root_origin = joints.empty() ? origin : joints.back().joint.origin;
  } else {
    if (joints.empty()) {
      Joint fixed;
      fixed.name = unique(joint_names_, name + "_fixed");
      fixed.type = JointType::fixed;
      fixed.origin = origin;
      fixed.line = files_.line_in_main(*body.xml);
      joints.push_back({fixed, "", "", std::nullopt});
    }
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const bool is_last = i + 1 == joints.size();
      const std::string link = is_last ? name : unique(body_names_, name + "_" + joints[i].joint.name);
      joints[i].parent = above;
      joints[i].child = above = link;
      if (!is_last) {
        urdf::LinkDraft& between = draft_.tree.links.emplace_back();
        between.link.name = link;
        between.link.line = joints[i].joint.line;
        draft_.between.push_back(link);
      }
      draft_.tree.joints.push_back(joints[i]);
    }
  }
  Place place{name, Eigen::Isometry3d(Eigen::Translation3d(-shift))};
  urdf::LinkDraft link;
  link.link.name = name;
  link.link.line = files_.line_in_main(*body.xml);
  link.has_inertial = true;
  if (const double lift = element.number("gravcomp").value_or(0.0); lift == 1.0)
    link.link.has_weight = false;
  else if (lift != 0.0)
    element.unsupported(fmt::format("gravcomp=\"{}\" of a body", lift), "0 or 1");
  draft_.bodies[name].link = name;
  Inertial of_geoms;
  std::optional<Inertial> stated;
  read_parts(children, place, false, link, of_geoms, stated);
  const bool from_geoms = compiler_.inertia_from_geoms.value_or(!stated);
  link.link.inertial = bounded(from_geoms ? of_geoms : stated.value_or(Inertial()));
  draft_.tree.links.push_back(std::move(link));
  for (const Child& child : children)
    if (kind_of(*child.xml) == "body") read_body(child, place, false, depth + 1);
}

void Bodies::read() {
  joint_names_.insert("");
  std::vector<Child> children;
  for (const XMLElement* section : files_.children(*files_.root())) {
    if (kind_of(*section) != "worldbody") continue;
    collect_names(*section, 0);
    const Element element(files_, *section, nullptr);
    const auto found = children_of(*section, element.text_or("childclass", ""), Eigen::Isometry3d::Identity(), 0);
    children.insert(children.end(), found.begin(), found.end());
  }
  std::vector<Child> bodies;
  for (const Child& child : children) {
    if (kind_of(*child.xml) == "body") bodies.push_back(child);
    if (urdf::is_one_of(kind_of(*child.xml), {"joint", "freejoint", "inertial"}))
      files_.error(*child.xml, fmt::format("{} in <worldbody>, outside a body", urdf::tag(kind_of(*child.xml))),
                   "put it into a <body>");
  }
  if (bodies.empty()) return files_.error(*files_.root(), "the model has no body", "<worldbody><body name=\"...\">");
  bool is_alone = bodies.size() == 1;
  if (is_alone) {
    const Child& body = bodies.front();
    for (const Child& joint : joints_of(
             children_of(*body.xml, Element(files_, *body.xml, nullptr).text_or("childclass", body.childclass.c_str()),
                         Eigen::Isometry3d::Identity(), 0)))
      is_alone = is_alone && type_of(joint) == "free";
  }
  Place world;
  if (!is_alone) world.link = unique(body_names_, "world");
  urdf::LinkDraft ground;
  ground.link.name = world.link;
  ground.has_inertial = true;  // so that it stays the root
  Inertial no_mass;
  std::optional<Inertial> none;
  read_parts(children, world, true, ground, no_mass, none);
  if (!is_alone) {
    draft_.bodies[world.link].link = world.link;
    draft_.tree.links.push_back(std::move(ground));
  }
  for (const Child& body : bodies) read_body(body, world, is_alone, 0);
  if (compiler_.whole_mass > 0.0) {
    double mass = 0.0;
    for (const urdf::LinkDraft& link : draft_.tree.links) mass += link.link.inertial.mass;
    if (mass > 0.0)
      for (urdf::LinkDraft& link : draft_.tree.links) {
        link.link.inertial.mass *= compiler_.whole_mass / mass;
        link.link.inertial.inertia *= compiler_.whole_mass / mass;
      }
  }
}

}  // namespace rehearse::mjcf
