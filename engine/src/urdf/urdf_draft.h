// Draft: the result of Rehearse's own URDF reader, before the parts are joined to a Model.
#pragma once

#include <rehearse/model.h>

#include "urdf_findings.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tinyxml2 {
class XMLDocument;
class XMLElement;
}  // namespace tinyxml2

namespace rehearse {
struct UrdfOptions;
}

namespace rehearse::urdf {

struct LinkDraft {
  Link link;  // name, inertial, shapes, line
  bool has_inertial = false;
  bool has_broken_inertial = false;  // its <inertial> couldn't be read
};

/// The content of <mimic>, with the leader's name as written.
struct MimicDraft {
  std::string leader;
  double multiplier = 1.0;
  double offset = 0.0;  // [rad] or [m]
  int line = 0;
};

struct JointDraft {
  Joint joint;  // all but the id and the mimic; a floating one is free, a track still continuous
  std::string parent;
  std::string child;
  std::optional<MimicDraft> mimic;
};

/// The meaning of a name that gives a sensor's place: a link, or a joint, which means its child link.
enum class Reference { link_else_joint, joint_else_link, link, joint };

struct DeviceDraft {
  Device device;  // all but the link; its pose is in the frame of the link or joint that `reference` names
  std::string reference;
  Reference meaning = Reference::link_else_joint;
  bool is_of_robot = false;             // a child of <robot> itself, not of a <gazebo> block
  bool has_parents_axes = false;        // a force sensor that measures along the axes of the joint's parent link
  std::vector<std::string> collisions;  // names of a contact sensor's collision shapes, as written; empty: all
};

/// A <pseudo_continuous_track> of a <gazebo> block.
struct TrackDraft {
  std::string reference;  // a joint, or a link, which means the joint above it
  int line = 0;
};

/// The contact properties that a <gazebo> block sets for a link; properties that it doesn't set are empty.
struct SurfaceDraft {
  std::string reference;  // a link
  Surface surface;
  std::optional<bool> has_weight;
  std::optional<bool> collides_with_own;
  bool says_something = false;  // the block sets at least one of the properties above
  bool has_devices = false;     // sensors, lights or tracks; their readers report a wrong reference
  int line = 0;
};

/// The spring that a <gazebo> block sets for a joint.
struct SpringDraft {
  std::string reference;  // a joint
  double stiffness = 0.0;
  double zero = 0.0;  // displacement without effort
  int line = 0;
};

/// A <loop_joint>, with the names of its links as written.
struct LoopDraft {
  LoopJoint joint;  // all but the links
  std::string link;
  std::string other_link;
  int line = 0;
};

/// The rotor of an actuator in a <transmission>.
struct RotorInertiaDraft {
  std::string joint;
  double inertia = 0.0;  // [kg·m²]
  double ratio = 1.0;    // of the gear
  int line = 0;
};

struct Draft {
  std::string name;
  std::vector<LinkDraft> links;           // in document order
  std::vector<JointDraft> joints;         // in document order
  std::vector<DeviceDraft> devices;       // in document order
  std::vector<TrackDraft> tracks;         // in document order
  std::vector<SurfaceDraft> surfaces;     // in document order
  std::vector<SpringDraft> springs;       // in document order
  std::vector<LoopDraft> loops;           // in document order
  std::vector<RotorInertiaDraft> rotors;  // in document order
  std::optional<bool> collides_with_own;  // of links that don't set it themselves
  bool is_static = false;                 // the root is fixed to the world
  int static_line = 0;                    // line of <static>
  bool is_complete = true;                // no link or joint had to be left out
};

class Materials;
class Meshes;

// Each function reads one kind of element. Repairs that urdfdom needs are also made in the document, so that both
// readers read the same robot.

/// Returns nullopt if the link has no name. A shape that can't be read is left out, with an error.
std::optional<LinkDraft> read_link(tinyxml2::XMLElement& element, const Materials& materials, Meshes& meshes,
                                   Findings& findings);

/// Returns nullopt if the joint has no name, type, parent or child.
std::optional<JointDraft> read_joint(tinyxml2::XMLElement& element, Findings& findings);

/// The sensors of <robot>, and the sensors and lights of its <gazebo> blocks.
std::vector<DeviceDraft> read_devices(const tinyxml2::XMLElement& robot, Findings& findings);

/// The tracks of all <gazebo> blocks.
std::vector<TrackDraft> read_tracks(const tinyxml2::XMLElement& robot, Findings& findings);

/// Reads the surfaces of all <gazebo> blocks, and the properties of the whole robot in blocks without a reference. Adds
/// notes about elements that no reader of <gazebo> blocks reads.
void read_surfaces(const tinyxml2::XMLElement& robot, Draft& draft, Findings& findings);

/// Reads a <contact> of a <link>.
void read_contact(const tinyxml2::XMLElement& contact, Surface& surface, Findings& findings);

/// Reads the inertias of rotors in <transmission> elements. Adds one note about all of them, with their joints and
/// hardware interfaces, and a warning about gear ratios that have no effect because no rotor's inertia is given.
std::vector<RotorInertiaDraft> read_transmissions(const tinyxml2::XMLElement& robot, Findings& findings);

/// Reads <springStiffness> and <springReference> of all <gazebo> blocks.
std::vector<SpringDraft> read_springs(const tinyxml2::XMLElement& robot, Findings& findings);

/// Reads all <loop_joint> elements. One that can't be read is left out, with an error.
std::vector<LoopDraft> read_loops(tinyxml2::XMLElement& robot, Findings& findings);

/// Sets springs, rotor inertias and loops in the model. A joint that doesn't exist is a warning, a link that doesn't
/// exist an error.
void apply_joint_parts(const Draft& draft, Model& model, Findings& findings);

/// Copies the draft's surfaces to the links; a warning for a reference that isn't a link.
void apply_surfaces(const Draft& draft, Model& model, Findings& findings);

/// Adds an undeclared "world" that is a parent to the draft and to the document: a repair.
void declare_world(tinyxml2::XMLElement& robot, Draft& draft, Findings& findings);

/// Joins links, joints and devices into a tree: depth-first links, joint ids, the root's joint. Returns nullopt, with
/// an error for each reason, if they don't form a tree.
std::optional<Model> join(const Draft& draft, Findings& findings);

/// Puts the draft's devices onto the model's links. A device whose link doesn't exist is left out, with a warning.
void place_devices(const Draft& draft, Model& model, Findings& findings);

/// Sets Joint::mimic of the joints that follow a leader, with chains resolved. An error for a leader that doesn't exist
/// or doesn't move, and for joints that follow each other in a circle.
void resolve_mimics(const Draft& draft, Model& model, Findings& findings);

/// How a link gets a mass in the format of the file.
struct MassHints {
  std::string usual = "give it or a link fixed to it an <inertial>";
  std::map<std::string, std::string> of_links = {};  // by name: the cause for one link
  const std::string& of(const std::string& link) const {
    const auto own = of_links.find(link);
    return own == of_links.end() ? usual : own->second;
  }
};

/// Handles moving links without mass: a root is fixed to the world, others get the default mass, if there is one; both
/// are repairs. Else an error.
void complete_masses(Model& model, const UrdfOptions& options, Findings& findings, const MassHints& hints = {});

/// Repairs the inertia of links with mass in rigid groups that move and whose inertia isn't positive definite: a link
/// without inertia gets that of its shapes, an inertia that isn't positive definite becomes the nearest that is. Call
/// it after complete_masses().
void repair_inertias(Model& model, const UrdfOptions& options, Findings& findings);

/// Checks the conditions of the physics engine: an error for a moving link without inertia or with one that isn't
/// positive definite; warnings about improbable values. Call it after repair_inertias().
void check_dynamics(const Model& model, const UrdfOptions& options, Findings& findings);

/// A warning if glTF meshes fit the collision shapes of their links only with z up in their files.
void check_mesh_up(const Model& model, const UrdfOptions& options, Findings& findings);

/// Parses the document with urdfdom and compares its robot with the draft; each difference is an error.
void compare_with_urdfdom(const tinyxml2::XMLDocument& document, const Draft& draft, Findings& findings);

}  // namespace rehearse::urdf
