// Model: one robot or object as its author described it. Immutable after loading.
//
// A model comes from a URDF file (urdf.h) or from a single shape (single_shape_model). It knows nothing of where it
// stands or how it moves: that is World's. Units are SI, angles [rad]. Links stand in depth-first order, children of a
// link in the document order of their joints, so a parent always comes before its children and links[0] is the root. A
// link frame is its joint's frame after the joint's motion: T_world_link = T_world_parent * origin * motion(axis, q).
#pragma once

#include <rehearse/diagnostic.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rehearse {

// Meshes: the triangles of a model's shapes, as they were read from files. Immutable, and shared by all shapes, models
// and worlds that use the same file at the same scale.

/// A picture that is laid on a mesh. Pixels are red, green, blue, opacity, row by row, the top row first.
struct Texture {
  int width = 0;   // [pixels]
  int height = 0;  // [pixels]
  std::vector<std::uint8_t> rgba;
  std::string file;  // where it comes from, for messages
};

/// Triangles of one material. Counter-clockwise seen from outside.
struct MeshPart {
  int object = 0;                         // parts of one object of the file share the number; from 0, ascending
  std::vector<Eigen::Vector3f> vertices;  // in the shape's frame, scale applied [m]
  std::vector<Eigen::Vector3f> normals;   // one a vertex, unit length
  std::vector<Eigen::Vector2f> texture_coordinates;     // one a vertex, (0, 0) is the picture's lower left; empty: none
  std::vector<std::array<std::uint32_t, 3>> triangles;  // indices of vertices
  std::optional<Eigen::Vector4f> color;    // the file's own: red, green, blue, opacity, 0 to 1; none: the shape's
  std::shared_ptr<const Texture> texture;  // null: none. Its pixels are multiplied with the colour
};

struct MeshData {
  std::string file;    // its real path
  std::string digest;  // of its bytes, then of the files it names (XXH3, 16 hexadecimal digits)
  std::vector<MeshPart> parts;
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();  // corners of the box around all vertices, along the axes [m]
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();

  std::size_t triangle_count() const {
    std::size_t count = 0;
    for (const MeshPart& part : parts) count += part.triangles.size();
    return count;
  }
};

/// What contact takes an object of a mesh for.
struct ConvexHull {
  std::vector<Eigen::Vector3d> vertices;  // in the shape's frame [m]
  std::vector<std::vector<int>> faces;    // indices of vertices, flat polygons, counter-clockwise seen from outside
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
struct Mesh {
  std::shared_ptr<const MeshData> data;                  // null only if the model was loaded without its meshes
  std::shared_ptr<const std::vector<ConvexHull>> hulls;  // of a collision shape, one an object; null: a visual
  std::string file = {};                                 // as the model's file names it
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();       // per axis; `data` has it already
};
using Geometry = std::variant<Box, Sphere, Cylinder, Capsule, Mesh>;

/// Red, green, blue, opacity, each 0 to 1.
using Color = Eigen::Vector4f;

/// Squares of a second colour on a shape of a single colour, as on a chess board: about the shape's own axes, from its
/// centre.
struct Checker {
  Color color;
  double size = 1.0;  // of a square [m]
};

struct Shape {
  std::string name;  // as in the file; may be empty
  Geometry geometry;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // of the shape in its link's frame
  std::optional<Color> color;                              // visuals only; none: the renderer's default
  std::optional<Checker> checker;                          // visuals only; not of meshes
};

struct Inertial {
  double mass = 0.0;                                  // [kg]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();   // centre of mass in the link frame [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about the centre, along the link's axes [kg·m²]
};

/// A track is a belt around its link (Choreonoid's pseudo continuous track): the link is as firm on its parent as
/// behind a fixed joint, and its surface runs about the axis, in the sense in which a wheel with that axis would turn.
enum class JointType { free, fixed, revolute, continuous, prismatic, track };

inline constexpr double unlimited = std::numeric_limits<double>::infinity();

/// Says that a joint follows another one: displacement = multiplier * (the leader's displacement) + offset.
struct Mimic {
  int leader = -1;  // id of a joint that follows no other
  double multiplier = 1.0;
  double offset = 0.0;  // [rad] or [m]
};

/// What joins a link to its parent; the root link has one too, free or fixed to the world.
struct Joint {
  std::string name;  // empty for the root
  JointType type = JointType::free;
  int id = -1;  // document order among the movable joints and tracks of the file; -1 for free and fixed
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();  // joint frame in the parent link's frame
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();           // unit vector in the joint frame
  double lower = -unlimited;                                 // [rad] or [m]
  double upper = unlimited;                                  // [rad] or [m]
  double effort = unlimited;                                 // [N·m] or [N], magnitude
  double velocity = unlimited;                               // [rad/s] or [m/s], magnitude
  double damping = 0.0;                                      // [N·m·s/rad] or [N·s/m]
  double friction = 0.0;                                     // [N·m] or [N]
  std::optional<Mimic> mimic;
  int line = 0;  // where the file states it; 0: it doesn't
};

/// What a link is to those who touch it. What isn't given is as the world's solver has it.
struct Surface {
  std::optional<double> friction;                     // coefficient, in the first direction or in all
  std::optional<double> second_friction;              // coefficient across `friction_direction`
  std::optional<Eigen::Vector3d> friction_direction;  // in the link frame, unit length
  std::optional<double> stiffness;                    // of a contact [N/m]
  std::optional<double> damping;                      // of a contact [N·s/m]
  std::optional<double> min_depth;                    // that contacts keep [m]
  std::optional<double> max_velocity;                 // at which contacts push apart what overlaps [m/s]
  std::optional<double> restitution;                  // share of the speed that a bounce keeps, 0 to 1
};

struct Link {
  std::string name;
  int parent = -1;  // index into Model::links; -1 for the root
  Joint joint;      // to the parent
  Inertial inertial;
  std::vector<Shape> visuals;
  std::vector<Shape> collisions;
  Surface surface;
  bool has_weight = true;          // gravity pulls at it
  bool collides_with_own = false;  // with other such links of its body
  int line = 0;                    // where the file states it; 0: it doesn't
};

struct ForceSensor {};
struct Gyro {};
struct Accelerometer {};
struct Imu {};

/// A pinhole camera. It looks along its device frame's -z with +y up (the convention of OpenGL and of Choreonoid).
struct Camera {
  int width = 640;                  // [pixels]
  int height = 480;                 // [pixels]
  double field_of_view = 0.785398;  // [rad]: vertical if width >= height, else horizontal
  double near_clip = 0.04;          // [m]
  double far_clip = 200.0;          // [m]
  double frame_rate = 30.0;         // [Hz] of simulated time
  bool depth = false;               // also measures depth (a RangeCamera)
};

/// One direction of a range sensor's grid: beams from the lower to the upper angle, both included, evenly apart. A
/// single beam has both angles alike.
struct Sweep {
  double lower = 0.0;  // [rad]
  double upper = 0.0;  // [rad]
  int samples = 1;

  double step() const { return samples > 1 ? (upper - lower) / (samples - 1) : 0.0; }  // [rad]
  double angle(int sample) const { return lower + sample * step(); }                   // [rad]
};

/// A laser scanner: a grid of beams from its origin. Straight ahead is its device frame's -z, with +y up; yaw turns
/// about +y, left is positive; then pitch about +x, up is positive (the convention of Choreonoid). Beams are numbered
/// row by row from the lowest pitch, within a row from the lowest yaw: the right-most comes first.
struct RangeSensor {
  Sweep yaw;
  Sweep pitch;
  double min_distance = 0.1;   // what is nearer is looked through [m]
  double max_distance = 10.0;  // what is beyond isn't seen [m]
  double scan_rate = 10.0;     // [Hz] of simulated time

  int beams() const { return yaw.samples * pitch.samples; }
};

/// What makes a light a spot. Angles are measured from the direction.
struct LightCone {
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();  // in the device frame; of any length but 0
  float beam_width = 1.570796f;                           // within it the light is at full strength [rad]
  float cut_off_angle = 0.785398f;                        // beyond it there is none [rad]
  float cut_off_exponent = 1.0f;                          // kept for controllers; no picture depends on it
};

/// A lamp that shines into pictures, from its device frame's origin. At a distance d [m] its light is divided by
/// constant + linear * d + quadratic * d². The figures are float because a controller's are.
///
/// Its state as numbers is on (1 or 0), red, green, blue, intensity, constant, linear, quadratic; a spot's goes on with
/// direction x, y, z, beam width, cut-off angle, cut-off exponent.
struct Light {
  bool on = true;
  Eigen::Vector3f color = Eigen::Vector3f::Ones();  // red, green, blue, 0 to 1
  float intensity = 1.0f;                           // times the colour: its strength
  float constant = 1.0f;
  float linear = 0.0f;       // [1/m]
  float quadratic = 0.0f;    // [1/m²]
  double range = unlimited;  // beyond it there is no light [m]
  std::optional<LightCone> cone;  // none: it shines in all directions
};

/// Feels whether its link touches anything. In each step it measures four numbers: at how many points, and the force
/// on the link at all of them, x, y, z in the device frame [N].
struct ContactSensor {
  int collision = -1;  // the one shape that feels, an index into the link's collisions; -1: all
};

using DeviceKind = std::variant<ForceSensor, Gyro, Accelerometer, Imu, Camera, RangeSensor, Light, ContactSensor>;

/// A sensor or light fixed to a link. Models list them in document order, stably sorted by link.
struct Device {
  std::string name;
  int id = -1;                                             // as in the file; -1 if it gives none
  int link = 0;                                            // index into Model::links
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // device frame in the link frame; see the kind for its axes
  DeviceKind kind;
  int line = 0;  // where the file states it; 0: it doesn't
};

/// True if a joint of this type has a displacement.
bool is_movable(JointType type);

/// True if it has an id: it is movable or a track.
bool has_id(JointType type);

/// True if its displacement, or a track's speed, is in [m] and [m/s] and not in radians.
bool is_linear(JointType type);

/// "free", "fixed", "revolute", "continuous", "prismatic" or "track".
std::string_view type_name(JointType type);

/// "ForceSensor", "RateGyroSensor", "AccelerationSensor", "Imu", "Camera", "RangeCamera", "RangeSensor", "PointLight",
/// "SpotLight" or "ContactSensor".
std::string_view type_name(const Device& device);

/// `light` with the state of these numbers; as it is if they are too few.
Light light_of_state(Light light, const std::vector<double>& values);

/// How many values a device measures in each step (see DeviceReading); 0 for those that measure at times of their own,
/// or nothing.
int value_count(const Device& device);

/// Unit vectors along the beams, in the sensor's device frame and in the order of their numbers.
std::vector<Eigen::Vector3d> beam_directions(const RangeSensor& sensor);

struct Model {
  std::string name;
  std::vector<Link> links;  // depth-first; links[0] is the root
  std::vector<int> joints;  // by joint id: the index of the link it moves
  std::vector<Device> devices;
  std::string source_file;  // as the user named it; empty for a single shape
  std::string source_text;  // the file's bytes, for the record; empty for a single shape
  Diagnostics report;       // the load report: repairs, warnings and notes in document order

  /// Index of the link, or -1.
  int find_link(std::string_view name) const;
  /// Index of the link whose joint (then, if there is none, whose link) has that name, or -1.
  int find_joint(std::string_view name) const;
  /// Index of the device, or -1.
  int find_device(std::string_view name) const;
  /// Of all links [kg].
  double mass() const;
};

/// An object of one link named like the model, one shape for looks and contact.
/// `mass` [kg], spread evenly over the shape; 0 is allowed only if the body will be fixed.
Model single_shape_model(std::string name, const Geometry& geometry, double mass, std::optional<Color> color);

/// Mass, centre and inertia of a solid of even density, centred on and aligned with the shape's own frame.
/// The formulas are the textbook ones of solid bodies (J. L. Meriam, Dynamics, appendix on mass moments of inertia);
/// a capsule is a cylinder and two half spheres that share the mass by volume.
Inertial solid_inertial(const Geometry& geometry, double mass);

/// World poses of all links by forward kinematics.
/// `root`: pose of links[0]; `q`: by joint id, size Model::joints.size() [rad or m]. Returns one pose a link.
std::vector<Eigen::Isometry3d> forward_kinematics(const Model& model, const Eigen::Isometry3d& root,
                                                  const std::vector<double>& q);

}  // namespace rehearse
