#include "call_table.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace rehearse::interposer {
namespace {

constexpr uint32_t table_size = 4 * max_entries;
constexpr int most_arguments = 32;  // of one function at one place; further ones are "..."
constexpr int most_spins = 10'000'000;

Log* mapped = nullptr;
uint32_t entry_by_key[table_size];  // index of the entry + 1; 0: free
uint8_t arguments_at[table_size];   // number of entries of a function at a place
int locked = 0;

/// A crash or a hang may have interrupted the thread that holds the lock, so there is a limit for waiting.
class Lock {
 public:
  Lock() {
    for (int spins = 0; spins < most_spins; ++spins)
      if (!__atomic_exchange_n(&locked, 1, __ATOMIC_ACQUIRE)) {
        held_ = true;
        return;
      }
  }
  ~Lock() {
    if (held_) __atomic_store_n(&locked, 0, __ATOMIC_RELEASE);
  }
  bool held() const { return held_; }

 private:
  bool held_ = false;
};

uint64_t hash_of(const char* text, uint64_t seed) { return XXH3_64bits_withSeed(text, strlen(text), seed); }

TextOffset keep(const char* text) {
  if (!*text) return 0;
  const uint32_t size = static_cast<uint32_t>(strnlen(text, 4095)) + 1;
  if (size > heap_size - mapped->heap_used) {
    mapped->overflowed = 1;
    return 0;
  }
  const TextOffset offset = mapped->heap_used;
  memcpy(mapped->heap + offset, text, size - 1);  // the remaining heap is zero
  mapped->heap_used += size;
  return offset;
}

LogEntry* find(uint64_t key, uint32_t& slot) {
  for (slot = static_cast<uint32_t>(key % table_size); entry_by_key[slot]; slot = (slot + 1) % table_size)
    if (mapped->entry[entry_by_key[slot] - 1].key == key) return &mapped->entry[entry_by_key[slot] - 1];
  return nullptr;
}

}  // namespace

void open_log(const char* file) {
  const int descriptor = open(file, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  // Allocates all blocks at once: otherwise a full disk would raise SIGBUS inside of a controller.
  if (descriptor >= 0 && posix_fallocate(descriptor, 0, sizeof(Log)) == 0) {
    void* memory = mmap(nullptr, sizeof(Log), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    if (memory != MAP_FAILED) mapped = static_cast<Log*>(memory);
  }
  if (descriptor >= 0) close(descriptor);
  if (!mapped) {
    dprintf(STDERR_FILENO, "rehearse_interposer: can't write the log %s\n", file);
    return;
  }
  memcpy(mapped->magic, log_magic, sizeof log_magic);
  mapped->heap_used = 1;  // the empty text
}

void say_that_calls_are_hidden() {
  if (mapped) mapped->hidden = 1;
}

LogEntry* log_call(Source source, const char* function, const char* argument, const char* digest,
                   const char* controller, const char* phase, int64_t tick, const Caller& caller) {
  if (!mapped) return nullptr;
  const uint64_t where =
      hash_of(caller.module, caller.offset) ^ hash_of(function, hash_of(controller, hash_of(phase, 1)));
  uint64_t key = hash_of(argument, hash_of(digest, where));
  const Lock lock;
  if (!lock.held()) return nullptr;
  uint32_t slot = 0;
  LogEntry* entry = find(key, slot);
  if (!entry && arguments_at[where % table_size] >= most_arguments) {
    argument = "...";
    digest = "";
    key = hash_of(argument, hash_of(digest, where));
    entry = find(key, slot);
  }
  const bool is_new = !entry;
  if (is_new) {
    if (mapped->entries == max_entries) {
      mapped->overflowed = 1;
      return nullptr;
    }
    entry = &mapped->entry[mapped->entries];
    entry->source = static_cast<uint32_t>(source);
    entry->function = keep(function);
    entry->argument = keep(argument);
    entry->controller = keep(controller);
    entry->phase = keep(phase);
    entry->digest = keep(digest);
    entry->first_tick = tick;
    entry->key = key;
    entry->place = {keep(caller.module), 0, caller.offset};
    entry->chain_length = caller.chain_length;
    for (uint32_t i = 0; i < caller.chain_length; ++i)
      entry->chain[i] = {keep(caller.chain[i].module), 0, caller.chain[i].offset};
    entry_by_key[slot] = ++mapped->entries;
    ++arguments_at[where % table_size];
  }
  entry->last_tick = tick;
  ++entry->count;
  return is_new ? entry : nullptr;
}

}  // namespace rehearse::interposer
