// The files that a MuJoCo model consists of: itself and those that it includes.
#pragma once

#include <rehearse/mjcf.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/text_bundle.h"
#include "urdf/urdf_findings.h"

namespace tinyxml2 {
class XMLDocument;
class XMLElement;
}  // namespace tinyxml2

namespace rehearse::mjcf {

using tinyxml2::XMLElement;

inline constexpr int most_includes = 100;
inline constexpr int deepest_include = 10;

/// Reads the files, each once, and collects their text and their findings.
class Files {
 public:
  /// `text`: of the main file, or a bundle().
  Files(const std::string& text, const std::string& name, const UrdfOptions& options);
  Files(const Files&) = delete;
  Files& operator=(const Files&) = delete;
  ~Files();

  /// <mujoco> of the main file; null if there is an error.
  const XMLElement* root() const { return root_; }
  const UrdfOptions& options() const { return options_; }
  bool skips_meshes() const { return options_.meshes == UrdfOptions::Meshes::skip; }
  const std::string& name() const { return name_; }

  /// The children of an element in document order, those of an included file in place of its <include>.
  std::vector<const XMLElement*> children(const XMLElement& parent) const;
  /// The children of all elements of that name in <mujoco>.
  std::vector<const XMLElement*> in_section(std::string_view name) const;

  /// The findings of the file that contains the element.
  urdf::Findings& findings(const XMLElement& at);
  urdf::Findings& main_findings() { return documents_.front()->findings; }
  /// The element's line in the main file; 0 if an included file contains it.
  int line_in_main(const XMLElement& at) const;

  void error(const XMLElement& at, std::string message, std::string hint = {});
  void warning(const XMLElement& at, std::string message, std::string hint = {});
  void note(const XMLElement& at, std::string message);
  /// Counts an element or attribute that is ignored: one note per kind.
  void ignored(const XMLElement& at, const std::string& kind);
  /// Refuses what has no counterpart; a note if it may be left out. `what`: begins the sentence; `hint`: another way.
  void unsupported(const XMLElement& at, const std::string& what, const std::string& hint = {});

  /// A text that a recording contains in addition to the files: what was computed of a mesh. Empty: there is none.
  std::string stored(const std::string& key) const;
  void store(const std::string& key, std::string text);

  /// The texts of all files, and those that were stored.
  std::string bundle() const { return texts_.text(); }
  Diagnostics errors() const;
  Diagnostics report() const;
  bool has_error() const;

 private:
  struct Document {
    std::unique_ptr<tinyxml2::XMLDocument> xml;
    std::filesystem::path file;
    urdf::Findings findings;
  };

  const XMLElement* open(const std::string& text, const std::filesystem::path& file, std::string_view other_root);
  void find_includes(const XMLElement& element, int depth);
  void include(const XMLElement& element, int depth);
  void collect(const XMLElement& parent, std::vector<const XMLElement*>& found) const;

  const UrdfOptions& options_;
  std::string name_;
  TextBundle texts_;
  std::vector<std::unique_ptr<Document>> documents_;
  std::vector<std::pair<const XMLElement*, const XMLElement*>> included_;  // an <include>, and the root of its file
  const XMLElement* root_ = nullptr;
};

}  // namespace rehearse::mjcf
