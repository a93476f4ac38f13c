/* The ring in shared memory between a tap in a robot's loop, which writes, and `rehearse tap`, which reads. Internal.
 *
 * The memory has a head, the definitions of the series as lines of text, and the ring: a power of two of 64-bit words.
 * A record has the data of one tick; the place of its word i is (place of the record + i) modulo the ring's size.
 * Places only grow: `written` is the end of the newest whole record, `oldest` the begin of the oldest one.
 *
 * The writer never waits. To make room it first moves `oldest` behind the records that it overwrites:
 *   W1 store oldest, relaxed     W2 release fence     W3 store the words, relaxed     W4 store written, release
 * The reader copies the record at its own place, and then looks whether the writer has overtaken it:
 *   R1 load written, acquire     R2 load the words, relaxed     R3 acquire fence     R4 load oldest, relaxed
 * It keeps the copy if `oldest` isn't behind the record's begin.
 *
 * Proof. A word of a copy may be wrong in two ways.
 * 1. It is older than the record: R1 read a value of W4 of the record or of a later one. W4 releases and R1 acquires,
 *    so W3 of the record happens before R2, which can't return an older value of the word.
 * 2. It is newer than the record: R2 returned a value that W3 stored for a later record. This record needs the place,
 *    so its writer has moved `oldest` behind the begin of the copied record (W1), then passed the fence W2. R2 read a
 *    value that was stored behind the fence W2, and the fence R3 follows R2, so W2 synchronises with R3: R4 returns
 *    the value of W1 or a later one, which is behind the record's begin. The copy is thrown away.
 * A loop that is killed between W1 and W4 leaves all records between `oldest` and `written` whole.
 * tests/controllers/tap_ring_test.cpp lets each load return each value that the memory model of C permits.
 *
 * C99 with the compilers' __atomic functions, or C++. */
#ifndef REHEARSE_TAP_RING_H
#define REHEARSE_TAP_RING_H

#include <stdint.h>

/* A test replaces them. */
#ifndef TAP_LOAD
#define TAP_LOAD(place) __atomic_load_n(place, __ATOMIC_RELAXED)
#define TAP_LOAD_ACQUIRE(place) __atomic_load_n(place, __ATOMIC_ACQUIRE)
#define TAP_STORE(place, value) __atomic_store_n(place, value, __ATOMIC_RELAXED)
#define TAP_STORE_RELEASE(place, value) __atomic_store_n(place, value, __ATOMIC_RELEASE)
#define TAP_FENCE_ACQUIRE() __atomic_thread_fence(__ATOMIC_ACQUIRE)
#define TAP_FENCE_RELEASE() __atomic_thread_fence(__ATOMIC_RELEASE)
#endif

#define TAP_MAGIC UINT64_C(0x3150415452534852) /* "RHSRTAP1" */
#define TAP_VERSION 1

enum {
  tap_definitions_place = 4096,      /* of the definitions in the memory [bytes] */
  tap_definitions_capacity = 520192, /* [bytes] */
  tap_words_place = 524288,          /* of the ring in the memory [bytes] */
  tap_most_record_words = 16384,     /* of one record */
  tap_record_head_words = 4,         /* size and kind, tick, hash, time of the loop */
  tap_longest_name = 64,             /* of a tap [bytes] */
  tap_path_size = 1024               /* of a model's file [bytes], with its end */
};

/* Locks of the memory's file (fcntl), which the kernel releases when a process ends: bytes of the file. */
enum { tap_lock_of_writer = 0, tap_lock_of_reader = 1 };

/* Entries of a record: a word with kind, series and number of the words that follow. */
enum {
  tap_values = 1,   /* the numbers of a series */
  tap_absent = 2,   /* the series has no new numbers in this tick */
  tap_variable = 3, /* a number, then the name as bytes */
  tap_text = 4,     /* a line, as bytes */
  tap_mark = 5,     /* a mark, and its reason as bytes */
  tap_image = 6     /* a device's name as bytes, then the name of its picture as bytes */
};

/* Bytes are a word with their count, and the words that contain them. */

typedef struct tap_ring_head {
  uint64_t magic; /* set last: the head before it is whole */
  uint32_t version;
  uint32_t head_size;     /* of this struct [bytes] */
  uint64_t words;         /* of the ring: a power of two */
  uint64_t process_start; /* of the loop, since the machine's start [clock ticks] */
  uint64_t monotonic_ns;  /* CLOCK_MONOTONIC and CLOCK_REALTIME at one moment */
  uint64_t realtime_ns;
  double time_step; /* [s] */
  double seconds;   /* of a black box [s] */
  int32_t pid;
  uint32_t is_locked; /* 1: the memory can't be swapped out */
  char controller[128];
  char model[tap_path_size]; /* an absolute path; empty: none */
  uint64_t hash;             /* of all before it but the magic */

  /* Written by the loop. */
  uint64_t oldest __attribute__((aligned(64)));
  uint64_t written;
  uint64_t dropped; /* ticks that were overwritten before the reader took them, or weren't ended */
  uint64_t refused; /* calls that broke a rule */
  uint64_t is_closed;
  uint64_t definitions_size; /* [bytes] */
  uint64_t definitions_hash;

  /* Written by the reader. */
  uint64_t read __attribute__((aligned(64))); /* ticks before this place were taken; all ones: none counts as dropped */
  uint64_t saved;                             /* ticks before this place are in a file */
} tap_ring_head;

/* Hashes, by which damage is found. */
static inline uint64_t tap_mix(uint64_t lane, uint64_t word) {
  lane = (lane ^ word) * UINT64_C(0x9E3779B97F4A7C15);
  return lane ^ (lane >> 29);
}

/* Of words; four lanes, because a multiplication has to wait for the one before it. */
static inline uint64_t tap_hash(const uint64_t* words, uint64_t count) {
  uint64_t a = 1, b = 2, c = 3, d = count;
  for (; count >= 4; count -= 4, words += 4) {
    a = tap_mix(a, words[0]);
    b = tap_mix(b, words[1]);
    c = tap_mix(c, words[2]);
    d = tap_mix(d, words[3]);
  }
  if (count > 0) a = tap_mix(a, words[0]);
  if (count > 1) b = tap_mix(b, words[1]);
  if (count > 2) c = tap_mix(c, words[2]);
  return tap_mix(tap_mix(tap_mix(a, b), c), d);
}

/* Of a record, whose own word is left out. */
static inline uint64_t tap_record_hash(const uint64_t* record, uint64_t count) {
  return tap_mix(tap_mix(tap_hash(record + 3, count - 3), record[0]), record[1]);
}

/* The writer's own view of the ring. */
typedef struct tap_ring_writer {
  tap_ring_head* head;
  uint64_t* words;
  uint64_t size; /* of the ring [words] */
  uint64_t oldest, written, dropped;
} tap_ring_writer;

/* Appends a record, whose first word has its size in the low half. It must fit into the ring. */
static inline void tap_ring_publish(tap_ring_writer* ring, const uint64_t* record, uint64_t count) {
  const uint64_t mask = ring->size - 1, begin = ring->written, end = begin + count;
  uint64_t i;
  if (end - ring->oldest > ring->size) {
    const uint64_t read = TAP_LOAD(&ring->head->read);
    do {
      const uint64_t old = TAP_LOAD(&ring->words[ring->oldest & mask]) & UINT32_MAX;
      if (old == 0 || old > ring->written - ring->oldest) { /* another program has written into the memory */
        ring->oldest = ring->written;
        break;
      }
      if (ring->oldest >= read) ++ring->dropped;
      ring->oldest += old;
    } while (end - ring->oldest > ring->size);
    TAP_STORE(&ring->head->dropped, ring->dropped);
    TAP_STORE(&ring->head->oldest, ring->oldest);
    TAP_FENCE_RELEASE();
  }
  for (i = 0; i < count; ++i) TAP_STORE(&ring->words[(begin + i) & mask], record[i]);
  ring->written = end;
  TAP_STORE_RELEASE(&ring->head->written, end);
}

enum tap_taken {
  tap_nothing,   /* no record is there */
  tap_record,    /* a whole one, whose hash isn't checked so far */
  tap_overtaken, /* the writer has overwritten the place; the reader's place is now that of the oldest record */
  tap_damaged    /* the size can't be that of a record */
};

/* A ring in which only a tap has written has written - oldest <= size at each moment, and R4 returns a value of
 * `oldest` that isn't older than W1 of the record of which R1 read W4. So a copy that is kept begins at most `size`
 * words before the value of R1; otherwise something else has written into the ring. The check bounds the number of
 * records that a reader finds in a hostile ring. */

/* Copies the record at *place, and moves *place behind it. `room`: of `record` [words]. */
static inline enum tap_taken tap_ring_take(tap_ring_head* head, uint64_t* words, uint64_t size, uint64_t* place,
                                           uint64_t* record, uint64_t room, uint64_t* count) {
  const uint64_t mask = size - 1, written = TAP_LOAD_ACQUIRE(&head->written), begin = *place;
  uint64_t i, oldest, first;
  if (begin >= written) {
    oldest = TAP_LOAD(&head->oldest);
    if (oldest <= begin) return tap_nothing;
    *place = oldest;
    return tap_overtaken;
  }
  first = TAP_LOAD(&words[begin & mask]);
  *count = first & UINT32_MAX;
  if (*count >= tap_record_head_words && *count <= room && *count <= written - begin && written - begin <= size) {
    record[0] = first;
    for (i = 1; i < *count; ++i) record[i] = TAP_LOAD(&words[(begin + i) & mask]);
  } else {
    *count = 0;
  }
  TAP_FENCE_ACQUIRE();
  oldest = TAP_LOAD(&head->oldest);
  if (oldest > begin) {
    *place = oldest;
    return tap_overtaken;
  }
  if (*count == 0) return tap_damaged;
  *place = begin + *count;
  return tap_record;
}

#endif
