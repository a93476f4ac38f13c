#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "other_schemas.h"

namespace rehearse::ros2msg {
namespace {

/// Numbers and texts of IDL, in ROS 2's words. wstring stays: the parser of ROS 2's words refuses it.
constexpr std::pair<std::string_view, std::string_view> simple_types[] = {{"boolean", "bool"},
                                                                          {"octet", "uint8"},
                                                                          {"char", "uint8"},
                                                                          {"int8", "int8"},
                                                                          {"uint8", "uint8"},
                                                                          {"int16", "int16"},
                                                                          {"short", "int16"},
                                                                          {"uint16", "uint16"},
                                                                          {"unsigned short", "uint16"},
                                                                          {"int32", "int32"},
                                                                          {"long", "int32"},
                                                                          {"uint32", "uint32"},
                                                                          {"unsigned long", "uint32"},
                                                                          {"int64", "int64"},
                                                                          {"long long", "int64"},
                                                                          {"uint64", "uint64"},
                                                                          {"unsigned long long", "uint64"},
                                                                          {"float", "float32"},
                                                                          {"double", "float64"},
                                                                          {"string", "string"},
                                                                          {"wstring", "wstring"}};

/// A type with its array or bounds, in ROS 2's words: float64 and [3].
struct IdlType {
  std::string element, many;
};

class IdlParser {
 public:
  IdlParser(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  /// The structs, as ROS 2 writes them, that of `type` first.
  Result<std::string> parse(std::string_view type) {
    next();
    while (problem_.empty() && !token_.empty()) definition("");
    if (!problem_.empty()) return failure();
    const std::string root = short_name(type);
    const auto first = structs_.find(root);
    if (first == structs_.end()) {
      problem_ = fmt::format("it doesn't define {}", type);
      return failure();
    }
    std::string lines = first->second;
    for (const auto& [name, fields] : structs_)
      if (name != root) lines += fmt::format("================\nMSG: {}\n{}", name, fields);
    return lines;
  }

 private:
  Diagnostic failure() const {
    Diagnostic failed = error_in(file_, problem_);
    failed.line = line_;
    return failed;
  }
  void fail(std::string problem) {
    if (problem_.empty()) problem_ = std::move(problem);
    token_ = {};
  }

  /// package/Name of package::msg::Name, or of package/msg/Name.
  static std::string short_name(std::string_view scoped) {
    std::vector<std::string> parts(1);
    for (const char c : scoped) {
      if (c != ':' && c != '/')
        parts.back() += c;
      else if (!parts.back().empty())
        parts.emplace_back();
    }
    if (parts.size() < 2) return parts[0];
    const std::string& kind = parts[parts.size() - 2];
    const bool is_message = kind == "msg" && parts.size() > 2;
    std::string name = is_message ? parts[parts.size() - 3] : parts[0];
    for (std::size_t i = is_message ? parts.size() - 1 : 1; i < parts.size(); ++i) name += '/' + parts[i];
    return name;
  }

  static bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == ':'; }

  /// Skips blanks, comments, preprocessor lines, and the lines between sections.
  void skip_blanks() {
    while (at_ < text_.size()) {
      const std::string_view rest = text_.substr(at_);
      const bool begins_line = at_ == 0 || text_[at_ - 1] == '\n';
      if (rest[0] == '\n') {
        ++line_;
        ++at_;
      } else if (std::isspace(static_cast<unsigned char>(rest[0]))) {
        ++at_;
      } else if (rest.starts_with("//") || rest[0] == '#' ||
                 (begins_line && (rest.starts_with("====") || rest.starts_with("IDL:")))) {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else if (rest.starts_with("/*")) {
        const std::size_t end = text_.find("*/", at_ + 2);
        for (std::size_t i = at_; i < std::min(end, text_.size()); ++i) line_ += text_[i] == '\n' ? 1 : 0;
        at_ = end == std::string_view::npos ? text_.size() : end + 2;
      } else {
        return;
      }
    }
  }

  /// Reads the next token: a word, a text in quotes, or a character. Empty: the end.
  void next() {
    skip_blanks();
    const std::size_t begin = at_;
    if (at_ < text_.size() && text_[at_] == '"') {
      for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) at_ += text_[at_] == '\\' ? 1 : 0;
      at_ = std::min(at_ + 1, text_.size());
    } else if (at_ < text_.size() && is_word(text_[at_])) {
      while (at_ < text_.size() && is_word(text_[at_])) ++at_;
    } else if (at_ < text_.size()) {
      ++at_;
    }
    token_ = problem_.empty() ? text_.substr(begin, at_ - begin) : std::string_view();
  }
  bool take(std::string_view token) {
    if (token_ != token) return false;
    next();
    return true;
  }
  void expect(std::string_view token) {
    if (!take(token)) fail(fmt::format("\"{}\" where '{}' is expected", token_, token));
  }
  std::string name() {
    std::string word(token_);
    if (word.empty() || !is_word(word[0])) fail(fmt::format("\"{}\" where a name is expected", token_));
    next();
    return word;
  }

  /// Skips from an opening bracket to its end, or to a semicolon.
  void skip(std::string_view open, std::string_view close) {
    int depth = 0;
    do {
      if (token_.empty()) return fail(fmt::format("the text ends before '{}'", close));
      depth += token_ == open ? 1 : token_ == close ? -1 : 0;
      next();
    } while (depth > 0);
  }
  void skip_annotations() {
    while (take("@")) {
      name();
      if (token_ == "(") skip("(", ")");
    }
  }

  void definition(const std::string& scope) {
    if (++depth_ > 32) return fail("modules are nested too deeply");
    skip_annotations();
    if (take("module")) {
      const std::string inside = scope + name() + "::";
      expect("{");
      while (problem_.empty() && !token_.empty() && token_ != "}") definition(inside);
      expect("}");
      take(";");
    } else if (take("struct")) {
      structure(scope);
    } else if (take("const")) {
      while (problem_.empty() && !take(";")) {
        if (token_.empty()) return fail("the text ends within a constant");
        next();
      }
    } else if (take("typedef")) {
      const IdlType target = type();
      const std::string alias = name();
      typedefs_[alias] = {target.element, target.many + array()};
      expect(";");
    } else {
      fail(fmt::format("\"{}\" is neither a module, a struct, a constant nor a typedef", token_));
    }
    --depth_;
  }

  void structure(const std::string& scope) {
    const std::string own = short_name(scope + name());
    std::string& fields = structs_[own];
    fields.clear();
    expect("{");
    while (problem_.empty() && !take("}")) {
      skip_annotations();
      const IdlType found = type();
      const std::string field = name();
      const std::string many = found.many + array();
      if (many.find("][") != std::string::npos) return fail(fmt::format("field {} has several dimensions", field));
      // rosidl's words for a struct without members
      if (field != "structure_needs_at_least_one_member")
        fields += fmt::format("{}{} {}\n", found.element, many, field);
      expect(";");
    }
    take(";");
  }

  /// [3] behind a name; empty: none.
  std::string array() {
    std::string many;
    while (take("[")) {
      many += '[' + name() + ']';
      expect("]");
    }
    return many;
  }

  IdlType type() {
    if (take("sequence")) {
      expect("<");
      const IdlType element = type();
      if (!element.many.empty()) fail("a sequence of sequences");
      const std::string bound = take(",") ? "[<=" + name() + "]" : "[]";
      expect(">");
      return {element.element, bound};
    }
    std::string word = name();
    while (word == "unsigned" || word == "unsigned long" || word == "long") {
      if (token_ != "long" && token_ != "short" && token_ != "double") break;
      word += ' ' + name();
    }
    if (word == "string" && take("<")) {
      word = "string<=" + name();
      expect(">");
      return {word, {}};
    }
    for (const auto& [idl, own] : simple_types)
      if (word == idl) return {std::string(own), {}};
    if (const auto alias = typedefs_.find(word); alias != typedefs_.end()) return alias->second;
    return {short_name(word), {}};
  }

  const std::string_view text_;
  const std::string file_;
  std::size_t at_ = 0;
  int line_ = 1, depth_ = 0;
  std::string_view token_;
  std::string problem_;
  std::map<std::string, IdlType> typedefs_;
  std::map<std::string, std::string> structs_;  // the fields of each, a line each
};

}  // namespace

Result<Schema> parse_idl(std::string_view type, std::string_view text, std::string file) {
  const auto lines = REHEARSE_TRY(IdlParser(text, file).parse(type));
  return Schema::parse(type, lines, std::move(file));
}

}  // namespace rehearse::ros2msg
