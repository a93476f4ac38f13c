// Draft: the links of a .body as they are written, before they are joined to a Model.
#pragma once

#include <rehearse/model.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body_document.h"
#include "body_mapping.h"

namespace rehearse::body {

/// The parts that the elements of a link describe, in the link's frame.
struct Contents {
  std::vector<Inertial> bodies;
  std::vector<Shape> visuals;
  std::vector<Shape> collisions;
  std::vector<Device> devices;  // without the link
  /// Lines of a RigidBody and of a second one that replaces it; nothing: none is replaced.
  std::optional<std::pair<int, int>> replaced_body;
};

struct LinkDraft {
  Link link;  // all but the parent; its joint's controller_id is the jointId
  std::string parent;
  std::vector<Device> devices;
  std::string mass_hint;  // if the link turns out to have no mass; empty: the usual hint
};

/// A joint that closes a loop. Its second frame is that of the initial posture, as for Choreonoid's ODE item.
struct LoopDraft {
  LoopJoint joint;  // without links
  std::string link1, link2;
};

/// The file's rules for links that don't touch each other; null nodes: the file has no rules.
struct CollisionRules {
  Document* document = nullptr;
  const YamlNode* rules = nullptr;  // collision_detection_rules, a list
  const YamlNode* old = nullptr;    // collisionDetection, a mapping
};

struct BodyDraft {
  std::string name;
  std::string root_link;
  std::vector<LinkDraft> links;  // in document order
  std::vector<LoopDraft> loops;
  CollisionRules rules;
};

/// True if a file of that name is read as a body: .body, .yaml, .yml, .wrl.
bool is_body_name(const std::filesystem::path& file);

/// Reads a body's links, and those of its sub-bodies. Errors are reported in their document.
BodyDraft read_body(Files& files, Document& document);

/// Reads the elements of a link.
void read_elements(Files& files, Document& document, const YamlNode& elements, Contents& contents);

/// Reads type, axis, ranges, id and drive of the link's joint. `of_sub_body`: the joint is that of a sub-body's root.
void read_joint(Mapping& keys, bool of_sub_body, Joint& joint);

/// Nine numbers row by row, or six: xx xy xz yy yz zz [kg·m²].
std::optional<Eigen::Matrix3d> read_inertia(const YamlNode& node, Document& document);

/// The sum of rigid bodies: mass, centre, inertia about the centre.
Inertial merged(const std::vector<Inertial>& bodies);

/// Takes the collision shapes of links that touch nothing, and sets Model::apart.
void apply_collision_rules(const CollisionRules& rules, Model& model);

/// Joins the links to a tree, with joint ids and devices in Choreonoid's order. Nothing, with errors, if they don't
/// form a tree.
std::optional<Model> join(BodyDraft draft, Files& files);

}  // namespace rehearse::body
