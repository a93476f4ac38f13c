// YAMLReader: YAML text to a ValueTree. Aliases share their anchor's node; merge keys (<<) are ordinary keys.
#pragma once

#include "Config.h"
#include "ValueTree.h"

#include <string>
#include <vector>

namespace cnoid {

class CNOID_GENERAL_EXPORT YAMLReader {
 public:
  /// False if the file can't be read or is no YAML: see errorMessage(). An empty text gives no document.
  bool load(const std::string& filename);
  bool parse(const std::string& text);
  /// The first document. Throws FileException or SyntaxException instead of returning false.
  ValueNode* loadDocument(const std::string& filename);

  int numDocuments() const { return static_cast<int>(documents_.size()); }
  /// Null if there is none. It belongs to the reader: keep a ValueNodePtr if you need it longer.
  ValueNode* document(int index = 0) const;

  /// Of the last load or parse, with file and line where there is one; empty if it succeeded.
  const std::string& errorMessage() const { return errorMessage_; }

 private:
  void loadOrThrow(const std::string& filename);
  void parseOrThrow(const std::string& text);

  std::vector<ValueNodePtr> documents_;
  std::string errorMessage_;
};

}  // namespace cnoid
