#include "body_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <string_view>

#include "base/names.h"
#include "base/text.h"
#include "mesh/mesh_input.h"
#include "vrml_body.h"

namespace rehearse::body {
namespace {

namespace fs = std::filesystem;

/// A path variable at the beginning, as "${SHARE}"; empty: none.
std::string_view variable_of(std::string_view written) {
  const std::size_t end = written.starts_with("${") ? written.find('}') : std::string_view::npos;
  return end == std::string_view::npos ? std::string_view() : written.substr(2, end - 2);
}

}  // namespace

void Document::error(const YamlNode& at, const std::string& message, const std::string& hint) {
  if (is_new(at, message)) findings_.error(at.line, message, hint);
}

void Document::warning(const YamlNode& at, const std::string& message, const std::string& hint) {
  if (is_new(at, message)) findings_.warning(at.line, message, hint);
}

void Document::note(const YamlNode& at, const std::string& message) {
  if (is_new(at, message)) findings_.note(at.line, message);
}

void Document::misspelt(const YamlNode& at, const std::string& kind, const std::string& key, const std::string& hint) {
  const std::string message = fmt::format("the key {} of {} isn't read", in_quotes(key), kind);
  if (told_.emplace(0, message).second) findings_.warning(at.line, message, hint);
}

void Document::passed_over(const YamlNode& at, const std::string& kind, const std::string& key) {
  Passed& passed = passed_[kind];
  if (passed.keys.empty()) passed.line = at.line;
  passed.keys.insert(printable(key));
}

void Document::tell_passed() {
  constexpr std::size_t most = 30;
  for (const auto& [kind, passed] : passed_) {
    const std::vector<std::string> keys(passed.keys.begin(), passed.keys.end());
    findings_.note(passed.line, fmt::format("keys of {} without effect here: {}", kind, listed(keys, most)));
  }
}

Files::Files(const std::string& text, const std::string& name, const UrdfOptions& options)
    : options_(options), paths_(name, options.packages), texts_(text) {
  Document& document = *documents_.emplace_back(std::make_unique<Document>(name, options.strict));
  document.folder = fs::path(name).parent_path();
  by_key_[""] = &document;
  Diagnostic problem;
  parse(document, texts_.main(), {}, problem);
  if (!problem.message.empty()) document.findings().error(problem.line, problem.message, problem.hint);
}

Result<NamedFile> Files::find(const std::string& written, const Document& by) {
  if (written.empty()) return error("its uri is empty", "the path of a file, relative to this one");
  if (written.size() > urdf::longest_path || !is_utf8(written)) return error("its uri is no path");
  const std::string_view variable = variable_of(written);
  if (variable.empty() && written.find("://") == std::string::npos) {
    const fs::path relative = fs::path(by.key).parent_path() / written;
    return NamedFile{(by.folder / written).lexically_normal(), relative.lexically_normal().string()};
  }
  std::string place = written;
  if (!variable.empty()) {
    const std::string rest = written.substr(variable.size() + 3);
    if (variable == "SHARE" && options_.packages.count("SHARE") == 0)
      place = "package://share" + rest;
    else if (variable == "PROJECT_DIR" || variable == "PROGRAM_TOP")
      place = rest.substr(std::min(rest.find_first_not_of('/'), rest.size()));
    else
      place = fmt::format("package://{}{}", variable, rest);
  }
  Result<MeshPlace> found = paths_.find(place);
  if (found) return NamedFile{found->file, written};
  if (texts_.is_of_recording() || skips_meshes()) return NamedFile{written, written};  // the bundle may contain it
  if (variable.empty() || options_.packages.contains(std::string(variable))) return found.errors();
  return error(fmt::format("there is no folder for ${{{}}}", variable),
               fmt::format("--variable {0}=DIR, or packages: {{{0}: DIR}} in a scenario", variable));
}

Document* Files::open(const NamedFile& file, const YamlAnchors& outer, Diagnostic& problem) {
  if (const auto known = by_key_.find(file.key); known != by_key_.end()) return known->second;
  const std::string* text = texts_.find(file.key);
  if (text == nullptr) {
    if (texts_.is_of_recording()) {
      problem = rehearse::error("the recording doesn't contain it");
      return nullptr;
    }
    Result<std::string> bytes = read_mesh_file(file.file);
    if (bytes && bytes->size() > max_body_bytes)
      bytes = rehearse::error(fmt::format("it has {} bytes, more than {} MiB", bytes->size(), max_body_bytes >> 20));
    if (!bytes) {
      problem = bytes.errors().front();
      return nullptr;
    }
    text = &texts_.set(file.key, *std::move(bytes));
  }
  auto document = std::make_unique<Document>(file.file.string(), options_.strict);
  document->folder = file.file.parent_path();
  document->key = file.key;
  parse(*document, *text, outer, problem);
  if (!problem.message.empty()) return nullptr;
  texts_.keep(file.key);
  by_key_[file.key] = document.get();
  return documents_.emplace_back(std::move(document)).get();
}

void Files::parse(Document& document, const std::string& text, const YamlAnchors& outer, Diagnostic& problem) {
  document.root = std::make_shared<YamlNode>();
  if (text.starts_with("version https://git-lfs")) {
    problem = rehearse::error("it is a git-lfs pointer, not the file that it stands for", "run: git lfs pull");
    problem.line = 1;
    return;
  }
  if (is_vrml(document.name(), text)) {
    Result<YamlNodePtr> body = body_of_vrml(text);
    if (body)
      document.root = *std::move(body);
    else
      problem = body.errors().front();
    return;
  }
  Result<YamlDocument> parsed = parse_yaml_document(text, document.name(), outer);
  if (!parsed) {
    problem = parsed.errors().front();
    return;
  }
  document.root = parsed->root;
  document.anchors = std::move(parsed->anchors);
}

Diagnostics Files::errors() const {
  Diagnostics all;
  for (const auto& document : documents_) {
    const Diagnostics of_one = document->findings().errors();
    all.insert(all.end(), of_one.begin(), of_one.end());
  }
  return all;
}

Diagnostics Files::report() {
  Diagnostics all;
  for (const auto& document : documents_) {
    document->tell_passed();
    const Diagnostics of_one = document->findings().report();
    all.insert(all.end(), of_one.begin(), of_one.end());
  }
  return all;
}

bool Files::has_error() const {
  return std::ranges::any_of(documents_, [](const auto& document) { return document->findings().has_error(); });
}

}  // namespace rehearse::body
