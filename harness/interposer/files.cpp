// Files and networks: with their names, and what was in a file when it was opened for reading.
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "descriptors.h"
#include "next.h"
#include "random_stream.h"
#include "watching.h"

namespace rehearse::interposer {
namespace {

using RealOpen = int(int folder, const char* path, int flags, unsigned mode);
Next<RealOpen> real_openat{"openat"};

constexpr int64_t most_digested = 64 << 20;  // [bytes] of a file; more is told by the size alone

/// "214 bytes 8c7dd922ad47494f"; empty: no ordinary file, or none that can be read.
struct Digest {
  char text[64] = "";

  Digest(int folder, const char* path) {
    if (!path || strncmp(path, "/proc/", 6) == 0 || strncmp(path, "/sys/", 5) == 0) return;
    const Busy busy;
    const int errno_before = errno;
    // O_NONBLOCK: opening a pipe would wait for its other end
    const int file = real_openat.get()(folder, path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC, 0);
    struct stat status {};
    if (file >= 0 && fstat(file, &status) == 0 && S_ISREG(status.st_mode)) read_all(file, status.st_size);
    if (file >= 0) close(file);
    errno = errno_before;
  }

 private:
  void read_all(int file, int64_t size) {
    XXH3_state_t state;
    XXH3_64bits_reset(&state);
    char bytes[16384];
    int64_t left = most_digested;
    for (ssize_t count; left > 0 && (count = read(file, bytes, sizeof bytes)) > 0; left -= count)
      XXH3_64bits_update(&state, bytes, static_cast<size_t>(count));
    snprintf(text, sizeof text, "%lld bytes %016llx", static_cast<long long>(size),
             static_cast<unsigned long long>(XXH3_64bits_digest(&state)));
  }
};

bool is_random_device(const char* path) {
  return path && (strcmp(path, "/dev/urandom") == 0 || strcmp(path, "/dev/random") == 0);
}

// Who opens what: noted with the file's digest if it is going to be read.
Caller note_opening(const char* function, int folder, const char* path, bool reading, void* return_address) {
  if (is_random_device(path)) return note(Source::random, function, path, return_address);
  if (!reading) return note(Source::file, function, path, return_address);
  const Digest digest(folder, path);
  return note(Source::file, function, path, return_address, digest.text);
}

bool reads(int flags) { return (flags & O_ACCMODE) != O_WRONLY && !(flags & (O_TRUNC | O_DIRECTORY)); }
bool reads(const char* mode) { return mode && (mode[0] == 'r' || strchr(mode, '+')) && mode[0] != 'w'; }

/// The descriptor, or -2: open what was asked for.
int open_instead(const Caller& caller, const char* path) {
  if (!is_random_device(path) || !substitution_for(caller).has_seed) return -2;
  return open_random_file(substitution_for(caller).seed);
}

FILE* fopen_instead(const Caller& caller, const char* path, const char* mode) {
  const int descriptor = open_instead(caller, path);
  return descriptor < 0 ? nullptr : fdopen(descriptor, mode);
}

}  // namespace

// NOLINTBEGIN(bugprone-macro-parentheses): a list of arguments has its own

// Their third or fourth parameter is there only if a file may be created. Passing it on when it isn't passes on what is
// in its register, at which nobody looks.
#define REHEARSE_OPENED(name, parameters, arguments, folder, reading)                              \
  REHEARSE_INTERPOSED(int, name, parameters) {                                                     \
    if (!watching()) return next_##name.get() arguments;                                           \
    const Caller caller = note_opening(#name, folder, path, reading, __builtin_return_address(0)); \
    const int instead = open_instead(caller, path);                                                \
    return now_controllers(instead == -2 ? next_##name.get() arguments : instead);                 \
  }
REHEARSE_OPENED(open, (const char* path, int flags, unsigned mode), (path, flags, mode), AT_FDCWD, reads(flags))
REHEARSE_OPENED(open64, (const char* path, int flags, unsigned mode), (path, flags, mode), AT_FDCWD, reads(flags))
REHEARSE_OPENED(openat, (int folder, const char* path, int flags, unsigned mode), (folder, path, flags, mode), folder,
                reads(flags))
REHEARSE_OPENED(openat64, (int folder, const char* path, int flags, unsigned mode), (folder, path, flags, mode), folder,
                reads(flags))
REHEARSE_OPENED(__open_2, (const char* path, int flags), (path, flags), AT_FDCWD, reads(flags))
REHEARSE_OPENED(__open64_2, (const char* path, int flags), (path, flags), AT_FDCWD, reads(flags))
REHEARSE_OPENED(__openat_2, (int folder, const char* path, int flags), (folder, path, flags), folder, reads(flags))
REHEARSE_OPENED(__openat64_2, (int folder, const char* path, int flags), (folder, path, flags), folder, reads(flags))
REHEARSE_OPENED(creat, (const char* path, unsigned mode), (path, mode), AT_FDCWD, false)
REHEARSE_OPENED(creat64, (const char* path, unsigned mode), (path, mode), AT_FDCWD, false)
#undef REHEARSE_OPENED

#define REHEARSE_FILE_OPENED(name, parameters, arguments)                                                \
  REHEARSE_INTERPOSED(FILE*, name, parameters) {                                                         \
    if (!watching()) return next_##name.get() arguments;                                                 \
    const Caller caller = note_opening(#name, AT_FDCWD, path, reads(mode), __builtin_return_address(0)); \
    FILE* const instead = fopen_instead(caller, path, mode);                                             \
    return instead ? instead : next_##name.get() arguments;                                              \
  }
REHEARSE_FILE_OPENED(fopen, (const char* path, const char* mode), (path, mode))
REHEARSE_FILE_OPENED(fopen64, (const char* path, const char* mode), (path, mode))
#undef REHEARSE_FILE_OPENED
// NOLINTEND(bugprone-macro-parentheses)

REHEARSE_NOTED(file, FILE*, freopen, (const char* path, const char* mode, FILE* file), (path, mode, file), path)
REHEARSE_NOTED(file, FILE*, freopen64, (const char* path, const char* mode, FILE* file), (path, mode, file), path)
REHEARSE_NOTED(file, DIR*, opendir, (const char* path), (path), path)
REHEARSE_NOTED(file, int, stat, (const char* path, struct stat* status), (path, status), path)
REHEARSE_NOTED(file, int, stat64, (const char* path, struct stat64* status), (path, status), path)
REHEARSE_NOTED(file, int, lstat, (const char* path, struct stat* status), (path, status), path)
REHEARSE_NOTED(file, int, lstat64, (const char* path, struct stat64* status), (path, status), path)
REHEARSE_NOTED(file, int, fstatat, (int folder, const char* path, struct stat* status, int flags),
               (folder, path, status, flags), path)
REHEARSE_NOTED(file, int, fstatat64, (int folder, const char* path, struct stat64* status, int flags),
               (folder, path, status, flags), path)
REHEARSE_NOTED(file, int, statx, (int folder, const char* path, int flags, unsigned mask, void* status),
               (folder, path, flags, mask, status), path)
REHEARSE_NOTED(file, int, access, (const char* path, int mode), (path, mode), path)
REHEARSE_NOTED(file, ssize_t, readlink, (const char* path, char* to, size_t size), (path, to, size), path)
REHEARSE_NOTED(file, char*, realpath, (const char* path, char* to), (path, to), path)
REHEARSE_NOTED(file, int, unlink, (const char* path), (path), path)
REHEARSE_NOTED(file, int, remove, (const char* path), (path), path)
REHEARSE_NOTED(file, int, rename, (const char* from, const char* to), (from, to), from)
REHEARSE_NOTED(file, int, mkdir, (const char* path, mode_t mode), (path, mode), path)
REHEARSE_NOTED(file, int, rmdir, (const char* path), (path), path)
REHEARSE_NOTED(file, int, truncate, (const char* path, off_t length), (path, length), path)
REHEARSE_NOTED(file, FILE*, tmpfile, (), (), "")
REHEARSE_NOTED(file, FILE*, tmpfile64, (), (), "")
REHEARSE_NOTED(file, int, mkstemp, (char* path), (path), path)
REHEARSE_NOTED(file, int, mkstemp64, (char* path), (path), path)
REHEARSE_NOTED(file, char*, mkdtemp, (char* path), (path), path)
REHEARSE_NOTED(file, int, shm_open, (const char* name, int flags, mode_t mode), (name, flags, mode), name)

REHEARSE_NOTED(file, int, mq_open, (const char* name, int flags, mode_t mode, void* attributes),
               (name, flags, mode, attributes), name)
REHEARSE_NOTED(file, int, shmget, (int key, size_t size, int flags), (key, size, flags), Digits(key))

REHEARSE_NOTED(network, int, getifaddrs, (void** result), (result), "")
REHEARSE_NOTED(network, int, socket, (int domain, int type, int protocol), (domain, type, protocol), "")
REHEARSE_NOTED(network, int, connect, (int file, const sockaddr* address, socklen_t size), (file, address, size), "")
REHEARSE_NOTED(network, int, bind, (int file, const sockaddr* address, socklen_t size), (file, address, size), "")
REHEARSE_NOTED(network, int, getaddrinfo,
               (const char* node, const char* service, const addrinfo* hints, addrinfo** result),
               (node, service, hints, result), node)
REHEARSE_NOTED(network, hostent*, gethostbyname, (const char* name), (name), name)

}  // namespace rehearse::interposer
