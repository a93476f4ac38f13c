// The tree of a MuJoCo model's bodies as a draft of the URDF loader, which joins it to a Model.
#pragma once

#include <rehearse/mjcf.h>

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "mjcf_elements.h"
#include "mjcf_geoms.h"
#include "urdf/urdf_draft.h"

namespace rehearse::mjcf {

/// The bits of a geom that decide what it touches: contype and conaffinity.
using Mask = std::pair<int, int>;

struct SitePlace {
  std::string link;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the link's frame
};

struct BodyPlace {
  std::string link;      // of the body's last joint
  std::set<Mask> masks;  // of its collision shapes
};

/// A joint in the order of MuJoCo's qpos.
struct Coordinate {
  std::string joint;
  std::string link;
  std::size_t count = 1;  // of numbers: 7 of a free joint, 4 of a ball
};

/// What the files state, before it is a Model.
struct Draft {
  urdf::Draft tree;
  bool root_is_free = false;
  Eigen::Isometry3d root_origin = Eigen::Isometry3d::Identity();
  std::vector<std::string> between;  // links between the joints of a body
  std::map<std::string, BodyPlace> bodies;
  std::map<std::string, SitePlace> sites;
  std::vector<Coordinate> coordinates;
  std::vector<MjcfDrive> drives;  // of hinges and slides, in document order

  urdf::JointDraft* find_joint(const std::string& name);
};

class Bodies {
 public:
  Bodies(Files& files, const Classes& classes, const Compiler& compiler, Geoms& geoms, Draft& draft)
      : files_(files), classes_(classes), compiler_(compiler), geoms_(geoms), draft_(draft) {}

  /// Reads <worldbody>.
  void read();

 private:
  /// An element in a body, with the <frame>s around it.
  struct Child {
    const XMLElement* xml;
    std::string childclass;
    Eigen::Isometry3d frame;  // in the body's frame
  };
  /// A body's frame in the frame of a link.
  struct Place {
    std::string link;  // empty: the world
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  };

  std::vector<Child> children_of(const XMLElement& xml, const std::string& childclass, const Eigen::Isometry3d& frame,
                                 int depth);
  void collect_names(const XMLElement& xml, int depth);
  std::string unique(std::set<std::string>& names, const std::string& wanted);
  void read_body(const Child& body, const Place& parent, bool is_root, int depth);
  std::vector<Child> joints_of(const std::vector<Child>& children) const;
  std::string type_of(const Child& joint) const;
  std::optional<Joint> read_joint(const Child& child, const std::string& body, double& reference,
                                  Eigen::Vector3d& anchor);
  void read_parts(const std::vector<Child>& children, const Place& place, bool is_world, urdf::LinkDraft& link,
                  Inertial& of_geoms, std::optional<Inertial>& stated);
  std::optional<Inertial> read_inertial(const Child& child);
  Inertial bounded(Inertial inertial) const;
  void read_camera(const Child& child, const Place& place);
  void set_surface(const Element& element, const Geom& geom, Surface& surface);

  Files& files_;
  const Classes& classes_;
  const Compiler& compiler_;
  Geoms& geoms_;
  Draft& draft_;
  std::set<std::string> body_names_, joint_names_, camera_names_;
  int unnamed_bodies_ = 0;
};

/// Reads <actuator> into the drives, and sets the efforts of the joints.
void read_actuators(Files& files, const Classes& classes, const Compiler& compiler, Draft& draft);

/// Reads <sensor> into devices.
void read_sensors(Files& files, Draft& draft);

/// Reads <equality> of joints.
void read_equalities(Files& files, const Classes& classes, Draft& draft);

/// Sets which links of the model touch each other: by masks, and <contact><exclude>.
void apply_contact_rules(Files& files, const Draft& draft, Model& model);

/// Reads <keyframe> into Model::postures.
void read_keyframes(Files& files, const Draft& draft, Model& model);

}  // namespace rehearse::mjcf
