#include <rehearse/diagnostic.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace rehearse {

std::string_view to_string(Severity severity) {
  switch (severity) {
    case Severity::note: return "note";
    case Severity::repair: return "repair";
    case Severity::warning: return "warning";
    case Severity::error: return "error";
  }
  return "error";
}

std::string to_string(const Diagnostic& diagnostic) {
  std::string text;
  if (!diagnostic.file.empty()) {
    text += diagnostic.file + ":";
    if (diagnostic.line > 0) {
      text += std::to_string(diagnostic.line) + ":";
      if (diagnostic.column > 0) text += std::to_string(diagnostic.column) + ":";
    }
    text += " ";
  }
  text += to_string(diagnostic.severity);
  text += ": " + diagnostic.message;
  if (!diagnostic.hint.empty()) text += " (" + diagnostic.hint + ")";
  return text;
}

std::string to_string(const Diagnostics& diagnostics) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics) text += to_string(diagnostic) + "\n";
  return text;
}

Diagnostic error(std::string message, std::string hint) {
  Diagnostic diagnostic;
  diagnostic.message = std::move(message);
  diagnostic.hint = std::move(hint);
  return diagnostic;
}

Diagnostic error_in(std::string file, std::string message, std::string hint) {
  Diagnostic diagnostic = error(std::move(message), std::move(hint));
  diagnostic.file = std::move(file);
  return diagnostic;
}

Diagnostic warning(std::string message, std::string hint) {
  Diagnostic diagnostic = error(std::move(message), std::move(hint));
  diagnostic.severity = Severity::warning;
  return diagnostic;
}

void append_as_warnings(Diagnostics findings, Diagnostics& remarks) {
  for (Diagnostic& finding : findings) {
    finding.severity = Severity::warning;
    remarks.push_back(std::move(finding));
  }
}

bool has_error(const Diagnostics& diagnostics) {
  return std::ranges::any_of(diagnostics,
                             [](const Diagnostic& diagnostic) { return diagnostic.severity == Severity::error; });
}

void assertion_failed(const char* expression, const char* file, int line, const char* message) {
  std::fprintf(stderr, "%s:%d: assertion failed: %s (%s)\n", file, line, message, expression);
  std::abort();
}

}  // namespace rehearse
