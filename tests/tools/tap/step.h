/* The step of the tests' robot loop, built into the loop and into a guest: the same commands from the same inputs. */
#ifndef FLIGHT_STEP_H
#define FLIGHT_STEP_H

#include <math.h>
#include <string.h>

enum { most_joints = 64 };

typedef struct Step {
  double integral[most_joints];
  double last[most_joints]; /* the efforts of the tick before */
} Step;

#ifndef GAIN
#define GAIN 40.0
#endif
#ifndef SIGN
#define SIGN 1.0
#endif

#ifdef OTHER_MATHEMATICS /* as another libm has: other last bits */
#define SINE(x) (sin(x) * (1.0 + 2.3e-16))
#else
#define SINE(x) sin(x)
#endif

/* `imu`: gyro, then acceleration. `u`: the efforts [N m]. */
static inline void step(Step* self, int joints, const double* q, const double* dq, const double* imu, double* u) {
  int i;
  for (i = 0; i < joints; ++i) {
    self->integral[i] += 1e-3 * q[i];
    u[i] = -GAIN * q[i] - 2.0 * dq[i] - self->integral[i] + SIGN * 0.1 * SINE(q[i] + imu[i % 6]);
  }
#ifdef ONE_TICK_LATE
  for (i = 0; i < joints; ++i) {
    const double now = u[i];
    u[i] = self->last[i];
    self->last[i] = now;
  }
#endif
}

#endif
