// Draft: what our own pass has read of a URDF file, before the parts are joined to a Model.
#pragma once

#include <rehearse/model.h>

#include "urdf_findings.h"

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
  bool has_broken_inertial = false;  // it has one, but it couldn't be read
};

/// What <mimic> says, with the leader's name as written.
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

/// What a name in a sensor's place means: a link; or a joint, which stands for its child link.
enum class Reference { link_else_joint, joint_else_link, link, joint };

struct DeviceDraft {
  Device device;  // all but the link; its pose is in the frame of what `reference` names
  std::string reference;
  Reference meaning = Reference::link_else_joint;
  bool is_of_robot = false;             // it stands in <robot> itself, not in a <gazebo> block
  bool has_parents_axes = false;        // a force sensor that measures along the axes of the joint's parent link
  std::vector<std::string> collisions;  // of a contact sensor: the shapes that feel, as written; empty: all
};

/// A <pseudo_continuous_track> of a <gazebo> block.
struct TrackDraft {
  std::string reference;  // a joint, or a link, which stands for the joint above it
  int line = 0;
};

/// What a <gazebo> block says of touching a link; what it doesn't say stays as it is.
struct SurfaceDraft {
  std::string reference;  // a link
  Surface surface;
  std::optional<bool> has_weight;
  std::optional<bool> collides_with_own;
  bool says_something = false;  // of the above
  bool has_devices = false;     // sensors, lights or tracks, which say themselves whether the reference is right
  int line = 0;
};

struct Draft {
  std::string name;
  std::vector<LinkDraft> links;           // in document order
  std::vector<JointDraft> joints;         // in document order
  std::vector<DeviceDraft> devices;       // in document order
  std::vector<TrackDraft> tracks;         // in document order
  std::vector<SurfaceDraft> surfaces;     // in document order
  std::optional<bool> collides_with_own;  // of links that don't say it themselves
  bool is_static = false;                 // the root is fixed to the world
  int static_line = 0;                    // where that is said
  bool is_complete = true;                // no link or joint had to be left out
};

class Materials;
class Meshes;

// Each reads one kind of element. What it mends for urdfdom's sake it changes in the document as well, so that both
// readers see the same robot.

/// Null if the link has no name. A shape that can't be read is left out, with an error.
std::optional<LinkDraft> read_link(tinyxml2::XMLElement& element, const Materials& materials, Meshes& meshes,
                                   Findings& findings);

/// Null if the joint has no name, type, parent or child.
std::optional<JointDraft> read_joint(tinyxml2::XMLElement& element, Findings& findings);

/// The sensors of <robot>, and the sensors and lights of its <gazebo> blocks.
std::vector<DeviceDraft> read_devices(const tinyxml2::XMLElement& robot, Findings& findings);

/// The tracks of all <gazebo> blocks.
std::vector<TrackDraft> read_tracks(const tinyxml2::XMLElement& robot, Findings& findings);

/// The surfaces of all <gazebo> blocks, and what blocks without a reference say of the whole robot. Notes what no
/// reader of <gazebo> blocks knows.
void read_surfaces(const tinyxml2::XMLElement& robot, Draft& draft, Findings& findings);

/// A <contact> of a <link>.
void read_contact(const tinyxml2::XMLElement& contact, Surface& surface, Findings& findings);

/// One note of all <transmission> elements, with their joints and hardware interfaces.
void note_transmissions(const tinyxml2::XMLElement& robot, Findings& findings);

/// Gives the links what the draft's surfaces say; a warning for a reference to what isn't a link.
void apply_surfaces(const Draft& draft, Model& model, Findings& findings);

/// An undeclared "world" as parent is added to the draft and to the document: a repair.
void declare_world(tinyxml2::XMLElement& robot, Draft& draft, Findings& findings);

/// Joins links, joints and devices into a tree: depth-first links, joint ids, the root's joint. Null, with an error for
/// each reason, if they don't form one.
std::optional<Model> join(const Draft& draft, Findings& findings);

/// Puts the draft's devices onto the model's links. An error for one whose link isn't there.
void place_devices(const Draft& draft, Model& model, Findings& findings);

/// Sets Joint::mimic of the joints that follow another one, chains resolved. An error for a leader that isn't there or
/// doesn't move, and for joints that follow each other in a circle.
void resolve_mimics(const Draft& draft, Model& model, Findings& findings);

/// What moves without mass: a root is fixed to the world, others get the default mass, if there is one: repairs. Else
/// an error.
void complete_masses(Model& model, const UrdfOptions& options, Findings& findings);

/// What physics can't take: a moving link without inertia or with one that isn't positive definite; and warnings about
/// the improbable. After complete_masses.
void check_dynamics(const Model& model, const UrdfOptions& options, Findings& findings);

/// Lets urdfdom parse the document and compares its robot with ours; each difference is an error.
void compare_with_urdfdom(const tinyxml2::XMLDocument& document, const Draft& draft, Findings& findings);

}  // namespace rehearse::urdf
