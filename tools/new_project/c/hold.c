/* Holds the arm at the angle where it starts, or at the one in its options [rad], against gravity and pushes. */
#include <rehearse/controller.h>

#include <stdlib.h>

static const double stiffness = 60.0; /* [N·m/rad] */
static const double damping = 6.0;    /* [N·m·s/rad] */

typedef struct Hold {
  rehearse_io* io;
  int shoulder;
  double target; /* [rad] */
} Hold;

static void* create(void) { return calloc(1, sizeof(Hold)); }
static void destroy(void* self) { free(self); }

static int initialize(void* self, rehearse_io* io) {
  Hold* hold = self;
  const char* options = rehearse_options(io);
  int result;
  hold->io = io;
  hold->shoulder = rehearse_joint(io, "SHOULDER");
  if (hold->shoulder < 0) return hold->shoulder;
  result = rehearse_read(io, hold->shoulder, REHEARSE_Q | REHEARSE_DQ);
  if (result < 0) return result;
  hold->target = *options ? strtod(options, NULL) : rehearse_get(io, hold->shoulder, REHEARSE_Q);
  return rehearse_command(io, hold->shoulder, REHEARSE_U);
}

static int control(void* self) {
  Hold* hold = self;
  const double q = rehearse_get(hold->io, hold->shoulder, REHEARSE_Q);
  const double dq = rehearse_get(hold->io, hold->shoulder, REHEARSE_DQ);
  return rehearse_set(hold->io, hold->shoulder, REHEARSE_U, stiffness * (hold->target - q) - damping * dq);
}

const rehearse_controller_functions rehearse_controller = {
    REHEARSE_CONTROLLER_ABI, create, initialize, /* start */ NULL, control, /* stop */ NULL, destroy};
