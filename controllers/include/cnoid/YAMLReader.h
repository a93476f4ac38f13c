// YAMLReader: parses YAML text to a ValueTree. Aliases share their anchor's node; merge keys (<<) are ordinary keys.
#pragma once

#include "Config.h"
#include "ValueTree.h"

#include <string>
#include <vector>

namespace cnoid {

class CNOID_GENERAL_EXPORT YAMLReader {
 public:
  /// False if the file can't be read or isn't YAML: see errorMessage(). An empty text gives no document.
  bool load(const std::string& filename);
  bool parse(const std::string& text);
  /// Returns the first document. Throws FileException or SyntaxException on failure.
  ValueNode* loadDocument(const std::string& filename);

  int numDocuments() const { return static_cast<int>(documents_.size()); }
  /// Null if the document doesn't exist. The reader owns it: store a ValueNodePtr if you need it longer.
  ValueNode* document(int index = 0) const;

  /// The message of the last load or parse, with file and line if they are known; empty if it succeeded.
  const std::string& errorMessage() const { return errorMessage_; }

 private:
  void loadOrThrow(const std::string& filename);
  void parseOrThrow(const std::string& text);

  std::vector<ValueNodePtr> documents_;
  std::string errorMessage_;
};

}  // namespace cnoid
