// The files that a .body consists of: itself, sub-bodies and YAML resources.
#pragma once

#include <rehearse/body.h>

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/text_bundle.h"
#include "mesh/mesh_paths.h"
#include "urdf/urdf_findings.h"
#include "yaml/yaml_tree.h"

namespace rehearse::body {

/// One file. Reports each finding once for each place, even if several aliases lead to it.
class Document {
 public:
  Document(std::string name, bool strict) : name_(std::move(name)), findings_(name_, strict) {}

  const std::string& name() const { return name_; }
  const urdf::Findings& findings() const { return findings_; }
  urdf::Findings& findings() { return findings_; }

  void error(const YamlNode& at, const std::string& message, const std::string& hint = {});
  void warning(const YamlNode& at, const std::string& message, const std::string& hint = {});
  void note(const YamlNode& at, const std::string& message);
  /// Reports a key that resembles a known key, once for all nodes of that kind.
  void misspelt(const YamlNode& at, const std::string& kind, const std::string& key, const std::string& hint);
  /// Stores a key without effect here, of a node of that kind, for tell_passed().
  void passed_over(const YamlNode& at, const std::string& kind, const std::string& key);
  /// Adds a note for the keys of each kind. Call it once, at the end.
  void tell_passed();

  YamlNodePtr root;
  YamlAnchors anchors;
  std::filesystem::path folder;  // of the file; paths in it are relative to it
  std::string key;               // the file's path as it is written, from the main file: its name in the bundle
  bool degrees = true;           // the unit of angles

 private:
  bool is_new(const YamlNode& at, const std::string& message) { return told_.emplace(at.line, message).second; }

  std::string name_;
  urdf::Findings findings_;
  std::set<std::pair<int, std::string>> told_;
  struct Passed {
    int line = 0;
    std::set<std::string> keys;
  };
  std::map<std::string, Passed> passed_;  // by kind
};

/// A file that a different file names.
struct NamedFile {
  std::filesystem::path file;
  std::string key;  // see Document::key
};

/// Reads the files, each once, and collects their text.
class Files {
 public:
  /// `text`: of the main file, or a bundle(). A bundle contains all files that the model needs, meshes aside.
  Files(const std::string& text, const std::string& name, const UrdfOptions& options);

  Document& main() { return *documents_.front(); }
  const UrdfOptions& options() const { return options_; }
  bool skips_meshes() const { return options_.meshes == UrdfOptions::Meshes::skip; }

  /// The place of a file that the document `by` names: relative to the document, with ${SHARE} and other variables,
  /// file:// or package://. The file need not exist.
  Result<NamedFile> find(const std::string& written, const Document& by);

  /// The document of a file; `outer`: anchors that it may use. Null if it can't be read: then `problem` has the reason.
  Document* open(const NamedFile& file, const YamlAnchors& outer, Diagnostic& problem);

  /// The texts of all documents: the main file's, then each further text after a line that states its key and its size.
  std::string bundle() const { return texts_.text(); }

  /// The findings of all files, in the order of their first use: errors, or the load report.
  Diagnostics errors() const;
  Diagnostics report();
  bool has_error() const;

  int elements = 0;  // visited

 private:
  void parse(Document& document, const std::string& text, const YamlAnchors& outer, Diagnostic& problem);

  const UrdfOptions& options_;
  MeshPaths paths_;
  TextBundle texts_;
  std::vector<std::unique_ptr<Document>> documents_;
  std::map<std::string, Document*> by_key_;
};

}  // namespace rehearse::body
