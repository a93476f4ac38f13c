#include "valgrind_report.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <optional>

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

std::string text_in(const XMLElement& parent, const char* name) {
  const XMLElement* child = parent.FirstChildElement(name);
  const char* text = child ? child->GetText() : nullptr;
  return text ? text : "";
}

/// "Filter::update() (filter.cpp:31)": the innermost frame of a stack in one of the libraries.
std::optional<std::string> place_in(const XMLElement* stack, const std::vector<fs::path>& libraries) {
  if (!stack) return std::nullopt;
  for (const XMLElement* frame = stack->FirstChildElement("frame"); frame; frame = frame->NextSiblingElement("frame")) {
    std::error_code ignored;
    const fs::path object = fs::weakly_canonical(text_in(*frame, "obj"), ignored);
    if (std::ranges::find(libraries, object) == libraries.end()) continue;
    const std::string function = text_in(*frame, "fn"), file = text_in(*frame, "file"), line = text_in(*frame, "line");
    const std::string where = file.empty() ? object.filename().string() : file + (line.empty() ? "" : ":" + line);
    return (function.empty() ? "a function without a name" : function) + " (" + where + ")";
  }
  return std::nullopt;
}

std::string words_of(const std::string& kind) {
  if (kind == "UninitCondition") return "a branch depends on a value that was never set";
  if (kind == "UninitValue") return "a value that was never set is used as an address";
  if (kind == "InvalidRead") return "memory is read that is not its own";
  if (kind == "InvalidWrite") return "memory is written that is not its own";
  if (kind == "InvalidFree" || kind == "MismatchedFree") return "memory is freed by a function that may not free it";
  if (kind == "Overlap") return "memory is copied onto itself";
  if (kind == "InvalidJump") return "a jump leads to an address without code";
  return "";
}

std::string sentence_of(const XMLElement& found, const std::vector<fs::path>& libraries) {
  const std::string words = words_of(text_in(found, "kind"));
  if (words.empty()) return "";  // leaks, and requests to valgrind itself
  const XMLElement* stack = found.FirstChildElement("stack");
  const auto place = place_in(stack, libraries);
  const XMLElement* origin = stack ? stack->NextSiblingElement("stack") : nullptr;
  const auto origin_place = place_in(origin, libraries);
  if (!place && !origin_place) return "";
  std::string about = text_in(found, "auxwhat");
  if (!about.empty()) about = (origin_place ? ": " + about + ", in " + *origin_place : ": " + about);
  return fmt::format("{} in {}{}", words, place ? *place : "a function that it calls", about);
}

}  // namespace

std::vector<std::string> memory_errors_in(const std::string& xml, const std::vector<fs::path>& libraries) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const fs::path& library : libraries) files.push_back(fs::weakly_canonical(library, ignored));
  // A process that was killed leaves the elements of its report open.
  constexpr const char* end = "</valgrindoutput>";
  std::string text = xml;
  if (text.find(end) == std::string::npos) {
    const std::size_t last = text.rfind("</error>");
    if (last == std::string::npos) return {};
    text = text.substr(0, last) + "</error>" + end;
  }
  tinyxml2::XMLDocument document;
  if (document.Parse(text.c_str(), text.size()) != tinyxml2::XML_SUCCESS || !document.RootElement()) return {};
  std::vector<std::string> sentences;
  for (const XMLElement* found = document.RootElement()->FirstChildElement("error"); found;
       found = found->NextSiblingElement("error")) {
    std::string sentence = sentence_of(*found, files);
    if (!sentence.empty() && std::ranges::find(sentences, sentence) == sentences.end())
      sentences.push_back(std::move(sentence));
  }
  return sentences;
}

}  // namespace rehearse
