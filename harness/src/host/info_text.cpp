#include "info_text.h"

namespace rehearse {

std::string text_of(const cnoid::ValueNode* node) {
  if (!node || !node->isValid()) return "{}";
  if (node->isScalar()) return node->toString();
  std::string text;
  const auto separate = [&text] { text += text.empty() ? "" : ", "; };
  if (node->isListing()) {
    for (const auto& element : *node->toListing()) {
      separate();
      text += text_of(element);
    }
    return "[" + text + "]";
  }
  for (const auto& [key, value] : *node->toMapping()) {
    separate();
    text += key + ": " + text_of(value);
  }
  return "{" + text + "}";
}

}  // namespace rehearse
