#include "file_copies.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "descriptors.h"

namespace rehearse::interposer {
namespace {

class KeepErrno {
 public:
  ~KeepErrno() { errno = before_; }

 private:
  int before_ = errno;
};

/// The type of a file, by S_IFMT; 0: none.
mode_t kind_of(const char* path) {
  struct stat status {};
  return stat(path, &status) == 0 ? status.st_mode & S_IFMT : 0;
}

bool exists(const char* path) {
  struct stat status {};
  return lstat(path, &status) == 0;
}

bool begins_with(const char* text, const char* beginning) { return strncmp(text, beginning, strlen(beginning)) == 0; }

/// Devices, files that the kernel generates, and copies are not copied.
bool is_never_copied(const char* name) {
  if (begins_with(name, "/dev/shm/")) return false;
  return begins_with(name, "/dev/") || begins_with(name, "/proc/") || begins_with(name, "/sys/") ||
         begins_with(name, folder_of_copies());
}

/// False if the path is too long.
__attribute__((format(printf, 2, 3))) bool print(char* to, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const int length = vsnprintf(to, PATH_MAX, format, arguments);
  va_end(arguments);
  return length >= 0 && length < PATH_MAX;
}

struct Mark {
  char path[PATH_MAX];
  explicit Mark(const char* name) {
    if (!print(path, "%s/removed%s~", folder_of_copies(), name)) path[0] = 0;
  }
  bool is_set() const { return exists(path); }
};

void make_parents(const char* path) {
  char folder[PATH_MAX];
  strcpy(folder, path);
  for (char* slash = strchr(folder + strlen(folder_of_copies()), '/'); slash; slash = strchr(slash + 1, '/')) {
    *slash = 0;
    mkdir(folder, 0777);
    *slash = '/';
  }
}

void set(const Mark& mark) {
  make_parents(mark.path);
  const int file = open(mark.path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file >= 0) close(file);
}

bool copy_file(const char* from, const char* to) {
  const int source = open(from, O_RDONLY | O_CLOEXEC, 0);
  struct stat status {};
  if (source < 0) return false;
  fstat(source, &status);
  const int target = open(to, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, status.st_mode & 0777);
  char bytes[16384];
  ssize_t count = target < 0 ? -1 : 1;
  while (count > 0 && (count = read(source, bytes, sizeof bytes)) > 0)
    if (write(target, bytes, static_cast<size_t>(count)) != count) count = -1;
  close(source);
  if (target >= 0) close(target);
  if (count < 0 && target >= 0) unlink(to);
  return count == 0;
}

/// Resolves ".", ".." and empty parts, in place.
void normalise(char* path) {
  char* parts[PATH_MAX / 2];
  int count = 0;
  char copy[PATH_MAX];
  strcpy(copy, path);
  char* rest = copy;
  while (char* part = strsep(&rest, "/")) {
    if (strcmp(part, "..") == 0) {
      if (count > 0) --count;
    } else if (*part && strcmp(part, ".") != 0) {
      parts[count++] = part;
    }
  }
  char* to = path;
  for (int i = 0; i < count; ++i) to += sprintf(to, "/%s", parts[i]);
  if (count == 0) strcpy(path, "/");
}

/// Replaces a name in the folder of copies, in place: a copy by its original, a listing by the folder that it lists.
void restore_name(char* name) {
  char files[PATH_MAX], listings[PATH_MAX], original[PATH_MAX];
  if (!*folder_of_copies()) return;
  if (!print(files, "%s/files/", folder_of_copies()) || !print(listings, "%s/listings/", folder_of_copies())) return;
  if (begins_with(name, files)) memmove(name, name + strlen(files) - 1, strlen(name + strlen(files) - 1) + 1);
  if (!begins_with(name, listings)) return;
  char link[PATH_MAX], rest[PATH_MAX];
  const size_t digits = strspn(name + strlen(listings), "0123456789");
  strcpy(rest, name + strlen(listings) + digits);
  if (!print(link, "%.*s~", static_cast<int>(strlen(listings) + digits), name)) return;
  const ssize_t length = readlink(link, original, sizeof original - 1);
  if (length <= 0) return;
  original[length] = 0;
  print(name, "%s%s", original, rest);
}

/// The absolute name of an opened file; false: it has none.
bool name_of_descriptor(int descriptor, char* name) {
  char link[64];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, name, PATH_MAX - 1);
  name[length > 0 ? length : 0] = 0;
  return *name == '/';
}

bool is_writable_folder(const char* name) {
  char parent[PATH_MAX];
  strcpy(parent, name);
  char* slash = strrchr(parent, '/');
  slash[slash == parent ? 1 : 0] = 0;
  char copy[PATH_MAX];
  if (print(copy, "%s/files%s", folder_of_copies(), parent) && kind_of(copy) == S_IFDIR) return true;
  return kind_of(parent) == S_IFDIR && access(parent, W_OK) == 0;
}

bool has_entries(const char* folder) {
  DIR* list = opendir(folder);
  if (!list) return false;
  bool found = false;
  while (const dirent* entry = readdir(list))
    found = found || (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0);
  closedir(list);
  return found;
}

/// Makes links to all files in a folder that have no such name yet and aren't marked as removed.
void link_entries(const char* folder, const char* name, const char* listing) {
  DIR* list = opendir(folder);
  if (!list) return;
  while (const dirent* entry = readdir(list)) {
    char target[PATH_MAX], link[PATH_MAX], original[PATH_MAX];
    if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
    if (!print(target, "%s/%s", folder, entry->d_name) || !print(link, "%s/%s", listing, entry->d_name) ||
        !print(original, "%s/%s", name, entry->d_name))
      continue;
    if (folder != name || !Mark(original).is_set()) (void)!symlink(target, link);
  }
  closedir(list);
}

}  // namespace

StatedName::StatedName(int folder, const char* path) {
  snprintf(text, sizeof text, "%s", path ? path : "");
  if (folder == AT_FDCWD || !path || *path == '/') return;
  const Busy busy;
  const KeepErrno keep;
  char base[PATH_MAX];
  snprintf(base, sizeof base, "%s", relative_name_of(folder));
  if (!*base) {
    if (!name_of_descriptor(folder, base)) return;
    restore_name(base);
  }
  const bool is_here = strcmp(base, ".") == 0 && *path;
  print(text, "%s%s%s", is_here ? "" : base, is_here || !*path || base[strlen(base) - 1] == '/' ? "" : "/", path);
}

bool is_own_folder(const char* path) {
  char files[PATH_MAX];
  return path && *folder_of_copies() && print(files, "%s/files/", folder_of_copies()) && begins_with(path, files);
}

bool is_own_folder(int descriptor) {
  const Busy busy;
  const KeepErrno keep;
  char name[PATH_MAX];
  return name_of_descriptor(descriptor, name) && is_own_folder(name);
}

Located::Located(const Caller& caller, int folder, const char* path, Use use) : given_(path) {
  if (!*folder_of_copies() || !caller.is_controller || !path || !*path) return;
  const Busy busy;
  const KeepErrno keep;
  if (!find_name(folder)) return;
  const mode_t copied = kind_of(copy_);
  if (use == Use::list) {
    use_to_list();
  } else if (exists(copy_) && (copied != S_IFDIR || kind_of(name_) != S_IFDIR)) {
    is_copy_ = true;
  } else if (use == Use::change) {
    use_to_change();
  } else {
    is_copy_ = Mark(name_).is_set();  // then there is no copy
  }
}

/// False: the given name must be used.
bool Located::find_name(int folder) {
  char base[PATH_MAX] = "";
  if (*given_ != '/') {
    if (folder == AT_FDCWD) {
      if (!getcwd(base, sizeof base)) return false;
    } else if (!name_of_descriptor(folder, base)) {
      return false;
    }
  }
  if (!print(name_, "%s/%s", base, given_)) return false;
  normalise(name_);
  restore_name(name_);
  char parent[PATH_MAX], resolved[PATH_MAX];
  strcpy(parent, name_);
  char* slash = strrchr(parent, '/');
  *slash = 0;
  if (slash != parent && realpath(parent, resolved)) {
    char last[NAME_MAX + 2];
    snprintf(last, sizeof last, "%s", slash + 1);
    if (!print(name_, "%s/%s", resolved, last)) return false;
  }
  return !is_never_copied(name_) && print(copy_, "%s/files%s", folder_of_copies(), name_);
}

/// If the file can't be changed or created, the system reports it.
void Located::use_to_change() {
  const mode_t kind = Mark(name_).is_set() ? 0 : kind_of(name_);
  if (kind != 0 && kind != S_IFREG) return;
  if (kind == S_IFREG ? access(name_, W_OK) != 0 : !is_writable_folder(name_)) return;
  make_parents(copy_);
  is_copy_ = kind == 0 || copy_file(name_, copy_);
}

/// A folder with changes is listed through links to all of its files.
void Located::use_to_list() {
  static int listings = 0;
  char removed[PATH_MAX];
  if (!print(removed, "%s/removed%s", folder_of_copies(), name_)) return;
  if (kind_of(name_) != S_IFDIR) {
    is_copy_ = kind_of(copy_) == S_IFDIR;
    return;
  }
  if (!has_entries(copy_) && !has_entries(removed)) return;
  char listing[PATH_MAX];
  const int number = __atomic_add_fetch(&listings, 1, __ATOMIC_RELAXED);
  if (!print(listing, "%s/listings/%d/", folder_of_copies(), number)) return;
  make_parents(listing);
  char link[PATH_MAX];
  if (!print(link, "%s/listings/%d~", folder_of_copies(), number) || symlink(name_, link) != 0) return;
  link_entries(copy_, name_, listing);
  link_entries(name_, name_, listing);
  strcpy(copy_, listing);
  is_copy_ = true;
}

void Located::forget_original() const {
  const Busy busy;
  const KeepErrno keep;
  if (is_copy_ && exists(name_)) set(Mark(name_));
}

Removal::Removal(const Caller& caller, int folder, const char* path) : Located(caller, folder, path, Use::look) {
  if (!*name_ || !*copy_) return;
  const Busy busy;
  const KeepErrno keep;
  if (is_copy_) {
    forget_original();
    return;
  }
  if (!exists(name_) || !is_writable_folder(name_)) return;
  if (kind_of(name_) == S_IFDIR && has_entries(name_)) return;  // it can't be removed
  set(Mark(name_));
  is_done_ = true;
}

}  // namespace rehearse::interposer
