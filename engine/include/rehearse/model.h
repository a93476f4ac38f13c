// Model: one robot or object as its author described it. Immutable after loading.
//
// A model comes from a URDF file (urdf.h), a .body file of Choreonoid (body.h) or from a single shape
// (single_shape_model). It contains neither a position in the world nor a state of motion: World stores both. Units are
// SI, angles [rad]. Links are in depth-first order, with the children of a link in the document order of their joints.
// So a parent always comes before its children, and links[0] is the root. A link frame is its joint's frame after the
// joint's motion: T_world_link = T_world_parent * origin * motion(axis, q).
#pragma once

#include <rehearse/devices.h>
#include <rehearse/diagnostic.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rehearse {

// Meshes: the triangles of a model's shapes, as read from files. A mesh is immutable; all shapes, models and worlds
// that use the same file at the same scale share it.

/// A picture on the surface of a mesh. Pixels are red, green, blue, opacity, row by row, the top row first.
struct Texture {
  int width = 0;   // [pixels]
  int height = 0;  // [pixels]
  std::vector<std::uint8_t> rgba;
  std::string file;         // the file it was read from, for messages
  std::string digest = {};  // of the file's bytes (XXH3, 16 hexadecimal digits); empty: a mesh's digest contains them
};

/// Triangles of one material. Counter-clockwise seen from outside.
struct MeshPart {
  int object = 0;                         // parts of one object of the file share the number; from 0, ascending
  std::vector<Eigen::Vector3f> vertices;  // in the shape's frame, scale applied [m]
  std::vector<Eigen::Vector3f> normals;   // one a vertex, unit length
  std::vector<Eigen::Vector2f> texture_coordinates;     // one a vertex, (0, 0) is the picture's lower left; empty: none
  std::vector<std::array<std::uint32_t, 3>> triangles;  // indices of vertices
  std::optional<Eigen::Vector4f> color;    // red, green, blue, opacity, 0 to 1, as in the file; nullopt: the shape's
  bool has_default_color = false;          // of a material that a program added by itself: the shape's replaces it
  std::shared_ptr<const Texture> texture;  // its pixels are multiplied with the colour; null: no texture
};

struct MeshData {
  std::string file;    // real path of the mesh file; empty: the model's file contains the mesh
  std::string digest;  // of the file's bytes, then of the files it names (XXH3, 16 hexadecimal digits)
  std::vector<MeshPart> parts;
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();  // corners of the box around all vertices, along the axes [m]
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();

  std::size_t triangle_count() const {
    std::size_t count = 0;
    for (const MeshPart& part : parts) count += part.triangles.size();
    return count;
  }
};

/// The convex hull of one object of a mesh. Contacts are computed with it instead of the object's triangles.
struct ConvexHull {
  std::vector<Eigen::Vector3d> vertices;  // in the shape's frame [m]
  std::vector<std::vector<int>> faces;    // indices of vertices, flat polygons, counter-clockwise seen from outside
};

/// Heights over a grid of points, the ground of a landscape. The grid is centred on the shape's origin; x runs along a
/// row, and the first row is the one of the largest y, as in a picture seen from above. Each cell is two triangles, cut
/// from its corner of small x and y to that of large x and y.
struct Heightmap {
  int columns = 0;                                 // points along x
  int rows = 0;                                    // points along y
  Eigen::Vector2d size = Eigen::Vector2d::Zero();  // full extents along x and y [m]
  std::vector<double> heights;                     // row by row [m]

  Eigen::Vector2d cell() const { return {size.x() / (columns - 1), size.y() / (rows - 1)}; }  // extents [m]
  /// The point of a column and a row, in the shape's frame [m].
  Eigen::Vector3d point(int column, int row) const {
    return {
        cell().x() * column - 0.5 * size.x(), 0.5 * size.y() - cell().y() * row,
        heights[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)]};
  }
};

struct Box {
  Eigen::Vector3d size;  // full extents along x, y, z [m]
};
struct Sphere {
  double radius;  // [m]
};
struct Cylinder {  // along z
  double radius;   // [m]
  double length;   // [m]
};
struct Capsule {  // along z; length without the caps
  double radius;  // [m]
  double length;  // [m]
};
/// The geometry that contacts use for a mesh, in UrdfOptions and in scenarios. `automatic`: triangles where the mesh
/// never moves, else parts.
enum class MeshContact {
  automatic,
  hull,      // the convex hull of each object
  parts,     // convex parts of each object; its hull where that is nearly the same
  triangles  // the surface as it is, without an inside; only of links that never move
};
struct Mesh {
  std::shared_ptr<const MeshData> data;                  // null only if the model was loaded without its meshes
  std::shared_ptr<const std::vector<ConvexHull>> hulls;  // hulls or parts for contacts; null: contacts use triangles
  std::string file = {};                                 // as the model's file names it; empty: it contains the mesh
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();       // per axis; already applied to `data`
  std::shared_ptr<const Heightmap> heightmap = nullptr;  // contacts use it; `data` is its surface. null: none
  MeshContact contact = MeshContact::automatic;          // as the model's file states it
  int line = 0;                                          // of the URDF file; 0: the file doesn't contain this mesh
};
using Geometry = std::variant<Box, Sphere, Cylinder, Capsule, Mesh>;

/// Red, green, blue, opacity, each 0 to 1.
using Color = Eigen::Vector4f;

/// Squares of a second colour on a shape of a single colour, as on a chess board. They are aligned with the shape's
/// axes and begin at its centre.
struct Checker {
  Color color;
  double size = 1.0;  // of a square [m]
};

struct Shape {
  std::string name;  // as in the file; may be empty
  Geometry geometry;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // of the shape in its link's frame
  std::optional<Color> color;                              // visuals only; nullopt: the renderer's default
  std::optional<Checker> checker;                          // visuals only; not of meshes
  /// Visuals only, of meshes: on parts with texture coordinates and without a texture of their own, in place of
  /// colours.
  std::shared_ptr<const Texture> texture = nullptr;
};

/// The texture of a part of the shape's mesh: its own, else the shape's if the part has texture coordinates; else null.
const Texture* texture_of(const MeshPart& part, const Shape& shape);

/// The colour of a part of the shape's mesh: its own, unless that is a default and the shape states one; else the
/// shape's, else `otherwise`. White under the shape's texture.
Color color_of(const MeshPart& part, const Shape& shape, const Color& otherwise);

struct Inertial {
  double mass = 0.0;                                  // [kg]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();   // centre of mass in the link frame [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about the centre, along the link's axes [kg·m²]
};

/// A free joint constrains nothing: its link is the root, or a separate body that begins at the joint. Forward
/// kinematics leave that body there.
/// A track is a belt around its link (Choreonoid's pseudo continuous track). The link is fixed to its parent, as by a
/// fixed joint. Its surface runs about the axis, in the direction in which a wheel with that axis would turn.
enum class JointType { free, fixed, revolute, continuous, prismatic, track };

/// Makes a joint follow a leader joint: displacement = multiplier * (the leader's displacement) + offset.
struct Mimic {
  int leader = -1;  // id of a joint that follows no other
  double multiplier = 1.0;
  double offset = 0.0;  // [rad] or [m]
};

/// The joint between a link and its parent. The root link has one, too: free, or fixed to the world.
struct Joint {
  std::string name;  // empty for the root
  JointType type = JointType::free;
  int id = -1;                       // index into Model::joints; -1 for free and fixed
  std::optional<int> controller_id;  // the joint's id for controllers; -1: it has none; nullopt: `id`
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();  // joint frame in the parent link's frame; of the root: in
                                                             // the world, the default start of the body
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();           // unit vector in the joint frame
  double lower = -unlimited;                                 // [rad] or [m]
  double upper = unlimited;                                  // [rad] or [m]
  double start = 0.0;             // displacement at which a body starts by default [rad] or [m]
  double effort = unlimited;      // [N·m] or [N], magnitude
  double velocity = unlimited;    // [rad/s] or [m/s], magnitude
  double damping = 0.0;           // [N·m·s/rad] or [N·s/m]
  double friction = 0.0;          // [N·m] or [N]
  double spring_stiffness = 0.0;  // [N·m/rad] or [N/m]
  double spring_reference = 0.0;  // displacement at which the spring exerts no effort
  double armature = 0.0;          // inertia of the drive's rotor, as it acts at the joint [kg·m²] or [kg]
  double rotor_inertia = 0.0;     // of the rotor itself, before the gear; 0: the file has only `armature` [kg·m²]
  double gear_ratio = 1.0;        // turns of the rotor for a turn of the joint
  std::optional<Mimic> mimic;
  /// Of a file that states different limits of velocity for the two directions, as {-1, 2}; `velocity` is then the
  /// smaller magnitude, to which drives keep [rad/s] or [m/s].
  std::optional<std::array<double, 2>> velocity_range;
  int line = 0;  // of the model's file; 0: the file doesn't contain this joint
};

/// Contact properties of a link's surface. For a property that isn't given, the world's solver settings apply.
struct Surface {
  std::optional<double> friction;                     // coefficient, in the first direction or in all
  std::optional<double> second_friction;              // coefficient across `friction_direction`
  std::optional<Eigen::Vector3d> friction_direction;  // in the link frame, unit length
  std::optional<double> torsional_friction;           // torque against spinning on a point, over the normal force [m]
  std::optional<double> rolling_friction;             // torque against rolling, over the normal force [m]
  std::optional<double> stiffness;                    // of a contact [N/m]
  std::optional<double> damping;                      // of a contact [N·s/m]
  std::optional<double> min_depth;                    // penetration that contacts leave uncorrected [m]
  std::optional<double> max_velocity;                 // at which contacts separate shapes that overlap [m/s]
  std::optional<double> restitution;                  // ratio of the speeds after and before a bounce, 0 to 1
};

struct Link {
  std::string name;
  int parent = -1;  // index into Model::links; -1 for the root
  Joint joint;      // to the parent
  Inertial inertial;
  std::vector<Shape> visuals;
  std::vector<Shape> collisions;
  Surface surface;
  bool has_weight = true;          // gravity acts on the link
  bool collides_with_own = false;  // with other links of its body that have this flag
  std::string material = {};       // of its surface, for pairs of materials; empty: the file names none
  int line = 0;                    // of the model's file; 0: the file doesn't contain this link
};

/// A joint between two links of a model that its tree already connects: it closes a loop.
struct LoopJoint {
  enum class Type { fixed, revolute, prismatic, spherical };
  std::string name;
  Type type = Type::revolute;
  int link = 0;                                                   // index into Model::links
  int other_link = 0;                                             // likewise
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();        // of the joint in the link's frame
  Eigen::Isometry3d other_frame = Eigen::Isometry3d::Identity();  // of the joint in the other link's frame
  bool has_other_frame = true;                                    // false: it is where the joint is when a run begins
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();                // unit vector in the joint's frame
};

/// A posture that the model's file names.
struct Posture {
  std::string name;
  std::vector<double> q;                       // by joint id [rad] or [m]
  std::optional<Eigen::Isometry3d> root = {};  // of the root link in the world; nullopt: as Joint::origin
};

/// True if a joint of this type has a displacement.
bool is_movable(JointType type);

/// True if a joint of this type has an id: it is movable or a track.
bool has_id(JointType type);

/// True if the displacement of a joint of this type, or a track's speed, is in [m] and [m/s] and not in radians.
bool is_linear(JointType type);

/// "free", "fixed", "revolute", "continuous", "prismatic" or "track".
std::string_view type_name(JointType type);

struct Model {
  std::string name;
  std::vector<Link> links;  // depth-first; links[0] is the root
  std::vector<int> joints;  // by joint id: the index of the link it moves. In document order; of a .body those with a
                            // jointId first, in its order
  std::vector<Device> devices;
  std::vector<std::array<int, 2>> apart;  // pairs of links that never touch each other, the smaller index first, sorted
  std::vector<LoopJoint> loops;
  std::vector<Posture> postures;  // in document order
  std::string source_file;        // as the user named it; empty for a single shape
  std::string source_text;  // for recordings: the bytes of the file and of the model files that it includes; empty for
                            // a single shape
  Diagnostics report;       // the load report: repairs, warnings and notes in document order

  /// Index of the link, or -1.
  int find_link(std::string_view name) const;
  /// Index of the link whose joint (then, if there is none, whose link) has that name, or -1.
  int find_joint(std::string_view name) const;
  /// Index of the device, or -1.
  int find_device(std::string_view name) const;
  /// Mass of all links [kg].
  double mass() const;
};

/// A model with one link, which has the model's name and one shape that is both visual and collision shape.
/// `mass` [kg], spread evenly over the shape; 0 is allowed only if the body will be fixed.
Model single_shape_model(std::string name, const Geometry& geometry, double mass, std::optional<Color> color);

/// Mass, centre and inertia of a solid of even density, centred on and aligned with the shape's own frame.
/// The formulas are the textbook ones of solid bodies (J. L. Meriam, Dynamics, appendix on mass moments of inertia);
/// a capsule is a cylinder and two half spheres that share the mass by volume.
Inertial solid_inertial(const Geometry& geometry, double mass);

/// World poses of all links by forward kinematics.
/// `root`: pose of links[0]; `q`: by joint id, size Model::joints.size() [rad or m]. Returns one pose per link.
/// `free_pose`: returns the pose of a link behind a floating joint from the link's index and the joint's pose; by
/// default the link is at the joint's pose.
std::vector<Eigen::Isometry3d> forward_kinematics(
    const Model& model, const Eigen::Isometry3d& root, const std::vector<double>& q,
    const std::function<Eigen::Isometry3d(std::size_t, const Eigen::Isometry3d&)>& free_pose = {});

}  // namespace rehearse
