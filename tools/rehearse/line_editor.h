// Reads lines of commands: from a person, with history and completion, or from a file or pipe, without either.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse::tool {

class LineEditor {
 public:
  /// Returns all words that are possible at the place of `word`, after `before` in the line. The editor removes those
  /// that don't begin with `word`.
  using Complete = std::function<std::vector<std::string>(std::string_view before, std::string_view word)>;

  /// Only one LineEditor may exist at a time.
  LineEditor(std::string prompt, Complete complete);
  ~LineEditor();
  LineEditor(const LineEditor&) = delete;
  LineEditor& operator=(const LineEditor&) = delete;

  /// The next line without its newline; nullopt at the end. Ctrl-C gives an empty line, and was_interrupted().
  std::optional<std::string> next();
  bool is_interactive() const { return interactive_; }
  /// True if Ctrl-C was pressed since the last call of next() began.
  static bool was_interrupted();

 private:
  std::string prompt_;
  bool interactive_;
};

}  // namespace rehearse::tool
