#include "mjcf_files.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <utility>

#include "mesh/mesh_input.h"
#include "urdf/urdf_text.h"

namespace rehearse::mjcf {

namespace fs = std::filesystem;

Files::Files(const std::string& text, const std::string& name, const UrdfOptions& options)
    : options_(options), name_(name), texts_(text) {
  root_ = open(texts_.main(), name, "");
  if (root_ != nullptr) find_includes(*root_, 0);
  if (has_error()) root_ = nullptr;
}

Files::~Files() = default;

const XMLElement* Files::open(const std::string& text, const fs::path& file, std::string_view other_root) {
  documents_.push_back(std::make_unique<Document>(
      Document{std::make_unique<tinyxml2::XMLDocument>(), file, urdf::Findings(file.string(), options_.strict)}));
  Document& document = *documents_.back();
  if (!urdf::text_is_sound(text, document.findings)) return nullptr;
  const XMLElement* root = urdf::parse_root(text, *document.xml, document.findings);
  if (root == nullptr) return nullptr;
  const std::string_view name = root->Name();
  if (name == "mujoco" || (!other_root.empty() && name == other_root)) return root;
  document.findings.error(root->GetLineNum(), fmt::format("its root is {}", urdf::tag(name)),
                          "expected a MuJoCo model, <mujoco>");
  return nullptr;
}

void Files::find_includes(const XMLElement& element, int depth) {
  for (const XMLElement* child = element.FirstChildElement(); child; child = child->NextSiblingElement()) {
    if (std::string_view(child->Name()) == "include")
      include(*child, depth + 1);
    else
      find_includes(*child, depth);
  }
}

/// Paths are relative to the main file, as for MuJoCo, else to the file that includes.
void Files::include(const XMLElement& element, int depth) {
  const char* written = element.Attribute("file");
  const std::string key = written ? written : "";
  if (key.empty() || key.size() > urdf::longest_path || !is_utf8(key))
    return error(element, "an <include> without a file", "file=\"PARTS.xml\", relative to the model's file");
  if (documents_.size() >= most_includes)
    return error(element, "too many files are included", fmt::format("expected at most {}", most_includes));
  if (depth > deepest_include)
    return error(element, "too many files include each other", fmt::format("expected at most {}", deepest_include));
  if (texts_.keeps(key))
    return error(element, fmt::format("{} is included a second time", in_quotes(key)), "include a file once");
  fs::path file = fs::path(name_).parent_path() / key;
  const std::string* text = texts_.find(key);
  if (text == nullptr) {
    if (texts_.is_of_recording())
      return error(element, fmt::format("the recording doesn't contain {}", in_quotes(key)));
    std::error_code problem;
    if (!fs::exists(file, problem)) {
      for (const auto& document : documents_)
        if (document->xml.get() == element.GetDocument())
          if (fs::path beside = document->file.parent_path() / key; fs::exists(beside, problem)) file = beside;
    }
    if (fs::equivalent(file, name_, problem))
      return error(element, fmt::format("the file includes itself as {}", in_quotes(key)), "include other files");
    const Result<std::string> bytes = read_mesh_file(file);
    if (!bytes)
      return error(element,
                   fmt::format("the included file {} can't be read: {}", in_quotes(key), bytes.errors()[0].message),
                   bytes.errors()[0].hint);
    text = &texts_.set(key, *bytes);
  }
  texts_.keep(key);
  const XMLElement* root = open(*text, file.lexically_normal(), "mujocoinclude");
  included_.emplace_back(&element, root);
  if (root != nullptr) find_includes(*root, depth);
}

void Files::collect(const XMLElement& parent, std::vector<const XMLElement*>& found) const {
  for (const XMLElement* child = parent.FirstChildElement(); child; child = child->NextSiblingElement()) {
    if (std::string_view(child->Name()) != "include") {
      found.push_back(child);
      continue;
    }
    const auto part = std::ranges::find_if(included_, [child](const auto& each) { return each.first == child; });
    if (part != included_.end() && part->second != nullptr) collect(*part->second, found);
  }
}

std::vector<const XMLElement*> Files::children(const XMLElement& parent) const {
  std::vector<const XMLElement*> found;
  collect(parent, found);
  return found;
}

std::vector<const XMLElement*> Files::in_section(std::string_view name) const {
  std::vector<const XMLElement*> found;
  for (const XMLElement* section : children(*root_))
    if (section->Name() == name) collect(*section, found);
  return found;
}

urdf::Findings& Files::findings(const XMLElement& at) {
  for (const auto& document : documents_)
    if (document->xml.get() == at.GetDocument()) return document->findings;
  REHEARSE_ASSERT(false, "an element of no document");
}

int Files::line_in_main(const XMLElement& at) const {
  return at.GetDocument() == documents_.front()->xml.get() ? at.GetLineNum() : 0;
}

void Files::error(const XMLElement& at, std::string message, std::string hint) {
  findings(at).error(at.GetLineNum(), std::move(message), std::move(hint));
}

void Files::warning(const XMLElement& at, std::string message, std::string hint) {
  findings(at).warning(at.GetLineNum(), std::move(message), std::move(hint));
}

void Files::note(const XMLElement& at, std::string message) { findings(at).note(at.GetLineNum(), std::move(message)); }

void Files::ignored(const XMLElement& at, const std::string& kind) { findings(at).ignored(at.GetLineNum(), kind); }

void Files::unsupported(const XMLElement& at, const std::string& what, const std::string& hint) {
  if (options_.allow_unsupported) return note(at, what + " is left out");
  error(at, what + " isn't supported",
        (hint.empty() ? "" : hint + "; ") +
            "--allow-unsupported, or allow_unsupported: true in a scenario, leaves it out");
}

std::string Files::stored(const std::string& key) const {
  const std::string* const found = texts_.find(key);
  return found ? *found : "";
}

void Files::store(const std::string& key, std::string text) {
  texts_.set(key, std::move(text));
  texts_.keep(key);
}

Diagnostics Files::errors() const {
  Diagnostics all;
  for (const auto& document : documents_)
    for (const Diagnostic& found : document->findings.errors()) all.push_back(found);
  return all;
}

Diagnostics Files::report() const {
  Diagnostics all;
  for (const auto& document : documents_)
    for (const Diagnostic& found : document->findings.report()) all.push_back(found);
  return all;
}

bool Files::has_error() const {
  return std::ranges::any_of(documents_, [](const auto& document) { return document->findings.has_error(); });
}

}  // namespace rehearse::mjcf
