// Files and networks: their names, and the content of a file when it was opened for reading.
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "descriptors.h"
#include "file_copies.h"
#include "machine.h"
#include "next.h"
#include "random_stream.h"
#include "watching.h"

namespace rehearse::interposer {
namespace {

using RealOpen = int(int folder, const char* path, int flags, unsigned mode);
Next<RealOpen> real_openat{"openat"};

// Limit for the content of a file [bytes]; larger files have their size only.
constexpr int64_t most_digested = 64 << 20;
constexpr int64_t most_made_up = 64 << 10;  // limit for a file that the kernel generates [bytes], which has no size

/// "214 bytes 8c7dd922ad47494f", "not there" (also if it can't be read), "no ordinary file".
struct Digest {
  char text[64] = "";

  Digest(int folder, const char* path) {
    if (!path) return;
    const Busy busy;
    const int errno_before = errno;
    // O_NONBLOCK: opening a pipe would wait for its other end
    const int file = real_openat.get()(folder, path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC, 0);
    struct stat status {};
    if (file < 0)
      snprintf(text, sizeof text, "not there");
    else if (fstat(file, &status) == 0 && S_ISREG(status.st_mode))
      read_all(file, status.st_size);
    else
      snprintf(text, sizeof text, "no ordinary file");
    if (file >= 0) close(file);
    errno = errno_before;
  }

 private:
  void read_all(int file, int64_t size) {
    XXH3_state_t state;
    XXH3_64bits_reset(&state);
    char bytes[16384];
    const int64_t most = size > 0 ? most_digested : most_made_up;
    int64_t left = most;
    for (ssize_t count; left > 0 && (count = read(file, bytes, sizeof bytes)) > 0; left -= count)
      XXH3_64bits_update(&state, bytes, static_cast<size_t>(count));
    if (size == 0) size = most - left;
    snprintf(text, sizeof text, "%lld bytes %016llx", static_cast<long long>(size),
             static_cast<unsigned long long>(XXH3_64bits_digest(&state)));
  }
};

bool is_random_device(const char* path) {
  return path && (strcmp(path, "/dev/urandom") == 0 || strcmp(path, "/dev/random") == 0);
}

bool reads(int flags) { return (flags & O_ACCMODE) != O_WRONLY && !(flags & (O_TRUNC | O_DIRECTORY | O_EXCL)); }
bool reads(const char* mode) { return mode && (mode[0] == 'r' || strchr(mode, '+')) && mode[0] != 'w'; }

bool changes(int flags) { return (flags & O_ACCMODE) != O_RDONLY || flags & (O_CREAT | O_TRUNC); }
bool changes(const char* mode) { return mode && (mode[0] != 'r' || strchr(mode, '+')); }

/// Logs the opening of a file, with the file's digest if it is opened for reading, and finds the file to open instead.
struct Opening {
  Caller caller;
  StatedName name;
  Located path;
  int instead = -2;  // a replacing descriptor; -2: none

  Opening(const char* function, int folder, const char* wanted, bool reading, Use use, void* return_address)
      : caller(find_caller(return_address)), name(folder, wanted), path(caller, folder, wanted, use) {
    const Substitution& substitution = substitution_for(caller);
    if (is_random_device(name)) {
      note(caller, Source::random, function, name);
      if (substitution.has_seed) instead = open_random_file(substitution.seed);
    } else if (is_machine_file(name)) {
      note(caller, Source::environment, function, name);
      if (substitution.machine > 0) instead = open_machine_file(substitution.machine, name);
    } else if (reading) {
      note(caller, Source::file, function, name, Digest(folder, path).text);
    } else {
      note(caller, Source::file, function, name);
    }
  }

  int opened(int descriptor) const {
    if (caller.is_controller) set_relative_name(descriptor, name.is_relative() ? name : "");
    return now_controllers(descriptor);
  }
};

Use use_of(int flags) { return flags & O_DIRECTORY ? Use::list : changes(flags) ? Use::change : Use::look; }
Use use_of(const char* mode) { return changes(mode) ? Use::change : Use::look; }

}  // namespace

// NOLINTBEGIN(bugprone-macro-parentheses): a list of arguments has its own

// The third or fourth parameter of these functions exists only if a file may be created. Otherwise an undefined
// register is passed on, which no function reads.
#define REHEARSE_OPENED(name, parameters, arguments, folder, flags)                                       \
  REHEARSE_INTERPOSED(int, name, parameters) {                                                            \
    if (!watching()) return next_##name.get() arguments;                                                  \
    const Opening opening(#name, folder, path, reads(flags), use_of(flags), __builtin_return_address(0)); \
    path = opening.path;                                                                                  \
    return opening.opened(opening.instead == -2 ? next_##name.get() arguments : opening.instead);         \
  }
REHEARSE_OPENED(open, (const char* path, int flags, unsigned mode), (path, flags, mode), AT_FDCWD, flags)
REHEARSE_OPENED(open64, (const char* path, int flags, unsigned mode), (path, flags, mode), AT_FDCWD, flags)
REHEARSE_OPENED(openat, (int folder, const char* path, int flags, unsigned mode), (folder, path, flags, mode), folder,
                flags)
REHEARSE_OPENED(openat64, (int folder, const char* path, int flags, unsigned mode), (folder, path, flags, mode), folder,
                flags)
REHEARSE_OPENED(__open_2, (const char* path, int flags), (path, flags), AT_FDCWD, flags)
REHEARSE_OPENED(__open64_2, (const char* path, int flags), (path, flags), AT_FDCWD, flags)
REHEARSE_OPENED(__openat_2, (int folder, const char* path, int flags), (folder, path, flags), folder, flags)
REHEARSE_OPENED(__openat64_2, (int folder, const char* path, int flags), (folder, path, flags), folder, flags)
REHEARSE_OPENED(creat, (const char* path, unsigned mode), (path, mode), AT_FDCWD, O_WRONLY | O_CREAT | O_TRUNC)
REHEARSE_OPENED(creat64, (const char* path, unsigned mode), (path, mode), AT_FDCWD, O_WRONLY | O_CREAT | O_TRUNC)
#undef REHEARSE_OPENED

#define REHEARSE_FILE_OPENED(name, parameters, arguments)                                                 \
  REHEARSE_INTERPOSED(FILE*, name, parameters) {                                                          \
    if (!watching()) return next_##name.get() arguments;                                                  \
    const Opening opening(#name, AT_FDCWD, path, reads(mode), use_of(mode), __builtin_return_address(0)); \
    path = opening.path;                                                                                  \
    return opening.instead < 0 ? next_##name.get() arguments : fdopen(opening.instead, mode);             \
  }
REHEARSE_FILE_OPENED(fopen, (const char* path, const char* mode), (path, mode))
REHEARSE_FILE_OPENED(fopen64, (const char* path, const char* mode), (path, mode))
REHEARSE_FILE_OPENED(freopen, (const char* path, const char* mode, FILE* file), (path, mode, file))
REHEARSE_FILE_OPENED(freopen64, (const char* path, const char* mode, FILE* file), (path, mode, file))
#undef REHEARSE_FILE_OPENED

/// A function with the name of a file as argument: it is logged, and applied to the process's copy if there is one.
#define REHEARSE_LOCATED(result, name, parameters, arguments, folder, use)                   \
  REHEARSE_INTERPOSED(result, name, parameters) {                                            \
    if (!watching()) return next_##name.get() arguments;                                     \
    const StatedName stated(folder, path);                                                   \
    const Caller caller = note(source_of::name, #name, stated, __builtin_return_address(0)); \
    const Located located(caller, folder, path, use);                                        \
    path = located;                                                                          \
    return next_##name.get() arguments;                                                      \
  }
using VisitFile = int (*)(const char*, const void*, int);
REHEARSE_LOCATED(int, ftw, (const char* path, VisitFile visit, int depth), (path, visit, depth), AT_FDCWD, Use::list)
REHEARSE_LOCATED(int, ftw64, (const char* path, VisitFile visit, int depth), (path, visit, depth), AT_FDCWD, Use::list)
using VisitPlace = int (*)(const char*, const void*, int, void*);
REHEARSE_LOCATED(int, nftw, (const char* path, VisitPlace visit, int depth, int flags), (path, visit, depth, flags),
                 AT_FDCWD, Use::list)
REHEARSE_LOCATED(int, nftw64, (const char* path, VisitPlace visit, int depth, int flags), (path, visit, depth, flags),
                 AT_FDCWD, Use::list)
REHEARSE_LOCATED(int, stat, (const char* path, struct stat* status), (path, status), AT_FDCWD, Use::look)
REHEARSE_LOCATED(int, stat64, (const char* path, struct stat64* status), (path, status), AT_FDCWD, Use::look)
REHEARSE_LOCATED(int, lstat, (const char* path, struct stat* status), (path, status), AT_FDCWD, Use::look)
REHEARSE_LOCATED(int, lstat64, (const char* path, struct stat64* status), (path, status), AT_FDCWD, Use::look)
REHEARSE_LOCATED(int, fstatat, (int folder, const char* path, struct stat* status, int flags),
                 (folder, path, status, flags), folder, Use::look)
REHEARSE_LOCATED(int, fstatat64, (int folder, const char* path, struct stat64* status, int flags),
                 (folder, path, status, flags), folder, Use::look)
REHEARSE_LOCATED(int, statx, (int folder, const char* path, int flags, unsigned mask, void* status),
                 (folder, path, flags, mask, status), folder, Use::look)
REHEARSE_LOCATED(int, access, (const char* path, int mode), (path, mode), AT_FDCWD, Use::look)
REHEARSE_LOCATED(int, faccessat, (int folder, const char* path, int mode, int flags), (folder, path, mode, flags),
                 folder, Use::look)
REHEARSE_LOCATED(ssize_t, readlink, (const char* path, char* to, size_t size), (path, to, size), AT_FDCWD, Use::look)
REHEARSE_LOCATED(ssize_t, readlinkat, (int folder, const char* path, char* to, size_t size), (folder, path, to, size),
                 folder, Use::look)
REHEARSE_LOCATED(int, statfs, (const char* path, void* space), (path, space), AT_FDCWD, Use::look)
REHEARSE_LOCATED(int, statfs64, (const char* path, void* space), (path, space), AT_FDCWD, Use::look)
REHEARSE_LOCATED(int, statvfs, (const char* path, void* space), (path, space), AT_FDCWD, Use::look)
REHEARSE_LOCATED(int, statvfs64, (const char* path, void* space), (path, space), AT_FDCWD, Use::look)
REHEARSE_LOCATED(int, truncate, (const char* path, off_t length), (path, length), AT_FDCWD, Use::change)
REHEARSE_LOCATED(int, chmod, (const char* path, mode_t mode), (path, mode), AT_FDCWD, Use::change)
REHEARSE_LOCATED(int, fchmodat, (int folder, const char* path, mode_t mode, int flags), (folder, path, mode, flags),
                 folder, Use::change)
REHEARSE_LOCATED(int, utimensat, (int folder, const char* path, const timespec* times, int flags),
                 (folder, path, times, flags), folder, Use::change)
REHEARSE_LOCATED(int, mkdir, (const char* path, mode_t mode), (path, mode), AT_FDCWD, Use::change)
#undef REHEARSE_LOCATED

REHEARSE_INTERPOSED(char*, realpath, (const char* path, char* to)) {
  if (!watching()) return next_realpath.get()(path, to);
  const Caller caller = note(source_of::realpath, "realpath", path, __builtin_return_address(0));
  const Located located(caller, AT_FDCWD, path, Use::look);
  if (!located.is_copy()) return next_realpath.get()(path, to);
  const Busy busy;
  struct stat status {};
  if (stat(located, &status) != 0) return nullptr;
  return to ? strcpy(to, located.name()) : strdup(located.name());
}

#define REHEARSE_REMOVED(name, parameters, arguments, folder)                                \
  REHEARSE_INTERPOSED(int, name, parameters) {                                               \
    if (!watching()) return next_##name.get() arguments;                                     \
    const StatedName stated(folder, path);                                                   \
    const Caller caller = note(source_of::name, #name, stated, __builtin_return_address(0)); \
    const Removal removal(caller, folder, path);                                             \
    if (removal.is_done()) return 0;                                                         \
    path = removal;                                                                          \
    return next_##name.get() arguments;                                                      \
  }
REHEARSE_REMOVED(unlink, (const char* path), (path), AT_FDCWD)
REHEARSE_REMOVED(unlinkat, (int folder, const char* path, int flags), (folder, path, flags), folder)
REHEARSE_REMOVED(remove, (const char* path), (path), AT_FDCWD)
REHEARSE_REMOVED(rmdir, (const char* path), (path), AT_FDCWD)
#undef REHEARSE_REMOVED

REHEARSE_INTERPOSED(int, rename, (const char* from, const char* to)) {
  if (!watching()) return next_rename.get()(from, to);
  const Caller caller = note(source_of::rename, "rename", from, __builtin_return_address(0));
  const Located old_name(caller, AT_FDCWD, from, Use::change), new_name(caller, AT_FDCWD, to, Use::change);
  if (old_name.is_copy() != new_name.is_copy()) {  // a folder that existed before, or a place that can't be written
    errno = EXDEV;
    return -1;
  }
  const int result = next_rename.get()(old_name, new_name);
  if (result == 0) old_name.forget_original();
  return result;
}

REHEARSE_NOTED(FILE*, tmpfile, (), (), "")
REHEARSE_NOTED(FILE*, tmpfile64, (), (), "")

/// A function whose argument ends in XXXXXX, which is replaced by the chosen letters afterwards. `answer` is returned
/// for `made`, the result for a copy.
#define REHEARSE_MADE_TEMPORARY(result, name, parameters, arguments, failed, answer)       \
  REHEARSE_INTERPOSED(result, name, parameters) {                                          \
    char* const wanted = path;                                                             \
    if (!watching()) return next_##name.get() arguments;                                   \
    const Caller caller = note(source_of::name, #name, path, __builtin_return_address(0)); \
    Located located(caller, AT_FDCWD, path, Use::change);                                  \
    if (!located.is_copy()) return next_##name.get() arguments;                            \
    path = located.text();                                                                 \
    const result made = next_##name.get() arguments;                                       \
    if (made != failed) memcpy(wanted + strlen(wanted) - 6, path + strlen(path) - 6, 6);   \
    return answer;                                                                         \
  }
REHEARSE_MADE_TEMPORARY(int, mkstemp, (char* path), (path), -1, made)
REHEARSE_MADE_TEMPORARY(int, mkstemp64, (char* path), (path), -1, made)
REHEARSE_MADE_TEMPORARY(int, mkostemp, (char* path, int flags), (path, flags), -1, made)
REHEARSE_MADE_TEMPORARY(char*, mkdtemp, (char* path), (path), nullptr, made ? wanted : nullptr)
#undef REHEARSE_MADE_TEMPORARY

// Shared memory is a file like any other.
REHEARSE_INTERPOSED(int, shm_open, (const char* name, int flags, mode_t mode)) {
  if (!watching()) return next_shm_open.get()(name, flags, mode);
  const Caller caller = note(source_of::shm_open, "shm_open", name, __builtin_return_address(0));
  char path[PATH_MAX];
  snprintf(path, sizeof path, "/dev/shm/%s", name + strspn(name, "/"));
  const Located located(caller, AT_FDCWD, path, use_of(flags));
  if (!located.is_copy()) return next_shm_open.get()(name, flags, mode);
  const Busy busy;
  return now_controllers(open(located, flags | O_CLOEXEC, mode));
}
REHEARSE_INTERPOSED(int, shm_unlink, (const char* name)) {
  if (!watching()) return next_shm_unlink.get()(name);
  const Caller caller = note(source_of::shm_unlink, "shm_unlink", name, __builtin_return_address(0));
  char path[PATH_MAX];
  snprintf(path, sizeof path, "/dev/shm/%s", name + strspn(name, "/"));
  const Removal removal(caller, AT_FDCWD, path);
  if (removal.is_done()) return 0;
  if (!removal.is_copy()) return next_shm_unlink.get()(name);
  const Busy busy;
  return unlink(removal);
}
// NOLINTEND(bugprone-macro-parentheses)

REHEARSE_NOTED(int, mq_open, (const char* name, int flags, mode_t mode, void* attributes),
               (name, flags, mode, attributes), name)
REHEARSE_NOTED(int, shmget, (int key, size_t size, int flags), (key, size, flags), Digits(key))
REHEARSE_NOTED(int, semget, (int key, int count, int flags), (key, count, flags), Digits(key))
REHEARSE_NOTED(int, msgget, (int key, int flags), (key, flags), Digits(key))

REHEARSE_NOTED(int, glob, (const char* pattern, int flags, int (*failed)(const char*, int), void* found),
               (pattern, flags, failed, found), pattern)
REHEARSE_NOTED(int, glob64, (const char* pattern, int flags, int (*failed)(const char*, int), void* found),
               (pattern, flags, failed, found), pattern)

REHEARSE_NOTED(int, wordexp, (const char* words, void* found, int flags), (words, found, flags), words)
REHEARSE_NOTED(ssize_t, getdents64, (int folder, void* entries, size_t size), (folder, entries, size),
               StatedName(folder, ""))
REHEARSE_NOTED(void*, shmat, (int id, const void* address, int flags), (id, address, flags), Digits(id))

REHEARSE_NOTED(int, getifaddrs, (void** result), (result), "")
REHEARSE_NOTED(int, socket, (int domain, int type, int protocol), (domain, type, protocol), "")
REHEARSE_NOTED(int, connect, (int file, const sockaddr* address, socklen_t size), (file, address, size), "")
REHEARSE_NOTED(int, bind, (int file, const sockaddr* address, socklen_t size), (file, address, size), "")
REHEARSE_NOTED(int, getaddrinfo, (const char* node, const char* service, const addrinfo* hints, addrinfo** result),
               (node, service, hints, result), node)
REHEARSE_NOTED(hostent*, gethostbyname, (const char* name), (name), name)

}  // namespace rehearse::interposer
