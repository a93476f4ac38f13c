// The functions of a library that runs controllers of its own language. It exports them by the symbol
// rehearse_language.
#pragma once

#include <cstdint>
#include <string>

struct rehearse_controller_functions;  // of <rehearse/controller.h>

namespace rehearse {

inline constexpr std::uint32_t language_functions_version = 2;

/// Why a file can't be loaded as a controller.
struct LanguageProblem {
  std::string message;  // empty: there is none
  std::string hint;
  std::string file;  // where it is; empty: not known
  int line = 0;      // 1-based; 0: not known
};

struct LanguageFunctions {
  std::uint32_t version = language_functions_version;
  /// Runs the author's code: executes the file, and finds the class in it. Null: `problem` states why.
  void* (*load)(const char* file, const char* entry, LanguageProblem& problem) = nullptr;
  /// Runs none of the author's code: calls `add` for the file and for each file beside or below it that it imports, in
  /// a fixed order. A file that can't be read or parsed imports nothing.
  void (*list_files)(const char* file, void (*add)(void* context, const char* path), void* context) = nullptr;
  /// The functions whose next create() makes a controller of what load() returned.
  const rehearse_controller_functions* (*functions)(void* loaded) = nullptr;
  /// `loaded` isn't used any more. Not called if code of it never returned.
  void (*unload)(void* loaded) = nullptr;
  /// The dynamic linker's handle of what load() returned; the function is null if it is no shared library.
  void* (*handle)(void* loaded) = nullptr;
};

}  // namespace rehearse
