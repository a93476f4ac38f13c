#include "urdf_text.h"

#include <rehearse/urdf.h>

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>

#include "urdf_schema.h"
#include "urdf_values.h"

namespace rehearse::urdf {

std::size_t end_of_prolog(std::string_view text) {
  constexpr std::string_view utf8_mark = "\xEF\xBB\xBF";
  std::size_t position = text.starts_with(utf8_mark) ? utf8_mark.size() : 0;
  while (true) {
    position = std::min(text.find_first_not_of(blanks, position), text.size());
    const std::string_view rest = text.substr(position);
    const std::string_view closing = rest.starts_with("<?") ? "?>" : rest.starts_with("<!--") ? "-->" : "";
    if (closing.empty()) return position;
    const std::size_t end = text.find(closing, position);
    if (end == std::string_view::npos) return position;
    position = end + closing.size();
  }
}

namespace {

using tinyxml2::XMLDocument;
using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

int line_at(std::string_view text, std::size_t position) {
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(position), '\n'));
}

void find_merge_marker(std::string_view text, Findings& findings) {
  for (const std::string_view marker : {"<<<<<<< ", ">>>>>>> "}) {
    std::size_t position = text.find(marker);
    while (position != std::string_view::npos && position > 0 && text[position - 1] != '\n') {
      position = text.find(marker, position + 1);
    }
    if (position == std::string_view::npos) continue;
    findings.error(line_at(text, position), "a merge conflict is left in the file",
                   fmt::format("resolve it; this line begins with {}", marker.substr(0, 7)));
    return;
  }
}

/// End of the tag whose "<" is at `start`: the position after its ">". `attributes` counts its quoted values.
std::size_t end_of_tag(std::string_view text, std::size_t start, int& attributes) {
  for (std::size_t i = start; i < text.size(); ++i) {
    if (text[i] == '>') return i + 1;
    if (text[i] != '"' && text[i] != '\'') continue;
    ++attributes;
    i = std::min(text.find(text[i], i + 1), text.size());
  }
  return text.size();
}

/// An element that begins with "<!" or "<?" ends at its own end mark, even inside quotes.
std::string_view closing_of(std::string_view rest) {
  if (rest.starts_with("<!--")) return "-->";
  if (rest.starts_with("<![CDATA[")) return "]]>";
  if (rest.starts_with("<?")) return "?>";
  return rest.starts_with("<!") ? ">" : "";
}

/// Counts nesting, tags and attributes before a parser runs: parsers recurse into depth, and compare each attribute
/// with those before it.
void check_extent(std::string_view text, Findings& findings) {
  int tags = 0;
  int depth = 0;
  std::size_t position = text.find('<');
  while (position != std::string_view::npos) {
    const std::string_view rest = text.substr(position);
    const std::size_t start = position;
    int attributes = 0;
    if (const std::string_view closing = closing_of(rest); !closing.empty()) {
      position = std::min(text.find(closing, position), text.size());
    } else {
      position = end_of_tag(text, position, attributes);
      const bool is_end = rest.starts_with("</");
      const bool is_closed = position >= start + 2 && text.substr(position - 2, 2) == "/>";
      depth += is_end ? -1 : is_closed ? 0 : 1;
    }
    std::string what;
    if (++tags > max_urdf_tags) what = fmt::format("the file has more than {} tags", max_urdf_tags);
    if (depth > max_urdf_depth) what = fmt::format("elements are nested deeper than {} levels", max_urdf_depth);
    if (attributes > max_urdf_attributes) what = fmt::format("a tag has more than {} attributes", max_urdf_attributes);
    if (!what.empty()) return findings.error(line_at(text, start), what);
    position = text.find('<', position);
  }
}

void check_prolog(std::string_view text, Findings& findings) {
  const std::size_t start = end_of_prolog(text);
  const std::string_view rest = text.substr(start);
  const int line = line_at(text, start);
  if (rest.empty()) {
    findings.error(0, "the file is empty");
  } else if (rest.starts_with("<!DOCTYPE") || rest.starts_with("<!doctype")) {
    findings.error(line, "a document type isn't allowed here",
                   "remove the DOCTYPE; if it contains html, this is a web page and not the file that the page shows");
  } else if (rest.front() != '<') {
    findings.error(line, fmt::format("this is not XML: it begins with {}", in_quotes(rest.substr(0, rest.find('\n')))));
  }
}

/// The meaning of tinyxml2's error, as a sentence.
std::string describe(tinyxml2::XMLError error) {
  switch (error) {
    case tinyxml2::XML_ERROR_PARSING_ELEMENT: return "this tag isn't well-formed XML";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "an attribute of this tag isn't well-formed XML, or there are two of one name";
    case tinyxml2::XML_ERROR_PARSING_TEXT: return "the text that begins here isn't followed by a tag";
    case tinyxml2::XML_ERROR_PARSING_CDATA: return "the CDATA section that begins here has no end";
    case tinyxml2::XML_ERROR_PARSING_COMMENT: return "the comment that begins here has no end";
    case tinyxml2::XML_ERROR_PARSING_DECLARATION: return "a declaration <?...?> is in a wrong place or has no end";
    case tinyxml2::XML_ERROR_PARSING_UNKNOWN: return "the tag <!... that begins here has no end";
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT: return "the element that begins here isn't closed by its own end tag";
    default: return "this isn't well-formed XML";
  }
}

bool can_do_without(const XMLElement& element);

/// True for definitions, for a condition with elements that the loader doesn't need, and for the colour of a shape.
bool can_do_without_xacro(const XMLElement& element, std::string_view parent) {
  const std::string_view name = element.Name();
  if (is_one_of(name, {"xacro:property", "xacro:arg", "xacro:macro"}) || parent == "visual") return true;
  const auto* child = element.FirstChildElement();
  if (child == nullptr || !is_one_of(name, {"xacro:if", "xacro:unless"})) return false;
  while (child != nullptr && can_do_without(*child)) child = child->NextSiblingElement();
  return child == nullptr;
}

/// True if the loader doesn't need the element and its children: elements that describe no link and no joint, and
/// elements in which a mistake affects no more than a sensor or a colour.
bool can_do_without(const XMLElement& element) {
  const std::string_view name = element.Name();
  const std::string_view parent = element.Parent()->ToElement() == nullptr ? "" : element.Parent()->Value();
  if (name.starts_with("xacro:")) return can_do_without_xacro(element, parent);
  const bool is_shape = parent == "geometry";
  return is_one_of(name, {"gazebo", "sensor", "transmission"}) || (!is_shape && name != "geometry" && !is_read(name));
}

bool is_xacro(const XMLElement& element) {
  if (std::string_view(element.Name()).starts_with("xacro:")) return true;
  for (const auto* attribute = element.FirstAttribute(); attribute != nullptr; attribute = attribute->Next()) {
    const std::string_view value = attribute->Value();
    if (value.find("${") != std::string_view::npos || value.find("$(") != std::string_view::npos) return true;
  }
  return false;
}

/// The first element from which xacro would make a part of the robot, or null. The depth of the document is limited.
const XMLElement* find_xacro(const XMLElement& element) {
  if (is_xacro(element)) return &element;
  for (const auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    const XMLElement* found = can_do_without(*child) ? nullptr : find_xacro(*child);
    if (found != nullptr) return found;
  }
  return nullptr;
}

}  // namespace

bool text_is_sound(std::string_view text, Findings& findings) {
  if (text.size() > max_urdf_bytes) {
    findings.error(0, fmt::format("the file has {} bytes, more than {} MiB", text.size(), max_urdf_bytes >> 20));
  } else if (text.starts_with("version https://git-lfs")) {
    findings.error(1, "this is a git-lfs pointer, not the file it stands for", "run: git lfs pull");
  } else if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    findings.error(0, "the file is UTF-16", "save it as UTF-8");
  } else if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos) {
    findings.error(line_at(text, zero), "a zero byte: this is not a text file");
  } else {
    check_prolog(text, findings);
    find_merge_marker(text, findings);
    check_extent(text, findings);
  }
  return !findings.has_error();
}

XMLElement* parse_root(std::string_view text, XMLDocument& document, Findings& findings) {
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    findings.error(document.ErrorLineNum(), describe(document.ErrorID()));
    return nullptr;
  }
  XMLElement* root = document.RootElement();
  if (root == nullptr) {
    findings.error(0, "the file has no element");
    return nullptr;
  }
  for (const XMLNode* node = root->NextSibling(); node != nullptr; node = node->NextSibling()) {
    if (node->ToElement() == nullptr && node->ToText() == nullptr) continue;
    findings.error(node->GetLineNum(), fmt::format("the file continues after </{}>", printable(root->Name())),
                   "a file describes one robot");
    break;
  }
  return root;
}

XMLElement* parse_xml(std::string_view text, XMLDocument& document, Findings& findings) {
  XMLElement* root = parse_root(text, document, findings);
  if (root == nullptr) return nullptr;
  if (std::string_view(root->Name()) != "robot") {
    findings.error(root->GetLineNum(), fmt::format("the file's element is {}", tag(root->Name())),
                   "a URDF file has one element <robot name=\"...\">");
    return nullptr;
  }
  if (const XMLElement* xacro = find_xacro(*root)) {
    findings.error(xacro->GetLineNum(), "this is a xacro file that hasn't been expanded",
                   "run: xacro FILE.urdf.xacro > FILE.urdf");
  }
  return findings.has_error() ? nullptr : root;
}

}  // namespace rehearse::urdf
