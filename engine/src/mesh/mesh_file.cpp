#include "mesh_file.h"

#include <assimp/BaseImporter.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <exception>
#include <sstream>
#include <system_error>

#include "mesh_format.h"
#include "mesh_input.h"
#include "mesh_materials.h"
#include "mesh_scene.h"
#include "vrml_scene.h"

namespace rehearse {
namespace {

Diagnostics at(const std::filesystem::path& file, Diagnostics found) {
  for (Diagnostic& diagnostic : found) diagnostic.file = file.string();
  return found;
}

bool reads(const Assimp::BaseImporter& importer, const std::string& extension) {
  std::istringstream words(importer.GetInfo()->mFileExtensions);
  for (std::string word; words >> word;) {
    if (word == extension) return true;
  }
  return false;
}

/// assimp tries all its other readers on a file that the right reader refuses; their results are meaningless.
void keep_only(Assimp::Importer& importer, MeshFormat format) {
  constexpr const char* extensions[] = {"stl", "dae", "obj", "gltf", "glb"};
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    Assimp::BaseImporter* reader = importer.GetImporter(i);
    if (reads(*reader, extensions[static_cast<int>(format)])) continue;
    importer.UnregisterLoader(reader);
    delete reader;
  }
}

/// The reason why assimp refuses the file. assimp's message may contain the absolute path, which is removed.
std::string refusal(const Assimp::Importer& importer, const std::filesystem::path& file) {
  std::string reason = importer.GetErrorString();
  const std::string path = file.string();
  for (std::size_t i = reason.find(path); i != std::string::npos; i = reason.find(path, i)) {
    reason.replace(i, path.size(), file.filename().string());
  }
  return "assimp reports: " + reason;
}

/// The scene is owned by the importer; if it is null, see the importer's GetErrorString(). `by_name`: nodes of a DAE
/// have their names instead of their ids.
const aiScene* import(Assimp::Importer& importer, MeshFormat format, MeshInput& input, bool by_name = false) {
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, by_name);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  importer.SetIOHandler(&input);
  keep_only(importer, format);
  const aiScene* scene = importer.ReadFile(input.file().string(), aiProcess_Triangulate | aiProcess_SortByPType);
  importer.SetIOHandler(nullptr);  // the importer would delete it
  return scene;
}

/// The missing files, each once. assimp also looks for an OBJ's MTL by the OBJ's name if the named MTL is missing.
void warn_of_missing(MeshFormat format, const MeshInput& input, std::vector<std::string>& warnings) {
  const std::vector<std::string>& missing = input.missing();
  const std::string guess = format == MeshFormat::obj ? input.file().stem().string() + ".mtl" : "";
  for (auto name = missing.begin(); name != missing.end(); ++name) {
    if (std::find(missing.begin(), name, *name) != name || (name != missing.begin() && *name == guess)) continue;
    warnings.push_back(fmt::format("its file '{}' can't be read", *name));
  }
}

Result<MeshReading> convert(const aiScene& scene, MeshFormat format, MeshInput& input, const Eigen::Vector3d& scale,
                            const MeshSelection& selection) {
  MeshReading reading;
  warn_of_missing(format, input, reading.warnings);
  const MeshMaterials materials(scene, format, input, reading.warnings);
  Result<std::vector<MeshPart>> parts = read_parts(scene, format, materials, scale, selection);
  if (!parts) return parts.errors();
  reading.data.parts = *std::move(parts);
  return reading;
}

Result<MeshReading> read_by_assimp(MeshFormat format, MeshInput& input, const Eigen::Vector3d& scale,
                                   const MeshSelection& selection) {
  if (format == MeshFormat::dae && !selection.node.empty()) {  // a name as in Choreonoid's head, else an id as before
    Assimp::Importer by_name;
    const aiScene* named = import(by_name, format, input, true);
    if (named != nullptr && has_node(*named, selection.node)) return convert(*named, format, input, scale, selection);
  }
  Assimp::Importer importer;
  const aiScene* scene = import(importer, format, input);
  if (scene == nullptr) return error(refusal(importer, input.file()));
  return convert(*scene, format, input, scale, selection);
}

Result<MeshReading> read(MeshFormat format, MeshInput& input, const Eigen::Vector3d& scale,
                         const MeshSelection& selection) {
  const bool is_whole = selection.node.empty() && selection.without.empty();
  const bool is_plain_stl = format == MeshFormat::stl && is_whole && is_binary_stl(input.bytes());
  if (format != MeshFormat::vrml && !is_plain_stl) return read_by_assimp(format, input, scale, selection);
  MeshReading reading;
  Result<std::vector<MeshPart>> parts = is_plain_stl ? read_binary_stl(input.bytes(), scale, selection.z_up)
                                                     : read_vrml_parts(input, selection, scale, reading.warnings);
  if (!parts) return parts.errors();
  reading.data.parts = *std::move(parts);
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
  Result<std::string> bytes = read_mesh_file(file);
  if (!bytes) return bytes.errors();
  try {
    MeshInput input(file, *std::move(bytes));
    if (auto checked = check_mesh_bytes(*format, input.bytes()); !checked) return at(file, checked.errors());
    Result<MeshReading> reading = read(*format, input, scale, selection);
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
