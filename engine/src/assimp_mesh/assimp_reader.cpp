// The function of this library (mesh/assimp_library.h).
#include <assimp/BaseImporter.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh/assimp_library.h"
#include "mesh/mesh_input.h"
#include "mesh_materials.h"
#include "mesh_scene.h"

namespace rehearse {
namespace {

/// A stream of bytes in memory. It is in the list of open streams during its lifetime.
class Stream : public Assimp::MemoryIOStream {
 public:
  Stream(const std::string& bytes, std::vector<Assimp::IOStream*>& open)
      : MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), open_(open) {
    open_.push_back(this);
  }
  ~Stream() override { open_.erase(std::ranges::find(open_, this)); }

 private:
  std::vector<Assimp::IOStream*>& open_;
};

/// The only files that assimp may open.
class MeshFiles : public Assimp::IOSystem {
 public:
  explicit MeshFiles(MeshInput& input) : input_(input) {}
  ~MeshFiles() override {
    while (!open_.empty()) delete open_.back();
  }
  MeshFiles(const MeshFiles&) = delete;
  MeshFiles& operator=(const MeshFiles&) = delete;

  bool Exists(const char* path) const override { return input_.exists(path); }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* path, const char* mode) override {
    if (std::string_view(mode).find_first_of("wa+") != std::string_view::npos) return nullptr;
    const std::string* bytes = input_.open(path);
    return bytes == nullptr ? nullptr : new Stream(*bytes, open_);
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  MeshInput& input_;
  std::vector<Assimp::IOStream*> open_;  // assimp closes a stream, deletes it or, when it fails, forgets it
};

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
const aiScene* import(Assimp::Importer& importer, MeshFormat format, const std::filesystem::path& file,
                      MeshFiles& files, bool by_name = false) {
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, by_name);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  importer.SetIOHandler(&files);
  keep_only(importer, format);
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_SortByPType);
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
  std::vector<MeshPart> parts = REHEARSE_TRY(read_parts(scene, format, materials, scale, selection));
  reading.data.parts = std::move(parts);
  return reading;
}

Result<MeshReading> import_mesh(MeshFormat format, MeshInput& input, const Eigen::Vector3d& scale,
                                const MeshSelection& selection) {
  MeshFiles files(input);
  if (format == MeshFormat::dae && !selection.node.empty()) {  // a name as in Choreonoid's head, else an id as before
    Assimp::Importer by_name;
    const aiScene* named = import(by_name, format, input.file(), files, true);
    if (named != nullptr && has_node(*named, selection.node)) return convert(*named, format, input, scale, selection);
  }
  Assimp::Importer importer;
  const aiScene* scene = import(importer, format, input.file(), files);
  if (scene == nullptr) return error(refusal(importer, input.file()));
  return convert(*scene, format, input, scale, selection);
}

}  // namespace
}  // namespace rehearse

bool rehearse_read_by_assimp(rehearse::MeshFormat format, rehearse::MeshInput& input, const Eigen::Vector3d& scale,
                             const rehearse::MeshSelection& selection, rehearse::MeshReading& reading,
                             rehearse::Diagnostics& errors) {
  auto read = rehearse::import_mesh(format, input, scale, selection);
  if (!read) {
    errors = read.errors();
    return false;
  }
  reading = *std::move(read);
  return true;
}
