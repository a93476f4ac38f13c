// The files of one process. A file that a controller writes is copied first, so that parallel processes don't see each
// other's files, and the user's files are unchanged. A file that it only reads is not copied.
//
// A folder contains the copies, files/ABSOLUTE/NAME, and marks of removed files, removed/ABSOLUTE/NAME~. Programs that
// a controller starts see the user's files only. A controller that renames a folder sees them, too, and fails (EXDEV).
#pragma once

#include <limits.h>

#include "watching.h"

namespace rehearse::interposer {

enum class Use {
  look,    // to read or query it
  change,  // to write, create, rename or change it
  list,    // to list a folder
};

/// The name of a file as the log states it: the given one; after a folder's descriptor with the name of that folder.
struct StatedName {
  char text[PATH_MAX];
  /// `path` may be null or empty. The folder is a descriptor, or AT_FDCWD.
  StatedName(int folder, const char* path);
  operator const char*() const { return text; }
  bool is_relative() const { return *text && *text != '/'; }
};

/// True for the copy of a folder that the controller made itself, which has no original.
bool is_own_folder(const char* path);
bool is_own_folder(int descriptor);

/// The name by which to access a file: the given name, or the name of its copy. Keeps errno.
class Located {
 public:
  /// `path` may be null. The folder is a descriptor, or AT_FDCWD.
  Located(const Caller& caller, int folder, const char* path, Use use);
  Located(const Located&) = delete;
  Located& operator=(const Located&) = delete;
  operator const char*() const { return is_copy_ ? copy_ : given_; }
  bool is_copy() const { return is_copy_; }
  char* text() { return copy_; }
  /// The name of the original: absolute, without "." and "..".
  const char* name() const { return name_; }
  /// From now on the original counts as removed; the copy remains, if there is one.
  void forget_original() const;

 private:
  bool find_name(int folder);
  void use_to_change();
  void use_to_list();

 protected:
  const char* given_;
  bool is_copy_ = false;
  char name_[PATH_MAX] = "";
  char copy_[PATH_MAX] = "";
};

/// The name of the file to remove. If there is an original without a copy, it is marked as removed instead.
class Removal : public Located {
 public:
  Removal(const Caller& caller, int folder, const char* path);
  bool is_done() const { return is_done_; }

 private:
  bool is_done_ = false;
};

}  // namespace rehearse::interposer
