/* Ten ticks of a robot's loop, recorded by a tap that no other process reads. */
#include <rehearse/tap.h>
#include <stdio.h>

int main(void) {
  const char* const names[] = {"SWING"};
  const double q = 0.1, u = -0.02;
  rehearse_tap_options options = {0};
  rehearse_tap* tap;
  int tick, joints, commands;
  options.megabytes = 1;
  options.replace = 1;
  tap = rehearse_tap_open("consumer", &options);
  joints = rehearse_tap_joints(tap, "Pendulum", names, 1, REHEARSE_TAP_Q);
  commands = rehearse_tap_commands(tap, "Pendulum", names, 1, REHEARSE_TAP_U);
  for (tick = 0; tick < 10; ++tick) {
    rehearse_tap_begin(tap, tick * 1000000LL);
    rehearse_tap_write(tap, joints, &q, 1);
    rehearse_tap_write(tap, commands, &u, 1);
    rehearse_tap_end(tap);
  }
  if (!tap) printf("%s\n", rehearse_tap_error());
  rehearse_tap_close(tap);
  return tap ? 0 : 1;
}
