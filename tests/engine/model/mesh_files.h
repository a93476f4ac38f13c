// Small meshes for tests, and checks that apply to any mesh.
#pragma once

#include <rehearse/model.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "mesh/mesh_file.h"
#include "support/files.h"
#include "support/temporary_folder.h"

namespace rehearse {

inline const std::filesystem::path arm_meshes = FIXTURES_DIR "/models/mesh_arm/meshes";

using test::read_file;

/// The mesh; throws, and so fails the test, if it can't be loaded.
inline MeshReading reading_of(const std::filesystem::path& file, const Eigen::Vector3d& scale = {1, 1, 1}) {
  Result<MeshReading> reading = read_mesh(file, scale);
  if (!reading) throw std::runtime_error(to_string(reading.errors()));
  return *std::move(reading);
}

inline MeshData mesh_of(const std::filesystem::path& file, const Eigen::Vector3d& scale = {1, 1, 1}) {
  MeshReading reading = reading_of(file, scale);
  EXPECT_TRUE(reading.warnings.empty()) << reading.warnings.front();
  return std::move(reading.data);
}

/// The message of a file that must be refused.
inline std::string mesh_refusal(const std::filesystem::path& file) {
  const Result<MeshReading> reading = read_mesh(file, {1, 1, 1});
  if (reading) {
    ADD_FAILURE() << "it was accepted";
    return {};
  }
  return to_string(reading.errors());
}

struct Corner {
  Eigen::Vector3d position, normal;
};

/// Corners of all triangles in their order, three each.
inline std::vector<Corner> corners_of(const MeshData& mesh) {
  std::vector<Corner> corners;
  for (const MeshPart& part : mesh.parts) {
    EXPECT_EQ(part.normals.size(), part.vertices.size());
    for (const auto& triangle : part.triangles) {
      for (const std::uint32_t i : triangle) {
        corners.push_back({part.vertices.at(i).cast<double>(), part.normals.at(i).cast<double>()});
      }
    }
  }
  return corners;
}

/// The volume inside the triangles [m³]; positive if they are counter-clockwise seen from outside. By the divergence
/// theorem.
inline double volume_of(const MeshData& mesh) {
  const std::vector<Corner> corners = corners_of(mesh);
  double volume = 0.0;
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    volume += corners[i].position.dot(corners[i + 1].position.cross(corners[i + 2].position)) / 6.0;
  }
  return volume;
}

/// Checks that each normal has unit length and points to the outside according to the winding.
inline void expect_normals_outside(const MeshData& mesh) {
  const std::vector<Corner> corners = corners_of(mesh);
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const Eigen::Vector3d a = corners[i].position;
    const Eigen::Vector3d outside = (corners[i + 1].position - a).cross(corners[i + 2].position - a).normalized();
    for (std::size_t k = i; k < i + 3; ++k) {
      EXPECT_NEAR(corners[k].normal.norm(), 1.0, 1e-6);
      EXPECT_GT(corners[k].normal.dot(outside), 0.3) << "triangle " << i / 3;
    }
  }
}

template <class Number>
void put(std::string& bytes, Number number) {
  char raw[sizeof number];
  std::memcpy(raw, &number, sizeof number);
  bytes.append(raw, sizeof number);
}

/// A binary STL of the triangle (0, 0, 0), (1, 0, 0), (0, 1, 0), `count` times.
inline std::string stl(const std::string& head, const Eigen::Vector3f& normal, std::uint32_t count = 1) {
  std::string bytes = head;
  bytes.resize(80, ' ');
  put(bytes, count);
  for (std::uint32_t i = 0; i < count; ++i) {
    for (const float number : {normal.x(), normal.y(), normal.z(), 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) {
      put(bytes, number);
    }
    put(bytes, std::uint16_t{0x1234});
  }
  return bytes;
}

/// A COLLADA file of one triangle (0, 0, 0), (1, 0, 0), (0, 1, 0), and a line, of which `nodes` instances "tri".
inline std::string collada(const std::string& asset, const std::string& nodes) {
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)" +
         asset + R"(</asset>
<library_cameras><camera id="eye"><optics><technique_common><perspective><xfov>40</xfov><znear>0.1</znear><zfar>9</zfar>
</perspective></technique_common></optics></camera></library_cameras>
<library_lights><light id="sun"><technique_common><directional><color>1 1 1</color></directional></technique_common>
</light></library_lights>
<library_geometries><geometry id="tri"><mesh><source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION"
source="#p"/></vertices><triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
<lines count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2</p></lines></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">)" +
         nodes + R"(<node><instance_camera url="#eye"/></node><node><instance_light url="#sun"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

inline constexpr const char* square_obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

}  // namespace rehearse
