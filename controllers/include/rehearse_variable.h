/* A controller's own words, in numbers: rehearse_variable("phase", 0.3) records an internal variable.
 *
 * Under Rehearse the value becomes a channel of the recording, beside inputs and commands:
 * /<body>/<controller>/variable/phase, and in tests and plots the series <body>/<controller>/variable/phase. Anywhere
 * else, in Choreonoid as on the robot, the call costs one test of a pointer and does nothing: the function behind it is
 * a weak symbol, and nothing has to be linked.
 *
 * To be called by a controller in createSimpleController(), configure(), initialize(), start() and control(), on the
 * thread that called it; what was set before the first control() is recorded with tick 0. Of several values in one
 * tick the last counts. `name`: UTF-8, not empty, at most 200 bytes; a controller may have 1000 of them. `value`: any
 * double, NaN and infinities too; its unit is yours. What is set against these rules is left out, and a warning in the
 * recording says so once.
 *
 * C99 or C++. */
#ifndef REHEARSE_VARIABLE_H
#define REHEARSE_VARIABLE_H

#ifdef __cplusplus
extern "C" {
#endif

#ifdef __GNUC__

/* Defined by Rehearse's harness alone. Not to be called directly. */
extern void rehearse_record_variable(const char* name, double value) __attribute__((weak, visibility("default")));

static inline void rehearse_variable(const char* name, double value) {
  if (rehearse_record_variable) rehearse_record_variable(name, value);
}

#else /* no weak symbols, and no Rehearse either */

static inline void rehearse_variable(const char* name, double value) {
  (void)name;
  (void)value;
}

#endif

#ifdef __cplusplus
}
#endif

#endif
