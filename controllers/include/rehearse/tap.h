/* A tap: what a robot's loop reads and commands, tick by tick, recorded from inside the loop.
 *
 * The tap writes into a ring in shared memory. Another process, `rehearse tap NAME`, makes a recording of it. If the
 * loop's process is killed, all ticks that it has ended are in the ring.
 *
 *   rehearse_tap* tap = rehearse_tap_open("walker", &(rehearse_tap_options){.model = "walker.urdf"});
 *   int q = rehearse_tap_joints(tap, "Walker", names, 12, REHEARSE_TAP_Q | REHEARSE_TAP_DQ);
 *   int imu = rehearse_tap_imu(tap, "Walker", "Imu");
 *   int u = rehearse_tap_commands(tap, "Walker", names, 12, REHEARSE_TAP_U);
 *   for (;;) {
 *     rehearse_tap_begin(tap, now_ns);
 *     rehearse_tap_write(tap, q, q_dq, 24);
 *     rehearse_tap_write(tap, imu, gyro_acc, 6);
 *     control();
 *     rehearse_tap_write(tap, u, tau, 12);
 *     rehearse_tap_end(tap);
 *   }
 *
 * From rehearse_tap_begin() to rehearse_tap_end() nothing is allocated, nothing is locked, and the system isn't called.
 * Nothing waits: a tick that the reader hasn't taken is overwritten when the ring is full, and counted. All functions
 * accept a null tap, and do nothing then. A tap is used by one thread; taps are opened, given their series and closed
 * one after the other. A child of fork() must not use the taps of its parent.
 *
 * C99 or C++; <rehearse/tap.hpp> has a class for C++17. */
#ifndef REHEARSE_TAP_H
#define REHEARSE_TAP_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define REHEARSE_TAP_FUNCTION __attribute__((visibility("default")))

typedef struct rehearse_tap rehearse_tap;

/* Zeros: the defaults. */
typedef struct rehearse_tap_options {
  const char* model;      /* the robot's model, which the recording contains; null: none, and no replay without a map */
  const char* controller; /* the controller's name in the recording; null: the name of the tap */
  double time_step;       /* of the loop [s]; 0: 0.001 */
  double seconds;         /* of a black box [s]; 0: 60 */
  unsigned megabytes;     /* size of the ring, which is rounded up to a power of two [MiB]; 0: 64 */
  int replace;            /* 1: a ring that an ended process left over is kept aside, as NAME.before */
  int spawn;              /* REHEARSE_TAP_RECORDER, REHEARSE_TAP_BLACK_BOX: starts a recorder; 0: none */
  const char* output;     /* of this recorder; null: NAME.mcap in the current folder */
} rehearse_tap_options;

/* A recorder that rehearse_tap_open() starts: `rehearse` of PATH, as a process of its own session without the loop's
 * priority, processor and files. It goes on when the loop dies, and ends when it has taken all ticks. */
enum {
  REHEARSE_TAP_RECORDER = 1, /* records everything */
  REHEARSE_TAP_BLACK_BOX = 2 /* keeps the last seconds */
};

/* Quantities of joints. */
enum {
  REHEARSE_TAP_Q = 1,  /* displacement [rad], [m]; as a command the target */
  REHEARSE_TAP_DQ = 2, /* velocity [rad/s], [m/s]; as a command the target */
  REHEARSE_TAP_U = 4   /* effort [N m], [N] */
};

/* Makes the ring: allocates and touches its memory, and locks it if the process may do so. `name`: letters, digits,
 * '-', '_' and '.', at most 64. `options` may be null. Null: it failed, and rehearse_tap_error() states why. */
REHEARSE_TAP_FUNCTION rehearse_tap* rehearse_tap_open(const char* name, const rehearse_tap_options* options);

/* Why the last of the calls before a tick failed, which returned null or -1; empty: none has. */
REHEARSE_TAP_FUNCTION const char* rehearse_tap_error(void);

/* The series of a tap. All are stated before the first rehearse_tap_begin(). They return the number of the series, or
 * -1 with a rehearse_tap_error(). Names are those of the model. */

/* What the loop reads of these joints. A tick's numbers: all q, then all dq, then all u, in the order of `names`. */
REHEARSE_TAP_FUNCTION int rehearse_tap_joints(rehearse_tap* tap, const char* body, const char* const* names,
                                              size_t count, int quantities);
/* What the loop reads of an IMU: angular velocity x, y, z [rad/s], then linear acceleration [m/s^2]. */
REHEARSE_TAP_FUNCTION int rehearse_tap_imu(rehearse_tap* tap, const char* body, const char* device);
/* What the loop reads of another device of the model: `count` numbers, as in its messages. A force sensor has force
 * x, y, z [N] and torque [N m], a gyro and an accelerometer have three numbers. */
REHEARSE_TAP_FUNCTION int rehearse_tap_device(rehearse_tap* tap, const char* body, const char* device, size_t count);
/* What the loop commands to these joints, in the order of rehearse_tap_joints(). */
REHEARSE_TAP_FUNCTION int rehearse_tap_commands(rehearse_tap* tap, const char* body, const char* const* names,
                                                size_t count, int quantities);
/* A parameter of the run, as a gain or a file's hash: metadata of the recording. 0, or -1. */
REHEARSE_TAP_FUNCTION int rehearse_tap_parameter(rehearse_tap* tap, const char* key, const char* value);

/* Begins a tick. `now_ns`: the loop's clock (CLOCK_MONOTONIC) [ns]. A tick that wasn't ended is dropped. */
REHEARSE_TAP_FUNCTION void rehearse_tap_begin(rehearse_tap* tap, int64_t now_ns);
/* The numbers of a series in this tick; of several calls the last one counts. -1: they aren't `count`, or no tick has
 * begun, or a tick's 128 KiB are full; nothing is written, and the recording states the number of such calls. */
REHEARSE_TAP_FUNCTION int rehearse_tap_write(rehearse_tap* tap, int series, const double* numbers, size_t count);
/* States that an input has no new numbers in this tick: its message is late, or lost. -1 as rehearse_tap_write(). */
REHEARSE_TAP_FUNCTION int rehearse_tap_absent(rehearse_tap* tap, int series);
/* A variable of the controller in this tick. `name`: at most 200 bytes. rehearse_variable() calls it for the tick that
 * its thread has begun. -1 as rehearse_tap_write(). */
REHEARSE_TAP_FUNCTION int rehearse_tap_variable(rehearse_tap* tap, const char* name, double value);
/* A line of text in this tick, at most 4096 bytes. -1 as rehearse_tap_write(). */
REHEARSE_TAP_FUNCTION int rehearse_tap_text(rehearse_tap* tap, const char* text);
/* The name under which the loop stores a camera's picture of this tick, as the path of a file; the recording has the
 * name, not the picture. At most 200 and 4096 bytes. -1 as rehearse_tap_write(). */
REHEARSE_TAP_FUNCTION int rehearse_tap_image(rehearse_tap* tap, const char* camera, const char* picture);
/* Ends the tick: from now on it is kept, whatever happens to this process. */
REHEARSE_TAP_FUNCTION void rehearse_tap_end(rehearse_tap* tap);

/* Asks a black box to keep its last seconds. The reason, at most 200 bytes, is in this tick or in the next one. */
REHEARSE_TAP_FUNCTION void rehearse_tap_mark(rehearse_tap* tap, const char* reason);
/* The number of ticks that are in no recording: overwritten before the reader took them, or without room. */
REHEARSE_TAP_FUNCTION uint64_t rehearse_tap_dropped(const rehearse_tap* tap);
/* Ends the tap. The reader takes what is left, and removes the ring. */
REHEARSE_TAP_FUNCTION void rehearse_tap_close(rehearse_tap* tap);

#ifdef __cplusplus
}
#endif

#endif
