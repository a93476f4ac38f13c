#include "vrml_tree.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <set>
#include <utility>

#include "base/text.h"

namespace rehearse {
namespace {

constexpr int max_depth = 100;  // nodes within nodes

/// The PROTOs with which OpenHRP describes a body.
bool is_of_body(std::string_view type) {
  for (const char* known : {"Humanoid", "Joint", "Segment", "Surface", "ExtraJoint", "ForceSensor", "Gyro",
                            "AccelerationSensor", "VisionSensor", "RangeSensor", "PressureSensor", "PhotoInterrupter",
                            "TorqueSensor", "TactileSensor", "SpotLightDevice", "CylinderSensor", "Site", "Displacer"})
    if (type == known) return true;
  return false;
}

class VrmlParser {
 public:
  explicit VrmlParser(std::string_view text) : text_(text) { advance(); }

  Result<std::vector<VrmlNodePtr>> parse() {
    std::vector<VrmlNodePtr> nodes;
    while (!problem_ && !word_.empty()) {
      if (skip_route() || read_proto()) continue;
      nodes.push_back(read_node(0));
    }
    if (problem_) return *problem_;
    return nodes;
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ','; }
  static bool is_bracket(char c) { return c == '{' || c == '}' || c == '[' || c == ']'; }

  /// Reads the next word, bracket or text; an empty word at the end of the file.
  void advance() {
    while (at_ < text_.size() && (is_blank(text_[at_]) || text_[at_] == '#')) {
      if (text_[at_] == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else {
        line_ += text_[at_++] == '\n';
      }
    }
    is_text_ = at_ < text_.size() && text_[at_] == '"';
    word_line_ = line_;
    if (is_text_) return read_text();
    const std::size_t begin = at_;
    if (at_ < text_.size() && is_bracket(text_[at_])) {
      ++at_;
    } else {
      while (at_ < text_.size() && !is_blank(text_[at_]) && !is_bracket(text_[at_]) && text_[at_] != '"' &&
             text_[at_] != '#')
        ++at_;
    }
    word_ = std::string(text_.substr(begin, at_ - begin));
  }

  void read_text() {
    word_.clear();
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
      line_ += text_[at_] == '\n';
      word_ += text_[at_];
    }
    if (at_ >= text_.size()) return fail("a text in quotes doesn't end");
    ++at_;
  }

  bool is(std::string_view word) const { return !is_text_ && word_ == word; }

  bool skip_route() {
    if (!is("ROUTE")) return false;
    for (int i = 0; i < 4; ++i) advance();  // ROUTE a.b TO c.d
    return true;
  }

  /// PROTO NAME [ fields with their types and defaults ] { nodes }
  bool read_proto() {
    if (!is("PROTO")) return false;
    advance();
    const std::string name = word_;
    advance();
    expect("[");
    std::map<std::string, VrmlValue>& defaults = protos_[name];
    defaults.clear();  // a second PROTO of the name replaces the first
    while (!problem_ && !is("]")) {
      const bool is_event = is("eventIn") || is("eventOut");
      if (!is_event && !is("field") && !is("exposedField")) fail("a field of a PROTO is expected");
      if (problem_) break;
      advance();
      advance();  // its type
      const std::string field = word_;
      advance();
      if (!is_event) read_value(0, defaults[field]);
    }
    advance();
    if (!is("{")) expect("{");
    int depth = 0;
    do {
      if (word_.empty()) fail(fmt::format("the PROTO {} doesn't end", in_quotes(name)));
      depth += is("{") ? 1 : is("}") ? -1 : 0;
      if (!problem_) advance();
    } while (!problem_ && depth > 0);
    return true;
  }

  std::optional<double> number() const {
    if (is_text_ || word_.empty()) return std::nullopt;
    if (word_ == "TRUE" || word_ == "FALSE") return word_ == "TRUE" ? 1.0 : 0.0;
    const char* begin = word_.data() + (word_[0] == '+' ? 1 : 0);
    const char* end = word_.data() + word_.size();
    double value = 0.0;
    if (word_.starts_with("0x") || word_.starts_with("0X")) {
      unsigned long whole = 0;
      const auto [rest, bad] = std::from_chars(begin + 2, end, whole, 16);
      return bad == std::errc() && rest == end ? std::optional(static_cast<double>(whole)) : std::nullopt;
    }
    const auto [rest, bad] = std::from_chars(begin, end, value);
    return bad == std::errc() && rest == end ? std::optional(value) : std::nullopt;
  }

  void expect(std::string_view bracket) {
    if (is(bracket))
      advance();
    else
      fail(fmt::format("{} is expected, not {}", in_quotes(bracket), word_.empty() ? "the end" : in_quotes(word_)));
  }

  /// A node, with or without DEF; for USE the node of that DEF. Null after a mistake, and for NULL.
  VrmlNodePtr read_node(int depth) {
    if (is("NULL")) return advance(), nullptr;
    if (is("USE")) {
      advance();
      const auto known = known_.find(word_);
      if (known == known_.end()) return fail(fmt::format("USE {} has no DEF", in_quotes(word_))), nullptr;
      advance();
      return known->second;
    }
    auto node = std::make_shared<VrmlNode>();
    if (is("DEF")) {
      advance();
      node->name = word_;
      advance();
    }
    if (depth > max_depth) return fail("its nodes nest too deep"), nullptr;
    if (is("{") && !node->name.empty()) {  // "DEF Transform {": a type without a name
      node->type = std::exchange(node->name, {});
    } else {
      read_type(*node);
    }
    if (problem_) return nullptr;
    node->line = word_line_;
    expect("{");
    while (!problem_ && !is("}")) {
      if (word_.empty()) fail(fmt::format("the node {} of line {} doesn't end", in_quotes(node->type), node->line));
      if (problem_ || skip_route()) continue;
      const std::string field = word_;
      advance();
      read_value(depth, node->fields[field]);
    }
    advance();
    complete(*node);
    if (!node->name.empty()) known_[node->name] = node;
    return node;
  }

  /// Adds the defaults of the fields that a node of a PROTO leaves out.
  void complete(VrmlNode& node) {
    const auto proto = protos_.find(node.type);
    if (proto == protos_.end() || problem_) return;
    if (!is_of_body(node.type)) {
      word_line_ = node.line;
      return fail(fmt::format("a node of the PROTO {}, which isn't one of OpenHRP's bodies", in_quotes(node.type)));
    }
    node.is_of_proto = true;
    node.fields.insert(proto->second.begin(), proto->second.end());
  }

  void read_type(VrmlNode& node) {
    node.type = word_;
    if (word_.empty() || is_text_ || is_bracket(word_[0]) || number())
      return fail(fmt::format("a node is expected, not {}", word_.empty() ? "the end" : in_quotes(word_)));
    if (node.type == "EXTERNPROTO") return fail("EXTERNPROTO isn't read");
    advance();
  }

  void read_value(int depth, VrmlValue& value) {
    if (is("[")) {
      advance();
      while (!problem_ && !is("]")) {
        if (word_.empty()) return fail("a list doesn't end");
        read_item(depth, value);
      }
      return advance();
    }
    if (!is_text_ && !number()) return read_item(depth, value);
    if (is_text_) return value.texts.push_back(word_), advance();
    for (auto read = number(); read; read = number()) {
      value.numbers.push_back(*read);
      advance();
    }
  }

  void read_item(int depth, VrmlValue& value) {
    if (is_text_) {
      value.texts.push_back(word_);
      advance();
    } else if (const auto read = number()) {
      value.numbers.push_back(*read);
      advance();
    } else if (VrmlNodePtr node = read_node(depth + 1)) {
      value.nodes.push_back(std::move(node));
    }
  }

  void fail(std::string message) {
    if (problem_) return;
    problem_ = error(std::move(message));
    problem_->line = word_line_;
    at_ = text_.size();
    word_.clear();
    is_text_ = false;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
  std::string word_;
  bool is_text_ = false;
  int word_line_ = 1;
  std::map<std::string, VrmlNodePtr> known_;
  std::map<std::string, std::map<std::string, VrmlValue>> protos_;  // by name: the defaults of the fields
  std::optional<Diagnostic> problem_;
};

}  // namespace

const VrmlValue* VrmlNode::find(const std::string& field) const {
  const auto found = fields.find(field);
  return found == fields.end() ? nullptr : &found->second;
}

const VrmlNode* VrmlNode::node(const std::string& field) const {
  const VrmlValue* value = find(field);
  return value == nullptr || value->nodes.empty() ? nullptr : value->nodes.front().get();
}

std::vector<double> VrmlNode::numbers(const std::string& field, std::vector<double> otherwise) const {
  const VrmlValue* value = find(field);
  return value != nullptr && value->numbers.size() == otherwise.size() ? value->numbers : otherwise;
}

std::vector<VrmlNodePtr> children_of(const VrmlNode& node) {
  static const std::set<std::string> groups = {"Transform", "Group", "Anchor", "Billboard", "Collision"};
  if (groups.contains(node.type) || node.is_of_proto) {
    const VrmlValue* all = node.find(node.type == "Humanoid"  ? "humanoidBody"
                                     : node.type == "Surface" ? "visual"
                                                              : "children");
    return all == nullptr ? std::vector<VrmlNodePtr>() : all->nodes;
  }
  const VrmlValue* levels = node.type == "Switch" ? node.find("choice")
                            : node.type == "LOD"  ? node.find("level")
                                                  : nullptr;
  const std::vector<double> which = node.numbers("whichChoice", {node.type == "LOD" ? 0.0 : -1.0});
  if (levels == nullptr || which[0] < 0.0 || which[0] >= static_cast<double>(levels->nodes.size())) return {};
  return {levels->nodes[static_cast<std::size_t>(which[0])]};
}

Result<std::vector<VrmlNodePtr>> parse_vrml(std::string_view text) {
  if (text.starts_with("#VRML V1.0")) return error("it is VRML 1.0", "VRML97 (#VRML V2.0) is read");
  return VrmlParser(text).parse();
}

}  // namespace rehearse
