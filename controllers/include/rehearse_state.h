/* The state that a controller needs to continue: rehearse_state("integral", &integral) takes a number of it.
 *
 * In a replay of a robot's log Rehearse may know the number: the robot's controller has published it, and the map of
 * the log names it (`state:`). Then the number is written to `value`, and the function returns 1. In all other runs, in
 * Choreonoid and on the robot it does nothing and returns 0: the function behind it is a weak symbol, and nothing has
 * to be linked.
 *
 * To be called by a controller in start(), or at the end of initialize(), on the thread that called it, once for each
 * number on which its next commands depend, other than its inputs. The robot's controller publishes these numbers after
 * a call of control(), with their values at that time: they are those with which the next call begins. A replay tries
 * whether these numbers are the whole state, and else doesn't use the log's. `name`: UTF-8, not empty. `value`: not
 * null, valid as long as the controller; any unit.
 *
 * C99 or C++. */
#ifndef REHEARSE_STATE_H
#define REHEARSE_STATE_H

#ifdef __cplusplus
extern "C" {
#endif

#ifdef __GNUC__

/* Defined only by Rehearse's harness. Not to be called directly. */
extern int rehearse_take_state(const char* name, double* value) __attribute__((weak, visibility("default")));

static inline int rehearse_state(const char* name, double* value) {
  return rehearse_take_state ? rehearse_take_state(name, value) : 0;
}

#else /* no weak symbols, and no Rehearse either */

static inline int rehearse_state(const char* name, double* value) {
  (void)name;
  (void)value;
  return 0;
}

#endif

#ifdef __cplusplus
}
#endif

#endif
