#include "scenario_yaml.h"

#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string_view>

namespace rehearse {
namespace {

// Such files are written by hand. The limit prevents reading a wrong file (a recording, a device) to its end.
constexpr std::size_t max_file_size = 1 << 20;

// Far more than any scenario needs; it stops small files whose aliases unfold to gigabytes.
constexpr std::size_t max_nodes = 1'000'000;

class TreeBuilder : public YAML::EventHandler {
 public:
  YamlNodePtr root() const { return root_; }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (root_) throw YAML::ParserException(mark, "a second document in the file");
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    finish(make(YamlNode::Kind::empty, mark), anchor, mark);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end()) throw YAML::ParserException(mark, "an alias within the node that it stands for");
    attach(found->second, mark);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    auto node = make(YamlNode::Kind::scalar, mark);
    node->text = value;
    node->quoted = !tag.empty() && tag != "?";  // yaml-cpp tags plain scalars "?" and quoted ones "!"
    finish(node, anchor, mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(YamlNode::Kind::list, mark, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(YamlNode::Kind::map, mark, anchor);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    std::shared_ptr<YamlNode> node;
    YAML::anchor_t anchor;
    YAML::Mark mark;
  };

  static std::shared_ptr<YamlNode> make(YamlNode::Kind kind, const YAML::Mark& mark) {
    auto node = std::make_shared<YamlNode>();
    node->kind = kind;
    node->line = mark.line + 1;
    node->column = mark.column + 1;
    return node;
  }

  void open(YamlNode::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor) {
    open_.push_back({make(kind, mark), anchor, mark});
  }

  void close() {
    const Open done = open_.back();
    open_.pop_back();
    finish(done.node, done.anchor, done.mark);
  }

  void finish(const std::shared_ptr<YamlNode>& node, YAML::anchor_t anchor, const YAML::Mark& mark) {
    // yaml-cpp places an empty value at the next token, often in a different line.
    if (node->kind == YamlNode::Kind::empty && value_follows()) {
      node->line = open_.back().node->keys.back()->line;
      node->column = open_.back().node->keys.back()->column;
    }
    if (anchor != 0) anchors_[anchor] = node;
    attach(node, mark);
  }

  bool value_follows() const {
    return !open_.empty() && open_.back().node->keys.size() > open_.back().node->items.size();
  }

  void attach(const YamlNodePtr& node, const YAML::Mark& mark) {
    if (open_.empty()) {
      root_ = node;
      return;
    }
    YamlNode& parent = *open_.back().node;
    parent.weight += node->weight;
    if (parent.weight > max_nodes) throw YAML::ParserException(mark, "more than a million nodes");
    const bool is_key = parent.kind == YamlNode::Kind::map && !value_follows();
    (is_key ? parent.keys : parent.items).push_back(node);
  }

  YamlNodePtr root_;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, YamlNodePtr> anchors_;
};

// yaml-cpp doesn't mention a tab in the indentation in its messages; the advice does.
std::string_view advice(const std::string& text, int line) {
  std::size_t begin = 0;
  for (int i = 1; i < line && begin != std::string::npos; ++i) {
    begin = text.find('\n', begin);
    if (begin != std::string::npos) ++begin;
  }
  const std::size_t first_ink = begin == std::string::npos ? begin : text.find_first_not_of(" \t", begin);
  if (first_ink != std::string::npos && text.substr(begin, first_ink - begin).find('\t') != std::string::npos)
    return "there is a tab in the indentation of this line; indent with spaces";
  return "expected one YAML document; check indentation, brackets and quotes around here";
}

}  // namespace

Result<std::string> read_yaml_file(const std::filesystem::path& path, const std::string& what) {
  const auto failed = [&path](std::string message, std::string hint) {
    Diagnostic diagnostic = error(std::move(message), std::move(hint));
    diagnostic.file = path.string();
    return diagnostic;
  };
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    return failed("there is no such file", "expected " + what + ", a YAML file");
  if (std::filesystem::is_directory(path, ignored))
    return failed("it is a directory", "expected " + what + ", a YAML file");
  std::ifstream stream(path, std::ios::binary);
  std::string text(max_file_size + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad() || !stream.eof()) {
    if (stream.good()) return failed("it is larger than 1 MiB", what + " is a short YAML file");
    return failed("it can't be read", "look at its permissions");
  }
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

Result<YamlNodePtr> parse_yaml(const std::string& text, const std::string& file) {
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    TreeBuilder builder;
    while (parser.HandleNextDocument(builder)) {
    }
    return builder.root() ? builder.root() : std::make_shared<YamlNode>();
  } catch (const YAML::DeepRecursion& exception) {
    return Diagnostic{Severity::error,         file,
                      exception.mark.line + 1, exception.mark.column + 1,
                      "it nests too deep",     "such a file needs fewer than ten levels"};
  } catch (const YAML::Exception& exception) {
    Diagnostic diagnostic{Severity::error, file, 0, 0, "it can't be read as YAML: " + exception.msg, ""};
    if (!exception.mark.is_null()) {
      diagnostic.line = exception.mark.line + 1;
      diagnostic.column = exception.mark.column + 1;
    }
    diagnostic.hint = advice(text, diagnostic.line);
    return diagnostic;
  }
}

}  // namespace rehearse
