// The first two checks of the URDF loader: that the bytes are text that may be URDF, and that the text is XML.
#pragma once

#include "urdf_findings.h"

#include <string_view>

namespace tinyxml2 {
class XMLDocument;
class XMLElement;
}  // namespace tinyxml2

namespace rehearse::urdf {

/// Blanks of XML.
inline constexpr std::string_view blanks = " \t\r\n";

/// Checks the bytes before any parser reads them: empty, too large, git-lfs pointer, merge conflict, UTF-16, document
/// type, nesting too deep, too many tags or attributes. False if there is an error.
bool text_is_sound(std::string_view text, Findings& findings);

/// Position of the first character in the text that is neither blank nor part of a declaration or a comment.
std::size_t end_of_prolog(std::string_view text);

/// Parses the text into `document`, and checks that there is one root element, of any name. Null if there is an error.
tinyxml2::XMLElement* parse_root(std::string_view text, tinyxml2::XMLDocument& document, Findings& findings);

/// Parses the text into `document`, and checks that there is one root element <robot> and
/// no xacro left where it would make a part of the robot. Null if there is an error.
tinyxml2::XMLElement* parse_xml(std::string_view text, tinyxml2::XMLDocument& document, Findings& findings);

}  // namespace rehearse::urdf
