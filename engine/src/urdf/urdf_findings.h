// Findings: everything that the URDF loader reports about one file, in document order.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "base/text.h"

namespace rehearse::urdf {

class Findings {
 public:
  /// `strict`: a repair is an error.
  Findings(std::string file, bool strict) : file_(std::move(file)), strict_(strict) {}

  void error(int line, std::string message, std::string hint = {});
  void repair(int line, std::string message, std::string hint = {});
  void warning(int line, std::string message, std::string hint = {});
  void note(int line, std::string message, std::string hint = {});

  /// Records that an element of this kind was ignored. The report has one note per kind, with a count, at the first
  /// place.
  void ignored(int line, const std::string& kind) { counted(line, kind + " is ignored"); }

  /// Like ignored(), but with a complete sentence.
  void counted(int line, const std::string& sentence);

  /// An empty list for the findings about one part of the file, to be passed to take().
  Findings of_part() const { return Findings(file_, false); }

  /// Adds the findings about a part. If there is an error, the part is left out: true, and only the errors are added,
  /// as warnings that begin with `what`, the part's name.
  bool take(const Findings& part, const std::string& what);

  bool has_error() const { return error_count_ > 0; }
  int error_count() const { return error_count_; }

  /// The errors in document order, at most max_urdf_errors, and a note with the number of the remaining ones.
  Diagnostics errors() const;

  /// Repairs, warnings and notes in document order.
  Diagnostics report() const;

 private:
  struct Passed {
    int line = 0;
    int count = 0;
  };

  void add(Severity severity, int line, std::string message, std::string hint);

  std::string file_;
  bool strict_;
  int error_count_ = 0;
  Diagnostics found_;
  std::map<std::string, Passed> counted_;  // by sentence
};

inline constexpr std::size_t longest_path = 1000;  // [bytes]

/// The name as a tag, <name>, in a form for one line of a message.
std::string tag(std::string_view name);

}  // namespace rehearse::urdf
