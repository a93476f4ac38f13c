// URDF: from the file to a Model, with nothing lost in silence.
#pragma once

#include <rehearse/model.h>

#include <filesystem>
#include <string>

namespace rehearse {

struct UrdfOptions {
  bool strict = false;  // repairs become errors
};

/// Reads and checks a URDF file. On failure: every error of the file (at most 20), in document order, each with its line.
/// On success Model::report holds the repairs, warnings and notes.
Result<Model> load_urdf(const std::filesystem::path& file, const UrdfOptions& options = {});

/// The same from text that is already in memory; `name` stands for the file in messages and in Model::source_file.
Result<Model> parse_urdf(const std::string& text, const std::string& name, const UrdfOptions& options = {});

}  // namespace rehearse
