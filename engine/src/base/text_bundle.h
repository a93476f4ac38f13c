// Texts of several files in one text, for recordings: the main text, then each part after a line
// `--- # rehearse file SIZE KEY`.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rehearse {

class TextBundle {
 public:
  /// `text`: of the main file, or a text().
  explicit TextBundle(const std::string& text);

  /// The text came from a recording: what it doesn't have can't be read from files.
  bool is_of_recording() const { return is_of_recording_; }
  const std::string& main() const { return texts_.at(""); }
  /// The part; null: there is none. It stays where it is.
  const std::string* find(const std::string& key) const;
  /// Sets the part, which text() has only after keep().
  const std::string& set(const std::string& key, std::string text) { return texts_[key] = std::move(text); }
  /// text() has the part from now on, after those that were kept before.
  void keep(const std::string& key);
  bool keeps(const std::string& key) const;

  /// The main text, and the kept parts.
  std::string text() const;

 private:
  bool is_of_recording_ = false;
  std::map<std::string, std::string> texts_;  // by key; of the main file under ""
  std::vector<std::string> kept_;
};

}  // namespace rehearse
