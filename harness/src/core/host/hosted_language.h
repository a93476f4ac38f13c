// Controllers in a file of another language, or library of another kind, which a library of that language runs:
// "hold.py:Hold". The core knows no such language but by its row in hosted_language.cpp.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "language_functions.h"

namespace rehearse {

/// A row of the table.
struct HostedLanguage {
  std::string_view name;     // "Python"
  std::string_view ending;   // of its files
  std::string_view library;  // in the folder `rehearse` beside the libraries of Rehearse
  std::string_view advice;   // how to get the library
  bool is_library = false;   // its files are shared libraries: without a class they are ordinary controllers
};

/// The parts of FILE:CLASS.
struct HostedName {
  const HostedLanguage& language;
  std::filesystem::path file;
  std::string entry;  // empty: none is stated
};

/// The parts of a controller's name or path; nothing if no row of the table has its ending.
std::optional<HostedName> hosted_name(const std::filesystem::path& name);

/// The functions of a language; its library is loaded at the first call and stays. Fails if it isn't installed.
Result<const LanguageFunctions*> functions_of(const HostedLanguage& language);

/// True if the path is a regular file, or its part before the class.
bool is_controller_file(const std::filesystem::path& path);

/// As content_hash_of(); of a hosted controller the hash of all files that its language lists.
std::string hash_of_controller(const std::filesystem::path& file);

}  // namespace rehearse
