// URDF: loads a file into a Model and reports everything that it changes or ignores.
//
// Two readers read every file (only one reads the text of a recording). Rehearse's own strict reader handles lines,
// document order, sensors and colours, checks every number and repairs mistakes that have one sensible correction.
// urdfdom then parses the repaired document; if the two readers disagree about a link or a joint, the load fails. A
// finding is one of: error (no model), repair (loaded after the named change; an error when strict), warning (loaded as
// written, probably not as meant), note (ignored, counted once per kind).
//
// - Joint ids count the revolute, continuous and prismatic joints in document order.
// - A root link called "world" is fixed to the world. Any other root is free if it has mass; otherwise it is fixed,
//   too, which is a repair. A single floating joint below an empty "world" means the same as a file without "world".
//   The child of any other floating joint is a free body that begins at the joint.
// - A moving link without mass that isn't the root is an error, unless UrdfOptions::default_mass gives its mass. It
//   then has the inertia of the solid box around its collision shapes (else its visible ones) and those of links fixed
//   to it; without shapes, of a ball of water (1000 kg/m³) about its origin. This is a repair.
// - A moving link with mass but without inertia gets that of its shapes; one that isn't positive definite becomes the
//   nearest that is. Both are repairs, described in the page reference/urdf.md.
// - An effort or velocity limit of 0 means "not given", as CAD exporters write it: unlimited.
// - Shapes are box, sphere, cylinder, capsule (radius, length without the caps) and mesh: STL, DAE, OBJ, glTF and GLB.
//   The page reference/meshes.md describes the search for mesh files and the meaning of the formats. A mesh that is
//   missing or cannot be read is an error. UrdfOptions::contact determines the geometry that contacts use for a mesh,
//   else the file: PyBullet's <collision concave="yes"> means triangles, Drake's <drake:declare_convex/> in <mesh> the
//   hull. For a mesh that moves, contacts never use triangles, but convex parts.
// - The contact properties in <gazebo reference="LINK"> and in PyBullet's <contact> are read into Link::surface,
//   has_weight and collides_with_own; the page reference/urdf.md lists the elements.
// - Sensors are those of `<gazebo reference="LINK"><sensor name=".." type="..">`, with SDF's elements: type imu,
//   accelerometer, gyroscope (or gyro), force_torque (reference: link, or joint = its child link), contact, camera,
//   multicamera, ray (or gpu_ray, lidar, gpu_lidar), and depth, depth_camera, rgbd or rgbd_camera (cameras that measure
//   depth); and `<sensor>` in `<robot>`, with the same elements or with attributes as described in the ROS wiki. The
//   loader reads `<pose>` (x y z roll pitch yaw in the link frame), and of a camera `<update_rate>`, `<camera><pose>`,
//   `<horizontal_fov>`, `<image><width>, <height>`, `<clip><near>, <far>`, with SDF's defaults (1.047 rad, 320 x 240,
//   0.1 m, 100 m; 30 Hz), and `<image><anti_aliasing>` (smooth edges if above 1). SDF's camera looks along +x with +z
//   up; Device::pose is already turned to look along -z with +y up. A sensor or light that can't be read, or whose link
//   doesn't exist, is left out with a warning, even when strict. Extensions of Rehearse: `<sensor><id>N</id>` is
//   Device::id, `<camera><vertical_fov>` [rad] replaces
//   `<horizontal_fov>`, and `<camera><shadows>true</shadows>` draws the sun's shadows.
// - The limits below bound the time and memory that a hostile file can use.
#pragma once

#include <rehearse/model.h>

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace rehearse {

inline constexpr std::size_t max_urdf_bytes = std::size_t{64} << 20;  // 64 MiB
inline constexpr int max_urdf_depth = 90;        // elements within elements; the parser's own limit is 100
inline constexpr int max_urdf_tags = 250'000;    // in the file, comments included
inline constexpr int max_urdf_attributes = 100;  // of one tag
inline constexpr int max_urdf_links = 5'000;
inline constexpr int max_image_side = 8192;  // of a camera [pixels]
inline constexpr int max_urdf_errors = 20;   // reported per file

struct UrdfOptions {
  /// With `skip` only the model's own file is read, and Mesh::data stays null. For a replay, which has the model's text
  /// but no meshes.
  enum class Meshes { load, skip };

  bool strict = false;                                         // repairs become errors
  std::map<std::string, std::filesystem::path> packages = {};  // of package://NAME and ${NAME}, searched first
  bool compare = true;  // the result with urdfdom's; false: for the text of a recording, which was compared before
  bool allow_missing_meshes = false;   // a mesh that cannot be loaded is left out, with a warning
  bool mesh_z_up = false;              // glTF meshes have z up, against their standard: they aren't turned
  bool allow_unknown_devices = false;  // of a .body: elements of unknown types are left out, with a warning each
  bool allow_unsupported = false;      // of a MuJoCo model: what has no counterpart is left out, with a note each
  Meshes meshes = Meshes::load;
  MeshContact contact = MeshContact::automatic;  // of collision meshes; has precedence over the file
  bool fixed_root = false;                  // the caller fixes the root link to the world, so the root needs no mass
  bool kinematic = false;                   // the body will move as commanded, so none of its links needs mass
  std::optional<double> default_mass = {};  // of moving links that have no mass; above 0 [kg]
};

/// Reads and checks a URDF file. On failure: every error of the file (at most 20), in document order, each with its
/// line. On success Model::report contains the repairs, warnings and notes.
Result<Model> load_urdf(const std::filesystem::path& file, const UrdfOptions& options = {});

/// Reads and checks a text in memory, like load_urdf(). `name` replaces the file's name in messages, in
/// Model::source_file, and as the file that the paths of meshes are relative to.
Result<Model> parse_urdf(const std::string& text, const std::string& name, const UrdfOptions& options = {});

}  // namespace rehearse
