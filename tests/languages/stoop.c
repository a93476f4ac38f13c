/* stoop.cpp in C. */
#include <rehearse/controller.h>
#include <rehearse_variable.h>
#include <stdlib.h>
#include <string.h>

static const double stiffness = 8000.0;     /* [N·m/rad] */
static const double arm_stiffness = 3000.0; /* [N·m/rad] */
static const double damping = 100.0;        /* [N·m·s/rad] */
static const double smoothing = 0.2;        /* of the velocity filter, per step */

typedef struct Joint {
  int link;
  double stiffness, bend, start, before, velocity;
} Joint;

typedef struct Stoop {
  rehearse_io* io;
  Joint joints[64];
  int count, tick, phase;
  double depth; /* [rad] */
} Stoop;

static void* create(void) { return calloc(1, sizeof(Stoop)); }
static void destroy(void* self) { free(self); }

static int initialize(void* self, rehearse_io* io) {
  Stoop* stoop = self;
  int i;
  stoop->io = io;
  stoop->depth = strtod(rehearse_options(io), NULL);
  stoop->count = rehearse_joint_count(io);
  if (stoop->count > 64) return rehearse_set_error(io, "the robot has more than 64 joints");
  for (i = 0; i < stoop->count; ++i) {
    Joint* joint = &stoop->joints[i];
    const int link = rehearse_joint_of_id(io, i);
    const char* name = rehearse_joint_name(io, link);
    int result = rehearse_read(io, link, REHEARSE_Q);
    if (result < 0) return result;
    result = rehearse_command(io, link, REHEARSE_U);
    if (result < 0) return result;
    joint->link = link;
    joint->stiffness = strstr(name, "ARM") ? arm_stiffness : stiffness;
    joint->bend = strstr(name, "KNEE") ? 2.0 : strstr(name, "HIP_P") || strstr(name, "ANKLE_P") ? -1.0 : 0.0;
    joint->start = joint->before = rehearse_get(io, link, REHEARSE_Q);
  }
  return REHEARSE_OK;
}

static int control(void* self) {
  Stoop* stoop = self;
  const double time_step = rehearse_time_step(stoop->io);
  double share;
  int i;
  if (stoop->phase == 0 && stoop->tick == 100) stoop->phase = 1;
  if (stoop->phase == 1 && stoop->tick == 400) stoop->phase = 2;
  share = stoop->phase == 0 ? 0.0 : stoop->phase == 1 ? (stoop->tick - 100) / 300.0 : 1.0;
  rehearse_variable("phase", stoop->phase);
  for (i = 0; i < stoop->count; ++i) {
    Joint* joint = &stoop->joints[i];
    const double q = rehearse_get(stoop->io, joint->link, REHEARSE_Q);
    const double target = joint->start + stoop->depth * joint->bend * share;
    joint->velocity += smoothing * ((q - joint->before) / time_step - joint->velocity);
    joint->before = q;
    rehearse_set(stoop->io, joint->link, REHEARSE_U, joint->stiffness * (target - q) - damping * joint->velocity);
  }
  ++stoop->tick;
  return REHEARSE_OK;
}

const rehearse_controller_functions rehearse_controller = {REHEARSE_CONTROLLER_ABI, create, initialize, NULL, control,
                                                           NULL,                    destroy};
