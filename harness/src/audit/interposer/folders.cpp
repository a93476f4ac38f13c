// Lists of folders: opendir(), fdopendir() by which libstdc++ lists, scandir(), fts_open().
//
// The order of a list is the file system's. An imaginary machine has another: names that ascend or descend. Only lists
// of folders with absolute names get it; for the others an audit has another working folder.
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <fts.h>
#include <stdlib.h>
#include <string.h>

#include "descriptors.h"
#include "file_copies.h"
#include "next.h"
#include "watching.h"

namespace rehearse::interposer {
namespace {

using Entry = dirent;
using Entry64 = dirent64;

/// "." and ".." come first, as in the file systems of Linux.
bool is_dots(const char* name) { return strcmp(name, ".") == 0 || strcmp(name, "..") == 0; }

int ascending(const char* a, const char* b) {
  return is_dots(a) != is_dots(b) ? is_dots(b) - is_dots(a) : strcmp(a, b);
}
int descending(const char* a, const char* b) { return is_dots(a) || is_dots(b) ? ascending(a, b) : strcmp(b, a); }

/// The comparison of qsort() for entries of a list.
template <int compare(const char*, const char*)>
int by_name(const void* a, const void* b) {
  return compare((*static_cast<Entry64* const*>(a))->d_name, (*static_cast<Entry64* const*>(b))->d_name);
}

using Sorting = int (*)(const void*, const void*);

/// Even numbers are small machines, odd ones large machines.
Sorting sorting_on(int machine) { return machine % 2 == 0 ? by_name<ascending> : by_name<descending>; }

/// A list by a controller, which is logged. If the controller made the folder itself, it determined the entries, but
/// not their order: then the call has a digest.
struct Listing {
  Caller caller;
  int machine;  // its order; 0: the file system's

  Listing(const char* function, const StatedName& name, bool is_own, void* return_address)
      : caller(note(Source::file, function, name, return_address, is_own ? "made by the controller" : "")),
        machine(name.is_relative() && !is_own ? 0 : substitution_for(caller).machine) {}
};

/// A folder's stream whose entries are read at once, and sorted.
struct Sorted {
  DIR* stream;
  int machine;
  bool is_read = false;
  int error = 0;  // of the read
  long count = 0, next = 0;
  Entry64** entries = nullptr;

  void read(Entry64* (*read_next)(DIR*)) {
    const Busy busy;
    const int errno_before = errno;
    is_read = true;
    errno = 0;
    long room = 0;
    while (const Entry64* entry = read_next(stream)) {
      if (count == room) entries = static_cast<Entry64**>(realloc(entries, sizeof *entries * (room = 2 * room + 16)));
      entries[count] = static_cast<Entry64*>(malloc(entry->d_reclen));
      memcpy(entries[count++], entry, entry->d_reclen);
    }
    error = errno;
    qsort(entries, count, sizeof *entries, sorting_on(machine));
    errno = errno_before;
  }
  void forget() {
    for (long i = 0; i < count; ++i) free(entries[i]);
    free(entries);
    *this = {stream, machine};
  }
  Entry64* entry() {
    if (next < count) return entries[next++];
    if (error != 0) errno = error;
    return nullptr;
  }
};

constexpr int most_sorted = 256;  // streams open at a time
Sorted* sorted[most_sorted];
int sorted_count = 0;

Sorted** slot_of(const DIR* stream) {
  if (__atomic_load_n(&sorted_count, __ATOMIC_RELAXED) == 0) return nullptr;
  for (Sorted*& slot : sorted)
    if (const Sorted* one = __atomic_load_n(&slot, __ATOMIC_ACQUIRE); one && one->stream == stream) return &slot;
  return nullptr;
}

Sorted* sorted_of(const DIR* stream) {
  Sorted** const slot = slot_of(stream);
  return slot ? *slot : nullptr;
}

/// From now on the stream has the order of the machine.
DIR* sort(DIR* stream, int machine) {
  if (!stream || machine == 0) return stream;
  const Busy busy;
  Sorted* const added = static_cast<Sorted*>(malloc(sizeof(Sorted)));
  *added = {stream, machine};
  for (Sorted*& slot : sorted) {
    Sorted* none = nullptr;
    if (!__atomic_compare_exchange_n(&slot, &none, added, false, __ATOMIC_RELEASE, __ATOMIC_RELAXED)) continue;
    __atomic_add_fetch(&sorted_count, 1, __ATOMIC_RELEASE);
    return stream;
  }
  free(added);
  return stream;
}

}  // namespace

REHEARSE_INTERPOSED(DIR*, opendir, (const char* path)) {
  if (!watching()) return next_opendir.get()(path);
  void* const return_address = __builtin_return_address(0);
  const StatedName stated(AT_FDCWD, path);
  const Located located(find_caller(return_address), AT_FDCWD, path, Use::list);
  const Listing listing("opendir", stated, is_own_folder(located), return_address);
  DIR* const stream = next_opendir.get()(located);
  if (stream && stated.is_relative()) set_relative_name(dirfd(stream), stated);
  return sort(stream, listing.machine);
}

/// libstdc++ opens a folder by openat() and lists it by fdopendir().
REHEARSE_INTERPOSED(DIR*, fdopendir, (int folder)) {
  if (!watching()) return next_fdopendir.get()(folder);
  const Listing listing("fdopendir", StatedName(folder, ""), is_own_folder(folder), __builtin_return_address(0));
  return sort(next_fdopendir.get()(folder), listing.machine);
}

// NOLINTBEGIN(bugprone-macro-parentheses): a list of arguments has its own

// Each of these exists under two names with one meaning.
#define REHEARSE_STREAM(read_name, read_r_name, Entry)                                 \
  REHEARSE_INTERPOSED(Entry*, read_name, (DIR * stream)) {                             \
    Sorted* const list = sorted_of(stream);                                            \
    if (!list) return next_##read_name.get()(stream);                                  \
    if (!list->is_read) list->read(next_readdir64.get());                              \
    return reinterpret_cast<Entry*>(list->entry());                                    \
  }                                                                                    \
  REHEARSE_INTERPOSED(int, read_r_name, (DIR * stream, Entry * to, Entry * *result)) { \
    if (!sorted_of(stream)) return next_##read_r_name.get()(stream, to, result);       \
    const int errno_before = errno;                                                    \
    errno = 0;                                                                         \
    const Entry* const entry = interposed_##read_name(stream);                         \
    const int error = errno;                                                           \
    errno = errno_before;                                                              \
    if (entry) memcpy(to, entry, entry->d_reclen);                                     \
    *result = entry ? to : nullptr;                                                    \
    return entry ? 0 : error;                                                          \
  }
REHEARSE_STREAM(readdir64, readdir64_r, Entry64)
REHEARSE_STREAM(readdir, readdir_r, Entry)
#undef REHEARSE_STREAM

REHEARSE_INTERPOSED(void, rewinddir, (DIR * stream)) {
  if (Sorted* const list = sorted_of(stream)) list->forget();
  next_rewinddir.get()(stream);
}

REHEARSE_INTERPOSED(long, telldir, (DIR * stream)) {
  const Sorted* const list = sorted_of(stream);
  return list ? list->next : next_telldir.get()(stream);
}

REHEARSE_INTERPOSED(void, seekdir, (DIR * stream, long position)) {
  Sorted* const list = sorted_of(stream);
  if (!list) return next_seekdir.get()(stream, position);
  if (!list->is_read) list->read(next_readdir64.get());
  list->next = position < 0 ? 0 : position < list->count ? position : list->count;
}

REHEARSE_INTERPOSED(int, closedir, (DIR * stream)) {
  if (Sorted** const slot = slot_of(stream)) {
    const Busy busy;
    Sorted* const list = __atomic_exchange_n(slot, nullptr, __ATOMIC_ACQ_REL);
    __atomic_sub_fetch(&sorted_count, 1, __ATOMIC_RELEASE);
    list->forget();
    free(list);
  }
  if (stream) set_relative_name(dirfd(stream), "");
  return next_closedir.get()(stream);
}

/// Lists the folder in the machine's order, then sorts by the caller's comparison, which may count names as equal.
#define REHEARSE_SCANNED(name, parameters, arguments, folder)                                               \
  REHEARSE_INTERPOSED(int, name, parameters) {                                                              \
    if (!watching()) return next_##name.get() arguments;                                                    \
    void* const return_address = __builtin_return_address(0);                                               \
    const StatedName stated(folder, path);                                                                  \
    const Located located(find_caller(return_address), folder, path, Use::list);                            \
    const Listing listing(#name, stated, is_own_folder(located), return_address);                           \
    const auto wanted = order;                                                                              \
    path = located;                                                                                         \
    if (listing.machine > 0) order = nullptr;                                                               \
    const int count = next_##name.get() arguments;                                                          \
    if (listing.machine == 0 || count <= 0) return count;                                                   \
    qsort(*list, static_cast<size_t>(count), sizeof **list, sorting_on(listing.machine));                   \
    if (wanted) qsort(*list, static_cast<size_t>(count), sizeof **list, reinterpret_cast<Sorting>(wanted)); \
    return count;                                                                                           \
  }
template <class E>
using Choose = int (*)(const E*);
template <class E>
using Order = int (*)(const E**, const E**);
REHEARSE_SCANNED(scandir, (const char* path, Entry*** list, Choose<Entry> choose, Order<Entry> order),
                 (path, list, choose, order), AT_FDCWD)
REHEARSE_SCANNED(scandir64, (const char* path, Entry64*** list, Choose<Entry64> choose, Order<Entry64> order),
                 (path, list, choose, order), AT_FDCWD)
REHEARSE_SCANNED(scandirat, (int folder, const char* path, Entry*** list, Choose<Entry> choose, Order<Entry> order),
                 (folder, path, list, choose, order), folder)
REHEARSE_SCANNED(scandirat64,
                 (int folder, const char* path, Entry64*** list, Choose<Entry64> choose, Order<Entry64> order),
                 (folder, path, list, choose, order), folder)
#undef REHEARSE_SCANNED
// NOLINTEND(bugprone-macro-parentheses)

namespace {

using VisitOrder = int (*)(const FTSENT**, const FTSENT**);

/// The order of the entries of one folder; the paths that the caller gave keep theirs.
template <int compare(const char*, const char*)>
int in_tree(const FTSENT** a, const FTSENT** b) {
  return (*a)->fts_level <= FTS_ROOTLEVEL ? 0 : compare((*a)->fts_name, (*b)->fts_name);
}

/// Logs each of the paths, and returns the comparison for the walk.
VisitOrder note_tree(const char* function, char* const* paths, VisitOrder order, void* return_address) {
  const Caller caller = find_caller(return_address);
  bool has_absolute = false;
  for (char* const* path = paths; *path; ++path) {
    note(caller, Source::file, function, *path);
    has_absolute = has_absolute || **path == '/';
  }
  const int machine = has_absolute ? substitution_for(caller).machine : 0;
  if (order || machine == 0) return order;
  return machine % 2 == 0 ? in_tree<ascending> : in_tree<descending>;
}

}  // namespace

REHEARSE_INTERPOSED(FTS*, fts_open, (char* const* paths, int options, VisitOrder order)) {
  if (watching()) order = note_tree("fts_open", paths, order, __builtin_return_address(0));
  return next_fts_open.get()(paths, options, order);
}
REHEARSE_INTERPOSED(FTS*, fts64_open, (char* const* paths, int options, VisitOrder order)) {
  if (watching()) order = note_tree("fts64_open", paths, order, __builtin_return_address(0));
  return next_fts64_open.get()(paths, options, order);
}

}  // namespace rehearse::interposer
