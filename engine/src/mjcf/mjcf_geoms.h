// Geoms of a MuJoCo model: their shapes and masses, with the meshes and materials of <asset>.
#pragma once

#include <rehearse/model.h>

#include <map>
#include <optional>
#include <string>

#include "mjcf_elements.h"
#include "urdf/urdf_meshes.h"

namespace rehearse::mjcf {

struct Geom {
  Shape shape;        // in the body's frame
  Inertial inertial;  // in the body's frame
  bool is_seen = true;
  int contype = 1;
  int conaffinity = 1;
  std::optional<double> friction, torsional_friction, rolling_friction;  // as stated

  bool touches() const { return contype != 0 || conaffinity != 0; }
};

class Geoms {
 public:
  Geoms(Files& files, const Classes& classes, const Compiler& compiler);

  /// Reads <asset>.
  void read_assets();
  /// Nullopt with an error, or if it is left out. `is_of_world`: of <worldbody> itself, where planes are.
  std::optional<Geom> read(const Element& geom, bool is_of_world);
  /// Sets the hulls of the collision shapes.
  void prepare_contacts(Model& model) { meshes_.prepare_contacts(model); }

 private:
  /// Of a solid of density 1: its volume as its mass.
  struct MeshAsset {
    const XMLElement* xml = nullptr;
    bool is_read = false;
    std::optional<Mesh> mesh;
    Inertial solid;                                           // in the mesh's own frame
    Eigen::Isometry3d place = Eigen::Isometry3d::Identity();  // of the mesh's own frame in the geom's
  };

  MeshAsset* find_mesh(const Element& geom);
  void read_mesh(const std::string& name, MeshAsset& asset);
  std::optional<Mesh> read_vertices(const Element& element, const Eigen::Vector3d& scale);
  void find_solid(const std::string& name, const Element& element, MeshAsset& asset);
  std::optional<Geometry> read_form(const Element& geom, std::string_view type, Geom& read);
  std::optional<Color> color_of(const Element& element);
  void give_mass(const Element& element, const Inertial& solid, Geom& geom);
  void read_friction(const Element& element, Geom& geom);

  Files& files_;
  const Classes& classes_;
  const Compiler& compiler_;
  urdf::Meshes meshes_;
  std::map<std::string, MeshAsset> mesh_assets_;
  std::map<std::string, const XMLElement*> materials_;
};

}  // namespace rehearse::mjcf
