#include "yaml_tree.h"

#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "yaml_mistakes.h"

namespace rehearse {
namespace {

// Such files are written by hand. The limit prevents reading a wrong file (a recording, a device) to its end.
constexpr std::size_t max_file_size = 1 << 20;

// Far more than any scenario needs; it stops small files whose aliases unfold to gigabytes.
constexpr std::size_t max_nodes = 1'000'000;

class TreeBuilder : public YAML::EventHandler {
 public:
  /// `lines_before`: lines of the text that aren't the file's.
  explicit TreeBuilder(const YamlAnchors& outer = {}, int lines_before = 0)
      : outer_(outer), lines_before_(lines_before) {}

  YamlNodePtr root() const { return root_; }
  const YamlAnchors& anchors() const { return named_; }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (root_) throw YAML::ParserException(mark, "a second document in the file");
  }
  void OnDocumentEnd() override {}

  void OnAnchor(const YAML::Mark&, const std::string& name) override { name_ = name; }
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
    std::string name;  // of the anchor
    YAML::Mark mark;
  };

  std::shared_ptr<YamlNode> make(YamlNode::Kind kind, const YAML::Mark& mark) const {
    auto node = std::make_shared<YamlNode>();
    node->kind = kind;
    node->line = mark.line + 1 - lines_before_;
    node->column = mark.column + 1;
    return node;
  }

  void open(YamlNode::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor) {
    open_.push_back({make(kind, mark), anchor, std::exchange(name_, {}), mark});
  }

  void close() {
    Open done = open_.back();
    open_.pop_back();
    name_ = std::move(done.name);
    finish(done.node, done.anchor, done.mark);
  }

  void finish(const std::shared_ptr<YamlNode>& node, YAML::anchor_t anchor, const YAML::Mark& mark) {
    // yaml-cpp places an empty value at the next token, often in a different line.
    if (node->kind == YamlNode::Kind::empty && value_follows()) {
      node->line = open_.back().node->keys.back()->line;
      node->column = open_.back().node->keys.back()->column;
    }
    YamlNodePtr known = node;
    if (anchor != 0) {
      const std::string name = std::exchange(name_, {});
      if (const auto outer = outer_.find(name); stands_for_outer() && outer != outer_.end()) known = outer->second;
      named_[name] = anchors_[anchor] = known;
    }
    attach(known, mark);
  }

  /// True within the list that declares the anchors of another file.
  bool stands_for_outer() const { return !outer_.empty() && open_.size() == 2 && open_[0].node->items.empty(); }

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

  const YamlAnchors outer_;
  const int lines_before_;
  YamlNodePtr root_;
  std::string name_;  // of the anchor of the node that follows
  YamlAnchors named_;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, YamlNodePtr> anchors_;
};

}  // namespace

Result<std::string> read_yaml_file(const std::filesystem::path& path, const std::string& what) {
  const auto failed = [&path](std::string message, std::string hint) {
    return error_in(path.string(), std::move(message), std::move(hint));
  };
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    return failed("there is no such file", "expected " + what + ", a YAML file");
  if (std::filesystem::is_directory(path, ignored))
    return failed("it is a directory", "expected " + what + ", a YAML file");
  std::ifstream stream(path, std::ios::binary);
  std::string text;
  std::array<char, 1 << 14> block;
  while (stream.good() && text.size() <= max_file_size) {
    stream.read(block.data(), block.size());
    text.append(block.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad() || !(stream.eof() || stream.good())) return failed("it can't be read", "look at its permissions");
  if (text.size() > max_file_size) return failed("it is larger than 1 MiB", what + " is a short YAML file");
  return text;
}

namespace {

std::string_view lines_before_removed(std::string_view text, int count) {
  for (; count > 0; --count) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  return text;
}

/// Feeds the text's documents to the builder, or only the first.
std::optional<Diagnostic> build(const std::string& text, const std::string& file, bool first_only, int lines_before,
                                TreeBuilder& builder) {
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder) && !first_only) {
    }
    return std::nullopt;
  } catch (const YAML::DeepRecursion& exception) {
    return Diagnostic{Severity::error,
                      file,
                      exception.mark.line + 1 - lines_before,
                      exception.mark.column + 1,
                      "it nests too deep",
                      "such a file needs fewer than ten levels"};
  } catch (const YAML::Exception& exception) {
    Diagnostic diagnostic{Severity::error, file, 0, 0, exception.msg, ""};
    if (!exception.mark.is_null()) {
      diagnostic.line = exception.mark.line + 1 - lines_before;
      diagnostic.column = exception.mark.column + 1;
    }
    explain_yaml_mistake(lines_before_removed(text, lines_before), diagnostic);
    return diagnostic;
  }
}

/// A line that declares the anchors of another file that the text uses: yaml-cpp refuses an alias of an unknown anchor.
std::string declaration_of(const YamlAnchors& outer, const std::string& text) {
  std::string names;
  for (const auto& [name, node] : outer)
    if (text.find("*" + name) != std::string::npos) names += (names.empty() ? "&" : " 0, &") + name;
  return names.empty() ? names : "? [" + names + " 0]\n: 0\n";
}

}  // namespace

Result<YamlDocument> parse_yaml_document(const std::string& text, const std::string& file, const YamlAnchors& outer) {
  const std::string declaration = declaration_of(outer, text);
  const int lines_before = declaration.empty() ? 0 : 2;
  TreeBuilder builder(declaration.empty() ? YamlAnchors() : outer, lines_before);
  if (auto problem = build(declaration + text, file, true, lines_before, builder)) return *problem;
  YamlDocument document{builder.root() ? builder.root() : std::make_shared<YamlNode>(), builder.anchors()};
  if (declaration.empty()) return document;
  auto root = std::make_shared<YamlNode>(*document.root);
  root->keys.erase(root->keys.begin());
  root->items.erase(root->items.begin());
  document.root = root;
  return document;
}

/// The last text is kept with its tree: a scenario is parsed for the run, for its proof and for its golden.
Result<YamlNodePtr> parse_yaml(const std::string& text, const std::string& file) {
  struct Kept {
    std::mutex mutex;
    std::string text;
    YamlNodePtr root;
  };
  static auto& kept = *new Kept;
  {
    const std::lock_guard lock(kept.mutex);
    if (kept.root && kept.text == text) return kept.root;
  }
  TreeBuilder builder;
  if (auto problem = build(text, file, false, 0, builder)) return *problem;
  YamlNodePtr root = builder.root() ? builder.root() : std::make_shared<YamlNode>();
  const std::lock_guard lock(kept.mutex);
  kept.text = text;
  kept.root = root;
  return root;
}

std::string yaml_text(std::string_view text) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const bool is_plain = !text.empty() && (is_letter(text[0]) || text[0] == '_' || text[0] == '/' || text[0] == '.') &&
                        std::ranges::all_of(text, [&](char c) {
                          return is_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '/' || c == '.' || c == '-';
                        });
  if (is_plain) return std::string(text);
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return out + "\"";
}

}  // namespace rehearse
