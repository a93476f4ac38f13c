#include "body_info.h"

#include <rehearse/body.h>
#include <cnoid/YAMLReader>

#include <filesystem>
#include <string>
#include <string_view>

namespace rehearse {
namespace {

constexpr std::string_view links_key = "links";

/// The text without the block of the links, which is nearly all of it. It may lack anchors that are in that block.
std::string without_links(std::string_view text) {
  std::string rest;
  bool is_kept = true;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(line.size() < text.size() ? line.size() + 1 : line.size());
    const bool begins_key = !line.empty() && std::string_view(" \t\r#-}]").find(line.front()) == std::string_view::npos;
    if (begins_key) is_kept = line.substr(0, line.find_first_of(": \t")) != links_key;
    if (is_kept) rest.append(line).append("\n");
  }
  return rest;
}

}  // namespace

void read_body_info(const Model& model, cnoid::Mapping& info) {
  const std::string ending = std::filesystem::path(model.source_file).extension().string();
  if (ending != ".body" && ending != ".yaml" && ending != ".yml") return;
  // The first document: files that it includes follow as further documents.
  const std::string text = model.source_text.substr(0, model.source_text.find("\n--- ") + 1);
  const std::string& own = text.empty() ? model.source_text : text;
  cnoid::YAMLReader reader;
  if (!reader.parse(without_links(own)) && !reader.parse(own)) return;
  const cnoid::ValueNode* document = reader.document();
  if (!document || !document->isMapping()) return;
  info.insert(document->toMapping());
  info.remove(std::string(links_key));
}

}  // namespace rehearse
