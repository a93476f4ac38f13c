// yaml-cpp's parser reports events; this file builds the tree from them. yaml-cpp's nodes are not used, because they
// don't represent shared aliases and are slow for motions of a million numbers.

#include <cnoid/YAMLReader>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

namespace cnoid {

namespace {

ValueNode::SyntaxException problemAt(const YAML::Mark& mark, const std::string& message) {
  ValueNode::SyntaxException problem;
  problem.setPosition(mark.line + 1, mark.column + 1);
  problem.setMessage(message);
  return problem;
}

class TreeBuilder : public YAML::EventHandler {
 public:
  /// Throws the stored error. Not earlier: after a syntax error the parser may report several wrong events before it
  /// reports the error itself.
  ValueNodePtr takeDocument() {
    if (!problems_.empty()) throw problems_.front();
    return std::move(document_);
  }

  /// yaml-cpp does not get past some stray characters: it reports an empty document before them again and again.
  void OnDocumentStart(const YAML::Mark& mark) override {
    if (mark.pos == start_) throw problemAt(mark, "this can't stand here");
    start_ = mark.pos;
    document_.reset();
    anchors_.clear();
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(new ScalarNode(""), mark, anchor); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, const std::string& value) override {
    add(new ScalarNode(value), mark, anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto entry = anchors_.find(anchor);
    for (const Level& level : open_) {
      if (entry != anchors_.end() && level.collection == entry->second) {
        problems_.push_back(problemAt(mark, "an alias stands within what it is an alias of"));
        return place(new ScalarNode(""), mark);
      }
    }
    place(entry == anchors_.end() ? ValueNodePtr(new ScalarNode("")) : entry->second, mark);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open_.push_back({add(new Listing, mark, anchor), "", false});
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open_.push_back({add(new Mapping, mark, anchor), "", false});
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  struct Level {
    ValueNodePtr collection;
    std::string key;  // of a mapping: the key of the next value
    bool hasKey;
  };

  ValueNodePtr add(const ValueNodePtr& node, const YAML::Mark& mark, YAML::anchor_t anchor) {
    node->setPosition(mark.line + 1, mark.column + 1);
    if (anchor) anchors_[anchor] = node;
    place(node, mark);
    return node;
  }

  void place(const ValueNodePtr& node, const YAML::Mark& mark) {
    if (open_.empty()) {
      document_ = node;
      return;
    }
    Level& level = open_.back();
    if (level.collection->isListing()) {
      level.collection->toListing()->append(node);
    } else if (level.hasKey) {
      level.collection->toMapping()->insert(level.key, node);
      level.hasKey = false;
    } else {
      takeKey(level, *node, mark);
    }
  }

  void takeKey(Level& level, const ValueNode& node, const YAML::Mark& mark) {
    level.hasKey = true;
    level.key.clear();
    if (!node.isScalar()) {
      problems_.push_back(problemAt(mark, "a key must be a single value"));
      return;
    }
    level.key = node.toString();
    if (level.collection->toMapping()->contains(level.key)) {
      problems_.push_back(problemAt(mark, "the key \"" + level.key + "\" is given twice"));
    }
  }

  std::vector<Level> open_;
  std::map<YAML::anchor_t, ValueNodePtr> anchors_;
  ValueNodePtr document_;
  int start_ = -1;  // start of the document in the text
  std::vector<ValueNode::SyntaxException> problems_;
};

/// The file, or the copy of it that a recording contains: a replay names the folder of the copies.
std::string presentFile(const std::string& filename) {
  std::error_code ignored;
  const char* copies = std::getenv("REHEARSE_RECORDED_FILES");
  if (!copies || std::filesystem::exists(filename, ignored)) return filename;
  const std::filesystem::path copy = std::filesystem::path(copies) / std::filesystem::path(filename).filename();
  return std::filesystem::exists(copy, ignored) ? copy.string() : filename;
}

std::string readFile(const std::string& filename) {
  std::ifstream file(presentFile(filename), std::ios::binary);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  if (file) file.peek();  // a folder can be opened like a file; only reading it fails
  if (!file.is_open() || file.bad()) {
    ValueNode::FileException problem;
    problem.setMessage("the file can't be read");
    throw problem;
  }
  return text.str();
}

}  // namespace

void YAMLReader::loadOrThrow(const std::string& filename) {
  documents_.clear();
  parseOrThrow(readFile(filename));
}

void YAMLReader::parseOrThrow(const std::string& text) {
  documents_.clear();
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    TreeBuilder builder;
    while (parser.HandleNextDocument(builder)) documents_.push_back(builder.takeDocument());
  } catch (const YAML::Exception& error) {
    documents_.clear();
    throw problemAt(error.mark, error.msg);
  }
}

bool YAMLReader::load(const std::string& filename) {
  errorMessage_.clear();
  try {
    loadOrThrow(filename);
    return true;
  } catch (const ValueNode::Exception& problem) {
    errorMessage_ = filename + ": " + problem.message();
    return false;
  }
}

bool YAMLReader::parse(const std::string& text) {
  errorMessage_.clear();
  try {
    parseOrThrow(text);
    return true;
  } catch (const ValueNode::Exception& problem) {
    documents_.clear();
    errorMessage_ = problem.message();
    return false;
  }
}

ValueNode* YAMLReader::loadDocument(const std::string& filename) {
  loadOrThrow(filename);
  if (documents_.empty()) {
    ValueNode::FileException problem;
    problem.setMessage("the file is empty");
    throw problem;
  }
  return document();
}

ValueNode* YAMLReader::document(int index) const {
  return index >= 0 && index < numDocuments() ? documents_[static_cast<std::size_t>(index)].get() : nullptr;
}

}  // namespace cnoid
