// The files of one process: what a controller writes goes into a copy of its own, so that processes beside each other
// don't see each other's files, and the user's files stay as they are. What it only reads is read where it stands.
//
// A folder holds the copies, files/ABSOLUTE/NAME, and marks of what was removed, removed/ABSOLUTE/NAME~. Programs that
// a controller starts see the user's files alone; so does a controller that renames a folder, which fails (EXDEV).
#pragma once

#include <limits.h>

#include "watching.h"

namespace rehearse::interposer {

enum class Use {
  look,    // to read it, or to ask for it
  change,  // to write, create, rename or change it
  list,    // a folder, for what is in it
};

/// The name by which a file is to be used: the one that was given, or that of a copy. Keeps errno.
class Located {
 public:
  /// `path` may be null. The folder is a descriptor, or AT_FDCWD.
  Located(const Caller& caller, int folder, const char* path, Use use);
  Located(const Located&) = delete;
  Located& operator=(const Located&) = delete;
  operator const char*() const { return is_copy_ ? copy_ : given_; }
  bool is_copy() const { return is_copy_; }
  char* text() { return copy_; }
  /// What the copy is of: absolute, without "." and "..".
  const char* name() const { return name_; }
  /// From now on there is no such file but the copy, if there is one.
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

/// The name of what is to be removed; or it is removed already, since there is no copy but only an original, which is
/// marked.
class Removal : public Located {
 public:
  Removal(const Caller& caller, int folder, const char* path);
  bool is_done() const { return is_done_; }

 private:
  bool is_done_ = false;
};

}  // namespace rehearse::interposer
