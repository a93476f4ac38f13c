#include "mesh_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "obj_check.h"

namespace rehearse {
namespace {

constexpr std::size_t glb_head = 12;  // magic number, version, length [bytes]
constexpr std::string_view utf8_mark = "\xEF\xBB\xBF";
constexpr const char* known_formats = ".stl, .dae, .obj, .gltf, .glb and .wrl are read";

/// A little-endian number of four bytes.
std::uint32_t number_at(const std::string& bytes, std::size_t position) {
  std::uint32_t number = 0;
  for (std::size_t i = 4; i-- > 0;) number = number << 8 | static_cast<unsigned char>(bytes[position + i]);
  return number;
}

Result<void> check_stl(std::string& bytes) {
  if (!is_binary_stl(bytes)) return {};
  if (bytes.size() < stl_head) {
    return error(fmt::format("it is truncated: {} bytes, and the head of an STL alone has {}", bytes.size(), stl_head));
  }
  const std::size_t triangles = number_at(bytes, stl_head - 4);
  const std::size_t whole = stl_head + stl_triangle * triangles;
  if (bytes.size() < whole) {
    return error(
        fmt::format("it is truncated: {} triangles need {} bytes, and it has {}", triangles, whole, bytes.size()));
  }
  if (triangles == 0) return error("it has no triangles");
  if (triangles > max_mesh_triangles) {
    return error(fmt::format("it has {} triangles, more than {}", triangles, max_mesh_triangles));
  }
  bytes.resize(whole);
  return {};
}

Result<void> check_glb(const std::string& bytes) {
  if (!bytes.starts_with("glTF")) return error("it isn't a GLB: it doesn't begin with glTF");
  if (bytes.size() < glb_head || bytes.size() < number_at(bytes, 8)) {
    return error(fmt::format("it is truncated: {} bytes, fewer than its header states", bytes.size()));
  }
  return {};
}

/// assimp 5.2 never returns from a list of indices (<p>) that contains anything but whole numbers.
Result<void> check_dae(const std::string& bytes) {
  for (std::size_t at = bytes.find("<p"); at != std::string::npos; at = bytes.find("<p", at + 1)) {
    const std::size_t after_name = at + 2;
    if (after_name >= bytes.size() || std::string_view("> \t\r\n").find(bytes[after_name]) == std::string_view::npos) {
      continue;  // a different element
    }
    const std::size_t start = bytes.find('>', after_name);
    if (start == std::string::npos || bytes[start - 1] == '/') continue;
    const std::size_t end = bytes.find_first_not_of("0123456789+- \t\r\n", start + 1);
    if (end == std::string::npos || bytes[end] == '<') continue;
    Diagnostic problem = error("a list of indices <p> contains something else than whole numbers");
    problem.line =
        1 + static_cast<int>(std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
    return problem;
  }
  return {};
}

}  // namespace

Result<MeshFormat> mesh_format_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (extension == ".stl") return MeshFormat::stl;
  if (extension == ".dae") return MeshFormat::dae;
  if (extension == ".obj") return MeshFormat::obj;
  if (extension == ".gltf") return MeshFormat::gltf;
  if (extension == ".glb") return MeshFormat::glb;
  if (extension == ".wrl") return MeshFormat::vrml;
  if (extension.empty()) return error("its name has no extension that states its format", known_formats);
  return error(fmt::format("{} isn't a format that is read", extension), fmt::format("convert it; {}", known_formats));
}

Result<void> check_mesh_bytes(MeshFormat format, std::string& bytes) {
  if (bytes.empty()) return error("it is empty");
  if (bytes.starts_with("version https://git-lfs")) {
    return error("it is a git-lfs pointer, not the mesh it stands for", "run: git lfs pull");
  }
  switch (format) {
    case MeshFormat::stl: return check_stl(bytes);
    case MeshFormat::obj:
      if (bytes.starts_with(utf8_mark)) bytes.erase(0, utf8_mark.size());
      return check_obj(bytes);
    case MeshFormat::glb: return check_glb(bytes);
    case MeshFormat::dae: return check_dae(bytes);
    case MeshFormat::gltf:
    case MeshFormat::vrml: return {};  // a truncated file is a syntax error
  }
  REHEARSE_ASSERT(false, "a MeshFormat outside its enumeration");
}

bool is_binary_stl(const std::string& bytes) {
  const bool has_size = bytes.size() >= stl_head;
  if (has_size && bytes.size() == stl_head + stl_triangle * std::size_t{number_at(bytes, stl_head - 4)}) return true;
  const std::size_t start = bytes.find_first_not_of(" \t\r\n");
  const bool says_solid = start != std::string::npos && std::string_view(bytes).substr(start).starts_with("solid");
  return !says_solid || bytes.find('\0') != std::string::npos;
}

}  // namespace rehearse
