#include "mesh_file.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <exception>
#include <system_error>

#include "assimp_library.h"
#include "mesh_format.h"
#include "mesh_input.h"
#include "mesh_part.h"
#include "vrml_scene.h"

namespace rehearse {
namespace {

Diagnostics at(const std::filesystem::path& file, Diagnostics found) {
  for (Diagnostic& diagnostic : found) diagnostic.file = file.string();
  return found;
}

Result<MeshReading> read_in_format(MeshFormat format, MeshInput& input, const Eigen::Vector3d& scale,
                                   const MeshSelection& selection) {
  const bool is_whole = selection.node.empty() && selection.without.empty();
  const bool is_plain_stl = format == MeshFormat::stl && is_whole && is_binary_stl(input.bytes());
  if (format != MeshFormat::vrml && !is_plain_stl) return read_by_assimp(format, input, scale, selection);
  MeshReading reading;
  std::vector<MeshPart> parts = REHEARSE_TRY(is_plain_stl ? read_binary_stl(input.bytes(), scale, selection.z_up)
                                                          : read_vrml_parts(input, selection, scale, reading.warnings));
  reading.data.parts = std::move(parts);
  return reading;
}

void measure(MeshData& data) {
  Eigen::AlignedBox<float, 3> box;
  for (const MeshPart& part : data.parts) {
    for (const Eigen::Vector3f& vertex : part.vertices) box.extend(vertex);
  }
  data.lower = box.min().cast<double>();
  data.upper = box.max().cast<double>();
}

}  // namespace

Result<MeshReading> read_mesh(const std::filesystem::path& file, const Eigen::Vector3d& scale,
                              const MeshSelection& selection) {
  const Result<MeshFormat> format = mesh_format_of(file);
  if (!format) return at(file, format.errors());
  std::string bytes = REHEARSE_TRY(read_mesh_file(file));
  try {
    MeshInput input(file, std::move(bytes));
    if (auto checked = check_mesh_bytes(*format, input.bytes()); !checked) return at(file, checked.errors());
    Result<MeshReading> reading = read_in_format(*format, input, scale, selection);
    if (!reading) return at(file, reading.errors());
    std::error_code ignored;
    reading->data.file = std::filesystem::weakly_canonical(file, ignored).string();
    reading->data.digest = input.digest();
    measure(reading->data);
    return reading;
  } catch (const std::exception& problem) {
    return at(file, {error(fmt::format("assimp fails: {}", problem.what()))});
  }
}

}  // namespace rehearse
