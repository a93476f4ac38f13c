// URDF: from the file to a Model, with nothing lost in silence.
//
// Two readers see every file. Our own strict pass knows lines, document order, sensors and colours, checks every number
// and mends what can be mended; what it has mended goes to urdfdom, and where the two then disagree about a link or a
// joint the load fails. A finding is one of: error (no model), repair (loaded after the named change; an error when
// strict), warning (loaded as written, probably not as meant), note (ignored, counted once per kind).
//
// - Joint ids count the revolute, continuous and prismatic joints in document order.
// - A root link called "world" is bolted to the world; any other root is free, if it has mass, else bolted too: a
//   repair. A single floating joint below an empty "world" says the same as no "world" at all, and is read so.
// - Another moving link without mass is an error, unless UrdfOptions::default_mass says what it weighs. It then has the
//   inertia of the solid box around its collision shapes (else its visible ones) and those of links fixed to it;
//   without shapes, of a ball of water (1000 kg/m³) about its origin. That is a repair.
// - An effort or velocity limit of 0 means "not given", as CAD exporters write it: unlimited.
// - Shapes are box, sphere, cylinder, capsule (radius, length without the caps) and mesh: STL, DAE, OBJ, glTF and GLB.
//   Where a mesh is looked for, and what its formats mean, is told in fixtures/README.md. A mesh that can't be had is an
//   error.
// - What <gazebo reference="LINK"> and PyBullet's <contact> say of touching a link goes into Link::surface, has_weight
//   and collides_with_own; fixtures/README.md lists the words.
// - Sensors are those of `<gazebo reference="LINK"><sensor name=".." type="..">`, in SDF's words: type imu,
//   accelerometer, gyroscope (or gyro), force_torque (reference: link, or joint = its child link), contact, camera,
//   multicamera, ray (or gpu_ray, lidar, gpu_lidar), and depth, depth_camera, rgbd or rgbd_camera (cameras that measure
//   depth); and `<sensor>` in `<robot>`, with the same words or, as the ROS wiki has it, with attributes. Read are
//   `<pose>` (x y z roll pitch yaw in the link frame), and of a camera `<update_rate>`, `<camera><pose>`,
//   `<horizontal_fov>`, `<image><width>, <height>`, `<clip><near>, <far>`, with SDF's defaults (1.047 rad, 320 x 240,
//   0.1 m, 100 m; 30 Hz). SDF's camera looks along +x with +z up; Device::pose is already turned to look along -z with
//   +y up.
//   Two children are ours: `<sensor><id>N</id>` is Device::id, and `<camera><vertical_fov>` [rad] may stand instead of
//   `<horizontal_fov>`.
// - What hostile files can cost is bounded by the limits below.
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
inline constexpr int max_urdf_errors = 20;   // told of one file

struct UrdfOptions {
  /// Skipping: no file but the model's own is read, and Mesh::data stays null. For a replay, which has the model's text
  /// and no meshes.
  enum class Meshes { load, skip };

  bool strict = false;                                         // repairs become errors
  std::map<std::string, std::filesystem::path> packages = {};  // directories of package://NAME, before any other place
  bool allow_missing_meshes = false;                           // a mesh that can't be had is left out, with a warning
  Meshes meshes = Meshes::load;
  bool fixed_root = false;                  // who loads it fixes its root link to the world, which so needs no mass
  bool kinematic = false;                   // it will move as it is commanded: none of its links needs mass
  std::optional<double> default_mass = {};  // of moving links that have no mass; above 0 [kg]
};

/// Reads and checks a URDF file. On failure: every error of the file (at most 20), in document order, each with its
/// line. On success Model::report holds the repairs, warnings and notes.
Result<Model> load_urdf(const std::filesystem::path& file, const UrdfOptions& options = {});

/// The same from text that is already in memory; `name` stands for the file in messages, in Model::source_file, and as
/// that which the paths of meshes are relative to.
Result<Model> parse_urdf(const std::string& text, const std::string& name, const UrdfOptions& options = {});

}  // namespace rehearse
