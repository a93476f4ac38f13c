// Diagnostics: every part of Rehearse reports errors in its input data with them.
//
// A data error (a bad file, a bad argument, a controller that failed) is a value: a function that can meet one
// returns Result<T>, which contains either the value or at least one Diagnostic. A programmer error (a broken invariant
// of Rehearse itself) is REHEARSE_ASSERT, which is checked in every build. Nothing here throws. REHEARSE_TRY passes the
// diagnostics of a called function on to the caller.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace rehearse {

enum class Severity {
  note,     // something was ignored, and nothing depends on it
  repair,   // the loader changed the data; the message states how
  warning,  // the data is usable, but the author probably meant something else
  error,    // the data can't be used
};

/// One finding about input data, with its place in the file.
struct Diagnostic {
  Severity severity = Severity::error;
  std::string file;     // as the user named it; empty when there is none
  int line = 0;         // 1-based; 0 when unknown
  int column = 0;       // 1-based; 0 when unknown
  std::string message;  // the mistake
  std::string hint;     // how to correct it; may be empty
};

using Diagnostics = std::vector<Diagnostic>;

/// "error", "warning", "repair" or "note".
std::string_view to_string(Severity severity);

/// One line in the form compilers use: `file:line:column: severity: message (hint)`, without the unknown parts.
std::string to_string(const Diagnostic& diagnostic);

/// All diagnostics, one per line, each with its newline.
std::string to_string(const Diagnostics& diagnostics);

/// Returns a diagnostic of severity error without a place.
Diagnostic error(std::string message, std::string hint = {});

/// Returns a diagnostic of severity error about a file; `file` is its name as the user gave it.
Diagnostic error_in(std::string file, std::string message, std::string hint = {});

/// Returns a diagnostic of severity warning without a place.
Diagnostic warning(std::string message, std::string hint = {});

/// Adds the findings to the remarks, each with severity warning.
void append_as_warnings(Diagnostics findings, Diagnostics& remarks);

/// True if any diagnostic has the severity error.
bool has_error(const Diagnostics& diagnostics);

/// Prints the place and the message to stderr and aborts. The body of REHEARSE_ASSERT.
[[noreturn]] void assertion_failed(const char* expression, const char* file, int line, const char* message);

/// Checks an invariant of Rehearse itself, in every build type.
#define REHEARSE_ASSERT(condition, message) \
  ((condition) ? static_cast<void>(0) : ::rehearse::assertion_failed(#condition, __FILE__, __LINE__, message))

/// A value, or the diagnostics that state why there is no value (then at least one).
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}
  Result(Diagnostic diagnostic) : content_(std::in_place_index<1>, Diagnostics{std::move(diagnostic)}) {}
  Result(Diagnostics diagnostics) : content_(std::in_place_index<1>, std::move(diagnostics)) {
    REHEARSE_ASSERT(!std::get<1>(content_).empty(), "a failed Result contains a diagnostic");
  }

  bool ok() const { return content_.index() == 0; }
  explicit operator bool() const { return ok(); }

  T& value() & { return check(), std::get<0>(content_); }
  const T& value() const& { return check(), std::get<0>(content_); }
  T&& value() && { return check(), std::get<0>(std::move(content_)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  /// The reasons for the missing value; only when !ok().
  const Diagnostics& errors() const {
    REHEARSE_ASSERT(!ok(), "errors() asked of a Result that has a value");
    return std::get<1>(content_);
  }

 private:
  void check() const { REHEARSE_ASSERT(ok(), "value() asked of a Result that failed"); }
  std::variant<T, Diagnostics> content_;
};

/// Success, or the diagnostics that state why the function failed (then at least one).
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Diagnostic diagnostic) : errors_{std::move(diagnostic)} {}
  Result(Diagnostics diagnostics) : errors_(std::move(diagnostics)) {
    REHEARSE_ASSERT(!errors_.empty(), "a failed Result contains a diagnostic");
  }
  bool ok() const { return errors_.empty(); }
  explicit operator bool() const { return ok(); }
  void value() const { REHEARSE_ASSERT(ok(), "value() asked of a Result that failed"); }
  const Diagnostics& errors() const { return errors_; }

 private:
  Diagnostics errors_;
};

/// The value of a Result. If there is none, the function that contains this expression returns the diagnostics.
/// It is a statement of its own, or the initial or new value of a variable:
///     const Trace trace = REHEARSE_TRY(Trace::load(file));
#define REHEARSE_TRY(...)                                           \
  __extension__({                                                   \
    auto&& rehearse_tried = (__VA_ARGS__);                          \
    if (!rehearse_tried.ok()) return rehearse_tried.errors();       \
    std::forward<decltype(rehearse_tried)>(rehearse_tried).value(); \
  })

}  // namespace rehearse
