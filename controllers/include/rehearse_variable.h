/* Internal variables of a controller: rehearse_variable("phase", 0.3) records a number.
 *
 * In Rehearse the value becomes a channel of the recording, in addition to inputs and commands:
 * /<body>/<controller>/variable/phase, and in tests and plots the series <body>/<controller>/variable/phase. In
 * Choreonoid and on the robot the call only tests a pointer and does nothing else: the recording function is a weak
 * symbol, and nothing has to be linked.
 *
 * To be called by a controller in createSimpleController(), configure(), initialize(), start() and control(), on the
 * thread that called it; values set before the first control() are recorded with tick 0. Of several values in one
 * tick the last one is recorded. `name`: UTF-8, not empty, at most 200 bytes; a controller may use 1000 names.
 * `value`: any double, including NaN and infinities, in any unit. Values that break these rules are left out, and one
 * warning in the recording reports it.
 *
 * C99 or C++. */
#ifndef REHEARSE_VARIABLE_H
#define REHEARSE_VARIABLE_H

#ifdef __cplusplus
extern "C" {
#endif

#ifdef __GNUC__

/* Defined only by Rehearse's harness. Not to be called directly. */
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
