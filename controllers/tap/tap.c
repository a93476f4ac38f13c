/* The writing side of a tap: rehearse/tap.h. The ring and its proof are in rehearse/tap_ring.h. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <link.h>
#include <rehearse/tap.h>
#include <rehearse/tap_ring.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { most_series = 256, longest_text = 4096, longest_reason = 200, path_size = 160 };

struct rehearse_tap {
  tap_ring_writer ring;
  uint64_t* record; /* of the tick */
  uint64_t count;   /* of its words so far; 0: no tick has begun */
  uint64_t tick;    /* the next one */
  unsigned char* memory;
  size_t memory_size;
  char name[tap_longest_name + 1];
  int descriptor;
  int is_mine;             /* the file of that name is this ring */
  pid_t process, recorder; /* the recorder that it has started; 0: none */
  int has_begun;           /* the series are fixed */
  int has_program;         /* the facts of the program are stated */
  int series;
  char body[208];               /* of all series; empty: there is none */
  uint32_t counts[most_series]; /* of their numbers */
  char reason[longest_reason + 1];
  int is_marked; /* the next tick has the reason of a mark */
  struct rehearse_tap* next;
};

static char last_error[1024];
static rehearse_tap* opened; /* of this process */
/* Of the tick that this thread has begun. In the static part of thread-local memory, which is never allocated later. */
static __thread rehearse_tap* current __attribute__((tls_model("initial-exec")));

__attribute__((format(printf, 1, 2))) static int fail(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(last_error, sizeof last_error, format, arguments);
  va_end(arguments);
  return -1;
}

const char* rehearse_tap_error(void) { return last_error; }

static int is_name(const char* text) {
  const size_t length = text ? strlen(text) : 0;
  if (length == 0 || length > tap_longest_name) return 0;
  return strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.") == length;
}

/* False for a text that would end a line of the definitions, or a part of it. */
static int is_word(const char* text, size_t longest) {
  size_t i;
  if (!text || !*text) return 0;
  for (i = 0; text[i]; ++i)
    if ((unsigned char)text[i] < ' ' || text[i] == 127 || i >= longest) return 0;
  return 1;
}

/* When the process started, since the machine's start [clock ticks]; 0: unknown. */
static uint64_t start_of(pid_t process) {
  char path[64], text[1024];
  const char* field;
  int i, file;
  ssize_t size;
  snprintf(path, sizeof path, "/proc/%d/stat", (int)process);
  file = open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  size = read(file, text, sizeof text - 1);
  close(file);
  if (size <= 0) return 0;
  text[size] = 0;
  field = strrchr(text, ')'); /* the name before it may have blanks */
  for (i = 0; field && i < 20; ++i) field = strchr(field + 1, ' ');
  return field ? strtoull(field + 1, NULL, 10) : 0;
}

static uint64_t clock_ns(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

/* Locks a byte of the file for this process. */
static int lock_byte(int descriptor, int byte) {
  struct flock lock;
  memset(&lock, 0, sizeof lock);
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = byte;
  lock.l_len = 1;
  return fcntl(descriptor, F_SETLK, &lock);
}

/* The process that has locked a byte of the file; 0: none but this one. */
static pid_t owner_of(int descriptor, int byte) {
  struct flock lock;
  memset(&lock, 0, sizeof lock);
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = byte;
  lock.l_len = 1;
  if (fcntl(descriptor, F_GETLK, &lock) != 0 || lock.l_type == F_UNLCK) return 0;
  return lock.l_pid;
}

/* Whether a tap of that name is open in this process, whose files must stay open: closing one would release its locks.
 */
static int has_tap(const char* name) {
  const rehearse_tap* tap = opened;
  while (tap && (tap->process != getpid() || strcmp(tap->name, name) != 0)) tap = tap->next;
  return tap != NULL;
}

/* Decides about a file that this process has locked as its writer. `reader`: the process that takes its ticks, or 0. */
static int give_up(const char* name, const char* path, const tap_ring_head* head, pid_t reader, int replace) {
  char before[path_size + 16];
  const int is_ring = head->magic == TAP_MAGIC && head->version == TAP_VERSION;
  /* Nothing is lost with a ring that its loop hasn't finished, that is in a file, or that a recorder has open. */
  if (head->magic == 0 || (is_ring && (reader != 0 || head->saved >= head->written))) {
    if (unlink(path) != 0) return fail("%s can't be removed: %s", path, strerror(errno));
    return 0;
  }
  if (!replace) {
    if (head->magic != TAP_MAGIC) return fail("%s is no ring of a tap; remove it, or set `replace`", path);
    if (!is_ring)
      return fail("the ring '%s' is of version %u, and this library writes version %d; remove %s, or set `replace`",
                  name, head->version, TAP_VERSION, path);
    return fail(
        "process %d, which has ended, left a ring '%s' with ticks that are in no recording; rehearse tap %s "
        "--recover saves them, or set `replace`, which keeps the ring as '%s.before'",
        (int)head->pid, name, name, name);
  }
  snprintf(before, sizeof before, "%s.before", path);
  if (rename(path, before) != 0) return fail("%s can't be renamed: %s", path, strerror(errno));
  return 0;
}

/* There is a file of that name: states what it is, removes it, or keeps it aside. 0: the name is free now. Of two
 * processes that come at the same time only one gets the lock. */
static int make_way(const char* name, const char* path, int replace) {
  tap_ring_head head;
  struct stat found, named;
  int result;
  const int descriptor = open(path, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) {
    if (errno == ENOENT) return 0;
    if (errno == ELOOP) return fail("%s is a link, and a tap follows none", path);
    return fail("%s is another user's, or no file: %s", path, strerror(errno));
  }
  if (fstat(descriptor, &found) != 0 || !S_ISREG(found.st_mode) || found.st_uid != geteuid() ||
      (found.st_mode & 077) != 0) {
    result = fail("%s is no ring of a tap: it belongs to another user, or others may open it", path);
  } else if (lock_byte(descriptor, tap_lock_of_writer) != 0) {
    result = fail("the tap '%s' is in use by process %d: each loop needs a name of its own", name,
                  (int)owner_of(descriptor, tap_lock_of_writer));
  } else if (lstat(path, &named) != 0 || named.st_dev != found.st_dev || named.st_ino != found.st_ino) {
    result = fail("another process opens the tap '%s' at the same time: each loop needs a name of its own", name);
  } else {
    memset(&head, 0, sizeof head);
    result = pread(descriptor, &head, sizeof head, 0) < 0
                 ? fail("%s can't be read: %s", path, strerror(errno))
                 : give_up(name, path, &head, owner_of(descriptor, tap_lock_of_reader), replace);
  }
  close(descriptor);
  return result;
}

static int write_head(tap_ring_head* head, const rehearse_tap_options* options, const char* name, uint64_t words) {
  const char* controller = options->controller ? options->controller : name;
  if (!is_word(controller, sizeof head->controller - 1) || strchr(controller, '/'))
    return fail("the controller's name '%s' has a '/' or a control character, or is too long", controller);
  snprintf(head->controller, sizeof head->controller, "%s", controller);
  head->time_step = options->time_step != 0 ? options->time_step : 0.001;
  head->seconds = options->seconds != 0 ? options->seconds : 60;
  if (!(head->time_step >= 1e-6 && head->time_step <= 10)) return fail("the time step isn't between 1 us and 10 s");
  if (!(head->seconds > 0 && head->seconds <= 1e6)) return fail("the length of a black box isn't positive");
  if (options->model) {
    char* path = realpath(options->model, NULL);
    if (!path) return fail("the model %s: %s", options->model, strerror(errno));
    if (strlen(path) >= sizeof head->model) {
      free(path);
      return fail("the path of the model %s is too long", options->model);
    }
    snprintf(head->model, sizeof head->model, "%s", path);
    free(path);
  }
  head->version = TAP_VERSION;
  head->head_size = sizeof *head;
  head->words = words;
  head->pid = (int32_t)getpid();
  head->process_start = start_of(getpid());
  head->monotonic_ns = clock_ns(CLOCK_MONOTONIC);
  head->realtime_ns = clock_ns(CLOCK_REALTIME);
  return 0;
}

/* Of the head, from the version on. */
static uint64_t hash_of_head(const tap_ring_head* head) {
  uint64_t words[offsetof(tap_ring_head, hash) / 8 - 1];
  memcpy(words, (const unsigned char*)head + 8, sizeof words);
  return tap_hash(words, sizeof words / 8);
}

static uint64_t hash_of_definitions(const unsigned char* text, uint64_t size) {
  uint64_t hash = size, word, i;
  for (i = 0; i < size; i += 8) {
    word = 0;
    memcpy(&word, text + i, size - i < 8 ? size - i : 8);
    hash = tap_mix(hash, word);
  }
  return hash;
}

/* Makes the file, maps it and touches it all. */
static int map_ring(rehearse_tap* tap, const char* path, uint64_t words) {
  struct stat made, named;
  int failed;
  tap->memory_size = tap_words_place + words * 8;
  tap->descriptor = open(path, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (tap->descriptor < 0) return fail("%s can't be made: %s", path, strerror(errno));
  if (lock_byte(tap->descriptor, tap_lock_of_writer) != 0 || fstat(tap->descriptor, &made) != 0 ||
      lstat(path, &named) != 0 || made.st_dev != named.st_dev || made.st_ino != named.st_ino)
    return fail("another process opens the tap '%s' at the same time: each loop needs a name of its own", tap->name);
  tap->is_mine = 1;
  failed = posix_fallocate(tap->descriptor, 0, (off_t)tap->memory_size);
  if (failed != 0)
    return fail("/dev/shm has no room for a ring of %llu MiB: %s", (unsigned long long)(words >> 17), strerror(failed));
  tap->memory = mmap(NULL, tap->memory_size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, tap->descriptor, 0);
  if (tap->memory == MAP_FAILED) {
    tap->memory = NULL;
    return fail("the ring can't be mapped: %s", strerror(errno));
  }
  memset(tap->memory, 0, tap->memory_size);
  return 0;
}

static void release(rehearse_tap* tap) {
  if (tap->memory) munmap(tap->memory, tap->memory_size);
  if (tap->descriptor >= 0) close(tap->descriptor);
  free(tap->record);
  free(tap);
}

/* Starts the recorder. It must not have the loop's priority, its processor, its blocked signals and its files. */
static int start_recorder(rehearse_tap* tap, const rehearse_tap_options* options) {
  char output[PATH_MAX];
  char* words[] = {"rehearse", "tap", tap->name, "-o", output, NULL, NULL};
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_t files;
  struct sched_param ordinary;
  sigset_t none, all;
  cpu_set_t before, processors;
  int failed;
  const int has_before = sched_getaffinity(0, sizeof before, &before) == 0;
  const int length = options->output ? snprintf(output, sizeof output, "%s", options->output)
                                     : snprintf(output, sizeof output, "%s.mcap", tap->name);
  if (length <= 0 || (size_t)length >= sizeof output) return fail("the path of the recorder's file is too long");
  if (options->spawn == REHEARSE_TAP_BLACK_BOX) words[5] = "--black-box";
  memset(&ordinary, 0, sizeof ordinary);
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_setschedpolicy(&attributes, SCHED_OTHER);
  posix_spawnattr_setschedparam(&attributes, &ordinary);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setflags(
      &attributes, POSIX_SPAWN_SETSCHEDULER | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSID);
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
#if defined __GLIBC__ && __GLIBC_PREREQ(2, 34)
  posix_spawn_file_actions_addclosefrom_np(&files, 3);
#endif
  memset(&processors, 0xff, sizeof processors);
  if (has_before) sched_setaffinity(0, sizeof processors, &processors);
  failed = posix_spawnp(&tap->recorder, words[0], &files, &attributes, words, environ);
  if (has_before) sched_setaffinity(0, sizeof before, &before);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (failed == 0) return 0;
  tap->recorder = 0;
  return fail("the recorder 'rehearse' can't be started: %s; it must be in a folder of PATH", strerror(failed));
}

static int define(rehearse_tap* tap, const char* const* words, size_t count);

static int state_fact(rehearse_tap* tap, const char* key, const char* value) {
  const char* const words[] = {"machine", key, value};
  return is_word(value, 4000) ? define(tap, words, 3) : 0;
}

/* Two digits a byte of the build id of a loaded object; empty: it has none. */
static void build_id_of(const struct dl_phdr_info* object, char* text, size_t size) {
  int i;
  text[0] = 0;
  for (i = 0; i < object->dlpi_phnum; ++i) {
    const unsigned char* at = (const unsigned char*)object->dlpi_addr + object->dlpi_phdr[i].p_vaddr;
    size_t left = object->dlpi_phdr[i].p_memsz;
    if (object->dlpi_phdr[i].p_type != PT_NOTE) continue;
    while (left >= sizeof(ElfW(Nhdr))) {
      ElfW(Nhdr) note;
      size_t name, all, k;
      memcpy(&note, at, sizeof note);
      name = sizeof note + (note.n_namesz + 3u) / 4 * 4;
      all = name + (note.n_descsz + 3u) / 4 * 4;
      if (all > left) break;
      if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4 && memcmp(at + sizeof note, "GNU", 4) == 0) {
        for (k = 0; k < note.n_descsz && 2 * k + 2 < size; ++k) snprintf(text + 2 * k, 3, "%02x", at[name + k]);
        return;
      }
      at += all;
      left -= all;
    }
  }
}

/* Of the program, which comes first, and of libm. */
static int state_object(struct dl_phdr_info* object, size_t size, void* data) {
  rehearse_tap* const tap = data;
  const char* const end = strrchr(object->dlpi_name, '/');
  const char* const file = end ? end + 1 : object->dlpi_name;
  const int is_libm = strncmp(file, "libm.so", 7) == 0 || strncmp(file, "libm-", 5) == 0;
  char id[96];
  (void)size;
  if (tap->has_program && !is_libm) return 0;
  build_id_of(object, id, sizeof id);
  if (!tap->has_program && state_fact(tap, "program_build_id", id) != 0) return -1;
  tap->has_program = 1;
  return is_libm ? state_fact(tap, "libm_build_id", id) : 0;
}

/* What decides the last bits of a loop's numbers, and identifies its program. */
static int state_machine(rehearse_tap* tap) {
  struct utsname machine;
  char program[PATH_MAX];
  const char* const tunables = getenv("GLIBC_TUNABLES");
  const ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
  if (length > 0) {
    program[length] = 0;
    if (state_fact(tap, "program", strrchr(program, '/') ? strrchr(program, '/') + 1 : program) != 0) return -1;
  }
  if (uname(&machine) == 0 && state_fact(tap, "architecture", machine.machine) != 0) return -1;
  if (tunables && state_fact(tap, "tunables", tunables) != 0) return -1;
  return dl_iterate_phdr(state_object, tap);
}

rehearse_tap* rehearse_tap_open(const char* name, const rehearse_tap_options* options) {
  static const rehearse_tap_options defaults;
  char path[path_size];
  uint64_t words = 1u << 16; /* half a MiB */
  uint64_t wanted;
  rehearse_tap* tap;
  tap_ring_head* head;
  if (!options) options = &defaults;
  wanted = (uint64_t)(options->megabytes ? options->megabytes : 64) << 17;
  last_error[0] = 0;
  if (!is_name(name)) {
    fail("the name of a tap has 1 to %d letters, digits, '-', '_' and '.'", tap_longest_name);
    return NULL;
  }
  if (wanted > UINT64_C(1) << 30) {
    fail("a ring of more than 8192 MiB isn't made");
    return NULL;
  }
  if (options->spawn < 0 || options->spawn > REHEARSE_TAP_BLACK_BOX) {
    fail("`spawn` is 0, REHEARSE_TAP_RECORDER or REHEARSE_TAP_BLACK_BOX");
    return NULL;
  }
  if (has_tap(name)) {
    fail("this process has a tap '%s' already", name);
    return NULL;
  }
  while (words < wanted) words *= 2;
  snprintf(path, sizeof path, "/dev/shm/rehearse-tap-%u-%s", (unsigned)geteuid(), name);
  if (make_way(name, path, options->replace) != 0) return NULL;
  tap = calloc(1, sizeof *tap);
  if (!tap) {
    fail("there is no memory");
    return NULL;
  }
  tap->descriptor = -1;
  tap->process = getpid();
  snprintf(tap->name, sizeof tap->name, "%s", name);
  tap->record = malloc(tap_most_record_words * 8);
  if (!tap->record) fail("there is no memory");
  if (!tap->record || map_ring(tap, path, words) != 0) {
    if (tap->is_mine) unlink(path);
    release(tap);
    return NULL;
  }
  memset(tap->record, 0, tap_most_record_words * 8); /* touches it */
  head = (tap_ring_head*)tap->memory;
  tap->ring.head = head;
  tap->ring.words = (uint64_t*)(tap->memory + tap_words_place);
  tap->ring.size = words;
  head->definitions_hash = hash_of_definitions(NULL, 0);
  if (write_head(head, options, name, words) != 0 || state_machine(tap) != 0) {
    unlink(path);
    release(tap);
    return NULL;
  }
  head->is_locked = mlock(tap->memory, tap->memory_size) == 0 && mlock(tap->record, tap_most_record_words * 8) == 0 &&
                    mlock(tap, sizeof *tap) == 0;
  head->hash = hash_of_head(head);
  TAP_STORE_RELEASE(&head->magic, TAP_MAGIC);
  if (options->spawn && start_recorder(tap, options) != 0) {
    unlink(path);
    release(tap);
    return NULL;
  }
  tap->next = opened;
  opened = tap;
  return tap;
}

void rehearse_tap_close(rehearse_tap* tap) {
  rehearse_tap** place = &opened;
  if (!tap) return;
  if (current == tap) current = NULL;
  if (tap->is_marked) { /* the reason of a mark behind the last tick */
    rehearse_tap_begin(tap, (int64_t)clock_ns(CLOCK_MONOTONIC));
    rehearse_tap_end(tap);
  }
  TAP_STORE_RELEASE(&tap->ring.head->is_closed, 1);
  if (tap->recorder > 0) waitpid(tap->recorder, NULL, WNOHANG); /* if it has ended */
  while (*place && *place != tap) place = &(*place)->next;
  if (*place) *place = tap->next;
  release(tap);
}

/* Appends a line to the definitions, and publishes them. */
static int define(rehearse_tap* tap, const char* const* words, size_t count) {
  tap_ring_head* const head = tap->ring.head;
  unsigned char* const text = tap->memory + tap_definitions_place;
  uint64_t size = head->definitions_size;
  size_t i;
  if (tap->has_begun) return fail("series are stated before the first tick");
  for (i = 0; i < count; ++i) {
    const size_t length = strlen(words[i]);
    if (size + length + 1 > tap_definitions_capacity)
      return fail("the names of the series are longer than %d bytes together", tap_definitions_capacity);
    memcpy(text + size, words[i], length);
    size += length;
    text[size++] = i + 1 < count ? '\t' : '\n';
  }
  head->definitions_hash = hash_of_definitions(text, size);
  TAP_STORE_RELEASE(&head->definitions_size, size);
  return 0;
}

/* The words of a line of the definitions, one after the other. */
typedef struct line_words {
  const char* at;
  const char* end; /* of the line */
} line_words;

static int next_word(line_words* line, const char** word, size_t* length) {
  const char* end;
  if (line->at >= line->end) return 0;
  end = memchr(line->at, '\t', (size_t)(line->end - line->at));
  if (!end) end = line->end;
  *word = line->at;
  *length = (size_t)(end - line->at);
  line->at = end + 1;
  return 1;
}

static int is_equal(const char* word, size_t length, const char* text) {
  return strlen(text) == length && memcmp(word, text, length) == 0;
}

/* Fails if an earlier series of the kind has one of the names, of joints with one of the quantities. */
static int check_is_new(const rehearse_tap* tap, const char* kind, const char* const* names, size_t count,
                        int quantities) {
  const char* const text = (const char*)tap->memory + tap_definitions_place;
  const char* const end = text + tap->ring.head->definitions_size;
  line_words line = {text, text};
  const char *word, *begin;
  size_t length, i;
  for (begin = text; begin < end; begin = line.end + 1) {
    line.at = begin;
    line.end = memchr(begin, '\n', (size_t)(end - begin));
    if (!next_word(&line, &word, &length) || !is_equal(word, length, kind)) continue;
    if (!next_word(&line, &word, &length)) continue; /* the body */
    if (quantities != 0 && (!next_word(&line, &word, &length) || (atoi(word) & quantities) == 0)) continue;
    while (next_word(&line, &word, &length))
      for (i = 0; i < count; ++i)
        if (is_equal(word, length, names[i])) return fail("'%s' is in an earlier series", names[i]);
  }
  return 0;
}

static int check_body(const rehearse_tap* tap, const char* body) {
  if (!is_word(body, 200) || strchr(body, '/')) return fail("the body's name is empty, or has a '/'");
  if (tap->body[0] && strcmp(tap->body, body) != 0)
    return fail("the series of a tap are of one body, '%s': open another tap for '%s'", tap->body, body);
  return 0;
}

static int add_series(rehearse_tap* tap, const char* const* words, size_t count, uint64_t numbers) {
  if (tap->series == most_series) return fail("a tap has at most %d series", most_series);
  if (numbers == 0 || numbers > tap_most_record_words / 2)
    return fail("a series has 1 to %d numbers", tap_most_record_words / 2);
  if (define(tap, words, count) != 0) return -1;
  snprintf(tap->body, sizeof tap->body, "%s", words[1]);
  tap->counts[tap->series] = (uint32_t)numbers;
  return tap->series++;
}

static int add_joints(rehearse_tap* tap, const char* kind, const char* body, const char* const* names, size_t count,
                      int quantities) {
  const int all = REHEARSE_TAP_Q | REHEARSE_TAP_DQ | REHEARSE_TAP_U;
  char mask[16];
  const char** words;
  uint64_t numbers = 0;
  size_t i, k;
  int bit, series;
  if (!tap) return -1;
  if (check_body(tap, body) != 0) return -1;
  if (quantities <= 0 || (quantities & ~all) != 0)
    return fail("the quantities are a sum of REHEARSE_TAP_Q, REHEARSE_TAP_DQ and REHEARSE_TAP_U");
  if (!names || count == 0 || count > 4096) return fail("a series has 1 to 4096 joints");
  for (i = 0; i < count; ++i) {
    if (!is_word(names[i], 200)) return fail("the name of joint %u is empty, or too long", (unsigned)i);
    for (k = 0; k < i; ++k)
      if (strcmp(names[i], names[k]) == 0) return fail("the joint '%s' is named twice", names[i]);
  }
  if (check_is_new(tap, kind, names, count, quantities) != 0) return -1;
  for (bit = 1; bit < all; bit *= 2) numbers += (quantities & bit) ? count : 0;
  words = malloc((count + 3) * sizeof *words);
  if (!words) return fail("there is no memory");
  snprintf(mask, sizeof mask, "%d", quantities);
  words[0] = kind;
  words[1] = body;
  words[2] = mask;
  for (i = 0; i < count; ++i) words[3 + i] = names[i];
  series = add_series(tap, words, count + 3, numbers);
  free(words);
  return series;
}

int rehearse_tap_joints(rehearse_tap* tap, const char* body, const char* const* names, size_t count, int quantities) {
  return add_joints(tap, "joints", body, names, count, quantities);
}

int rehearse_tap_commands(rehearse_tap* tap, const char* body, const char* const* names, size_t count, int quantities) {
  return add_joints(tap, "commands", body, names, count, quantities);
}

static int add_device(rehearse_tap* tap, const char* kind, const char* body, const char* device, size_t count) {
  char numbers[24];
  const char* words[4];
  if (!tap) return -1;
  if (check_body(tap, body) != 0) return -1;
  if (!is_word(device, 200)) return fail("the device's name is empty, or too long");
  if (check_is_new(tap, "imu", &device, 1, 0) != 0 || check_is_new(tap, "device", &device, 1, 0) != 0) return -1;
  snprintf(numbers, sizeof numbers, "%llu", (unsigned long long)count);
  words[0] = kind;
  words[1] = body;
  words[2] = device;
  words[3] = numbers;
  return add_series(tap, words, 4, count);
}

int rehearse_tap_device(rehearse_tap* tap, const char* body, const char* device, size_t count) {
  return add_device(tap, "device", body, device, count);
}

int rehearse_tap_imu(rehearse_tap* tap, const char* body, const char* device) {
  return add_device(tap, "imu", body, device, 6);
}

int rehearse_tap_parameter(rehearse_tap* tap, const char* key, const char* value) {
  const char* words[3];
  if (!tap) return 0;
  if (!is_word(key, 200) || !is_word(value, 4000))
    return fail("a parameter's key or value is empty, or has a new line");
  words[0] = "parameter";
  words[1] = key;
  words[2] = value;
  return define(tap, words, 3);
}

/* From here on nothing calls the system. */

static int refuse(rehearse_tap* tap) {
  uint64_t* const refused = &tap->ring.head->refused;
  TAP_STORE(refused, TAP_LOAD(refused) + 1);
  return -1;
}

/* Room for an entry of that many words behind its own; null: the tick is full, or none has begun. */
static uint64_t* add_entry(rehearse_tap* tap, unsigned kind, unsigned series, uint64_t words) {
  uint64_t* entry;
  if (tap->count == 0 || words > tap_most_record_words - 1 - tap->count) {
    refuse(tap);
    return NULL;
  }
  entry = tap->record + tap->count;
  entry[0] = (uint64_t)kind << 56 | (uint64_t)series << 32 | words;
  tap->count += 1 + words;
  return entry + 1;
}

/* A word with their number, and the words of the bytes. `room` is for the number of words that words_of() returns. */
static uint64_t words_of(size_t bytes) { return 1 + (bytes + 7) / 8; }
static void put_bytes(uint64_t* room, const char* bytes, size_t count) {
  room[0] = count;
  if (count > 0) room[(count + 7) / 8] = 0;
  memcpy(room + 1, bytes, count);
}

static size_t length_up_to(const char* text, size_t longest) {
  size_t length = 0;
  while (length < longest && text[length]) ++length;
  return length;
}

static void add_mark(rehearse_tap* tap) {
  const size_t length = length_up_to(tap->reason, longest_reason);
  uint64_t* entry = add_entry(tap, tap_mark, 0, words_of(length));
  if (entry) put_bytes(entry, tap->reason, length);
  tap->is_marked = 0;
}

void rehearse_tap_begin(rehearse_tap* tap, int64_t now_ns) {
  if (!tap) return;
  if (tap->count != 0) {
    TAP_STORE(&tap->ring.head->dropped, ++tap->ring.dropped);
    ++tap->tick;
  }
  tap->has_begun = 1;
  tap->record[1] = tap->tick;
  tap->record[3] = (uint64_t)now_ns;
  tap->count = tap_record_head_words;
  current = tap;
  if (tap->is_marked) add_mark(tap);
}

int rehearse_tap_write(rehearse_tap* tap, int series, const double* numbers, size_t count) {
  uint64_t* entry;
  if (!tap) return 0;
  if (series < 0 || series >= tap->series || count != tap->counts[series] || !numbers) return refuse(tap);
  entry = add_entry(tap, tap_values, (unsigned)series, count);
  if (!entry) return -1;
  memcpy(entry, numbers, count * sizeof *numbers);
  return 0;
}

int rehearse_tap_absent(rehearse_tap* tap, int series) {
  if (!tap) return 0;
  if (series < 0 || series >= tap->series) return refuse(tap);
  return add_entry(tap, tap_absent, (unsigned)series, 0) ? 0 : -1;
}

int rehearse_tap_variable(rehearse_tap* tap, const char* name, double value) {
  size_t length;
  uint64_t* entry;
  if (!tap) return 0;
  length = name ? length_up_to(name, longest_reason + 1) : 0;
  if (length == 0 || length > longest_reason) return refuse(tap);
  entry = add_entry(tap, tap_variable, 0, 1 + words_of(length));
  if (!entry) return -1;
  memcpy(entry, &value, sizeof value);
  put_bytes(entry + 1, name, length);
  return 0;
}

int rehearse_tap_text(rehearse_tap* tap, const char* text) {
  size_t length;
  uint64_t* entry;
  if (!tap) return 0;
  length = text ? length_up_to(text, longest_text + 1) : 0;
  if (length == 0 || length > longest_text) return refuse(tap);
  entry = add_entry(tap, tap_text, 0, words_of(length));
  if (!entry) return -1;
  put_bytes(entry, text, length);
  return 0;
}

int rehearse_tap_image(rehearse_tap* tap, const char* camera, const char* picture) {
  size_t length, length_of_picture;
  uint64_t* entry;
  if (!tap) return 0;
  length = camera ? length_up_to(camera, longest_reason + 1) : 0;
  length_of_picture = picture ? length_up_to(picture, longest_text + 1) : 0;
  if (length == 0 || length > longest_reason || length_of_picture == 0 || length_of_picture > longest_text)
    return refuse(tap);
  entry = add_entry(tap, tap_image, 0, words_of(length) + words_of(length_of_picture));
  if (!entry) return -1;
  put_bytes(entry, camera, length);
  put_bytes(entry + words_of(length), picture, length_of_picture);
  return 0;
}

void rehearse_tap_end(rehearse_tap* tap) {
  if (!tap || tap->count == 0) return;
  tap->record[0] = tap->count;
  tap->record[2] = tap_record_hash(tap->record, tap->count);
  tap_ring_publish(&tap->ring, tap->record, tap->count);
  tap->count = 0;
  ++tap->tick;
  if (current == tap) current = NULL;
}

void rehearse_tap_mark(rehearse_tap* tap, const char* reason) {
  size_t length;
  if (!tap) return;
  length = length_up_to(reason ? reason : "", longest_reason);
  memcpy(tap->reason, reason ? reason : "", length);
  tap->reason[length] = 0;
  if (tap->count != 0)
    add_mark(tap);
  else
    tap->is_marked = 1;
}

uint64_t rehearse_tap_dropped(const rehearse_tap* tap) { return tap ? tap->ring.dropped : 0; }

/* What rehearse_variable.h calls: a variable of the tick that this thread has begun. */
REHEARSE_TAP_FUNCTION void rehearse_record_variable(const char* name, double value);
void rehearse_record_variable(const char* name, double value) { rehearse_tap_variable(current, name, value); }
