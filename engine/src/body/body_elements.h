// Reads the elements of a link: nodes within nodes, each with a transform.
#pragma once

#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "body_draft.h"
#include "mesh/mesh_file.h"
#include "mesh/polygon_mesh.h"

namespace rehearse::body {

class ElementReader {
 public:
  ElementReader(Files& files, Document& document, Contents& contents)
      : files_(files), main_(document), contents_(contents) {}

  /// The document and the nodes that contain a node.
  struct Place {
    Document* document;  // that contains it
    Eigen::Affine3d transform = Eigen::Affine3d::Identity();
    bool is_visual = false;     // below a Visual
    bool is_collision = false;  // below a Collision
    int depth = 0;
  };

  /// The value of `elements`: a list of nodes, one node, or a mapping of a node for each type.
  void read_all(const YamlNode& elements, const Place& place);

 private:
  void note_replaced(const YamlNode& elements);
  void read_typed(const YamlNode& node, const Place& place);
  void read(const std::string& type, const YamlNode& node, const Place& place);
  bool read_known(const std::string& type, Mapping& keys, const Place& place);
  void refuse(const std::string& type, Mapping& keys, const Place& place);
  void read_below(Mapping& keys, const Place& place);
  void read_rigid_body(Mapping& keys, const Place& place);
  void read_visual_or_collision(const std::string& type, Mapping& keys, Place place);

  // body_shapes.cpp
  void read_shape(Mapping& keys, const Place& place);
  std::optional<Color> read_appearance(const YamlNode& node, Document& document);
  void add_shape(const YamlNode& at, Shape shape, const Place& place);
  void add_mesh(const YamlNode& at, PolygonMesh polygons, Shape shape, const Eigen::Affine3d& transform,
                const Place& place);

  // body_resources.cpp
  void read_resource(Mapping& keys, const Place& place);
  void read_yaml(const YamlNode& at, const NamedFile& file, const std::string& fragment, const Place& place);
  void read_mesh(const YamlNode& at, const std::string& uri, const NamedFile& file, const std::string& fragment,
                 const Eigen::Affine3d& transform, Shape shape, const Place& place);
  const std::set<std::string>& fragments_of(const std::string& uri);

  // body_devices.cpp
  bool read_device(const std::string& type, Mapping& keys, const Place& place);

  Files& files_;
  Document& main_;
  Contents& contents_;
  std::map<std::string, std::set<std::string>> fragments_;  // by uri: names of nodes that the body takes out of it
  bool knows_fragments_ = false;
};

/// One of the solid geometries that a Shape may have, before it is scaled.
struct SolidShape {
  std::optional<Geometry> geometry;  // along z, and `pose` turns it to y; nothing: only polygons
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  PolygonMesh polygons;
};

/// Reads a geometry other than a Resource. An error, and nothing, if it is wrong or not known.
std::optional<SolidShape> read_geometry(const std::string& type, Mapping& keys);

/// The geometry under a linear map that scales it along its axes: turned by a rotation, which replaces `linear`.
/// Nothing if the result is not a geometry of this type.
std::optional<Geometry> scaled(const Geometry& geometry, Eigen::Matrix3d& linear);

/// Splits a linear map without shear into rotation and scale; nothing if it shears. The scale may be negative.
bool split(const Eigen::Matrix3d& linear, Eigen::Matrix3d& rotation, Eigen::Vector3d& scale);

}  // namespace rehearse::body
