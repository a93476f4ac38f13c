/* The step of a robot's loop as a controller, for replays of its flights. */
#include <rehearse/controller.h>
#include <rehearse_variable.h>
#include <stdlib.h>

#include "step.h"

#ifdef READS_EFFORTS
#define READ (REHEARSE_Q | REHEARSE_DQ | REHEARSE_U)
#else
#define READ (REHEARSE_Q | REHEARSE_DQ)
#endif

typedef struct Guest {
  rehearse_io* io;
  int joints, imu;
  int handles[most_joints];
  Step step;
} Guest;

static void* create(void) { return calloc(1, sizeof(Guest)); }
static void destroy(void* self) { free(self); }

static int initialize(void* self, rehearse_io* io) {
  Guest* guest = self;
  int i, result = 0;
  guest->io = io;
  guest->joints = rehearse_joint_count(io);
  for (i = 0; i < guest->joints && result >= 0; ++i) {
    guest->handles[i] = rehearse_joint_of_id(io, i);
    result = rehearse_read(io, guest->handles[i], READ);
    if (result >= 0) result = rehearse_command(io, guest->handles[i], REHEARSE_U);
  }
  guest->imu = rehearse_device(io, "Imu");
  if (result >= 0) result = rehearse_read_device(io, guest->imu);
  return result;
}

static int control(void* self) {
  Guest* guest = self;
  double q[most_joints], dq[most_joints], u[most_joints], imu[6] = {0};
  int i;
  for (i = 0; i < guest->joints; ++i) {
    q[i] = rehearse_get(guest->io, guest->handles[i], REHEARSE_Q);
    dq[i] = rehearse_get(guest->io, guest->handles[i], REHEARSE_DQ);
  }
  rehearse_device_numbers(guest->io, guest->imu, imu, 6);
  step(&guest->step, guest->joints, q, dq, imu, u);
  for (i = 0; i < guest->joints; ++i) rehearse_set(guest->io, guest->handles[i], REHEARSE_U, u[i]);
#ifdef VARIABLES
  rehearse_variable("integral", guest->step.integral[0]);
#endif
  return REHEARSE_OK;
}

const rehearse_controller_functions rehearse_controller = {
    REHEARSE_CONTROLLER_ABI, create, initialize, NULL, control, NULL, destroy};
