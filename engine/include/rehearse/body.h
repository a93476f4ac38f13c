// Choreonoid's body files (.body, .yaml, .yml, and .wrl with a Humanoid of OpenHRP): loads a file into a Model and
// reports everything that it changes or ignores; and model files of any format.
//
// The loader reads the format versions 1.0 to 2.0 with both spellings of keys (jointType, joint_type). Defaults and
// meanings are those of Choreonoid's loader: angles are in degrees unless angleUnit is radian, a link without any mass
// has 1 kg and the inertia 1 1 1, joints without a type are fixed, element mappings are visited by the alphabet.
//
// - Model::joints has the joints with a jointId first, in its order, then the remaining joints in the order of links.
//   Joint::controller_id is the jointId; controllers see gaps and fixed joints with an id as in Choreonoid.
// - Model files that a .body includes (sub-bodies, YAML resources) are part of Model::source_text.
// - Findings are those of urdf.h: error, repair, warning, note. A key without effect here is a note; a key that
//   resembles a known key is a warning. A node of an unknown type is an error, unless it is optional or
//   UrdfOptions::allow_unknown_devices; its elements are read all the same.
// - A file with modelFile adds its rules of collision to the body of that file.
// - Mesh resources are the formats of urdf.h and VRML97 (.wrl).
#pragma once

#include <rehearse/model.h>
#include <rehearse/urdf.h>

#include <filesystem>
#include <string>

namespace rehearse {

inline constexpr std::size_t max_body_bytes = std::size_t{64} << 20;  // 64 MiB, of each file
inline constexpr int max_body_links = 5'000;
inline constexpr int max_body_elements = 500'000;  // visited; the elements of an alias count at each use
inline constexpr int max_body_depth = 60;          // elements within elements, files within files

/// Reads and checks a .body file. On failure: the errors of the file and of the files that it includes, each with its
/// place, at most 20 of each file. The options have the same meaning as for a URDF file; the package SHARE is the
/// directory that ${SHARE} stands for.
Result<Model> load_body(const std::filesystem::path& file, const UrdfOptions& options = {});

/// Reads and checks a text in memory: the text of a file, or a Model::source_text. `name` replaces the file's name in
/// messages, in Model::source_file, and as the file that paths are relative to.
Result<Model> parse_body(const std::string& text, const std::string& name, const UrdfOptions& options = {});

/// True if the file is a model: a .urdf or .body by its name, a .yaml, .yml, .wrl or .xml by its content.
bool is_model_file(const std::filesystem::path& file);

/// load_body() for a file whose name ends with .body, .yaml, .yml or .wrl, parse_mjcf() if the root element is
/// <mujoco>, else load_urdf().
Result<Model> load_model(const std::filesystem::path& file, const UrdfOptions& options = {});

/// parse_body() for a name with one of these endings, parse_mjcf() if the root element is <mujoco>, else parse_urdf().
Result<Model> parse_model(const std::string& text, const std::string& name, const UrdfOptions& options = {});

}  // namespace rehearse
