/* Calls each function of rehearse/controller.h, rightly and wrongly, on the scout. A wrong answer fails the call, with its
 * line and expression. */
#include <math.h>
#include <rehearse/controller.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Everything {
  rehearse_io* io;
  int wheel, laser, depth, tick, images, points;
} Everything;

static int wrong(rehearse_io* io, int line, const char* expression) {
  char text[300];
  snprintf(text, sizeof text, "everything.c:%d: %s; the last failure: %s", line, expression, rehearse_error(io));
  return rehearse_set_error(io, text);
}
#define EXPECT(expression) \
  if (!(expression)) return wrong(io, __LINE__, #expression)
#define EXPECT_ERROR(call, code, part) EXPECT((call) == (code) && strstr(rehearse_error(io), part))

static void* create(void) { return calloc(1, sizeof(Everything)); }
static void destroy(void* self) { free(self); }

static int check_run(rehearse_io* io) {
  EXPECT(rehearse_time_step(io) == 0.005);
  EXPECT(rehearse_time(io) == 0.0);
  EXPECT(strcmp(rehearse_name(io), "Everything") == 0);
  EXPECT(strcmp(rehearse_options(io), "one two") == 0);
  EXPECT(rehearse_set_no_delay(io, 1) == REHEARSE_OK);
  EXPECT(rehearse_set_no_delay(NULL, 1) == REHEARSE_BAD_ARGUMENT);
  EXPECT(strstr(rehearse_error(NULL), "null") != NULL);
  rehearse_print(io, "hello from C\n");
  return REHEARSE_OK;
}

static int check_joints(Everything* self, rehearse_io* io) {
  double lower = 0, upper = 0;
  EXPECT(rehearse_joint_count(io) == 2);
  self->wheel = rehearse_joint_of_id(io, 0);
  EXPECT(self->wheel > 0);
  EXPECT(rehearse_joint(io, rehearse_joint_name(io, self->wheel)) == self->wheel);
  EXPECT(rehearse_link(io, rehearse_link_name(io, self->wheel)) == self->wheel);
  EXPECT(rehearse_link_count(io) > 5 && rehearse_link(io, "BASE") == 0);
  EXPECT_ERROR(rehearse_joint(io, "KNEE"), REHEARSE_NOT_FOUND, "the robot has no joint 'KNEE'; it has ");
  EXPECT_ERROR(rehearse_joint(io, NULL), REHEARSE_BAD_ARGUMENT, "the name is null");
  EXPECT_ERROR(rehearse_joint_of_id(io, 2), REHEARSE_NOT_FOUND, "no joint with the id 2");
  EXPECT_ERROR(rehearse_joint_of_id(io, -1), REHEARSE_NOT_FOUND, "no joint with the id -1");
  EXPECT_ERROR(rehearse_link(io, "HEAD"), REHEARSE_NOT_FOUND, "no link 'HEAD'; it has BASE, ");
  EXPECT(rehearse_joint_name(io, 0) == NULL && strstr(rehearse_error(io), "link 'BASE' has no joint"));
  EXPECT(rehearse_link_name(io, 99) == NULL && strstr(rehearse_error(io), "no link has the handle 99"));
  EXPECT(rehearse_limits(io, self->wheel, REHEARSE_Q, &lower, &upper) == REHEARSE_OK);
  EXPECT(lower == -INFINITY && upper == INFINITY);
  EXPECT_ERROR(rehearse_limits(io, self->wheel, REHEARSE_POSE, &lower, &upper), REHEARSE_BAD_ARGUMENT, "no limits");
  EXPECT_ERROR(rehearse_limits(io, self->wheel, REHEARSE_Q, NULL, &upper), REHEARSE_BAD_ARGUMENT, "null");
  return REHEARSE_OK;
}

static int check_enabling(Everything* self, rehearse_io* io) {
  EXPECT(rehearse_read(io, self->wheel, REHEARSE_Q | REHEARSE_DQ) == REHEARSE_OK);
  EXPECT(rehearse_command(io, self->wheel, REHEARSE_U) == REHEARSE_OK);
  EXPECT(rehearse_read(io, 0, REHEARSE_POSE | REHEARSE_TWIST) == REHEARSE_OK);
  EXPECT(rehearse_command(io, 0, REHEARSE_WRENCH) == REHEARSE_OK);
  EXPECT_ERROR(rehearse_read(io, 0, REHEARSE_Q), REHEARSE_BAD_ARGUMENT, "link 'BASE' has no joint");
  EXPECT_ERROR(rehearse_read(io, 0, REHEARSE_WRENCH), REHEARSE_BAD_ARGUMENT, "can't be read");
  EXPECT_ERROR(rehearse_read(io, 0, 1 << 20), REHEARSE_BAD_ARGUMENT, "can't be read");
  EXPECT_ERROR(rehearse_command(io, self->wheel, REHEARSE_DDQ), REHEARSE_BAD_ARGUMENT, "can't be commanded");
  EXPECT_ERROR(rehearse_command(io, -7, REHEARSE_POSE), REHEARSE_BAD_ARGUMENT, "no link has the handle -7");
  return REHEARSE_OK;
}

static int check_devices(Everything* self, rehearse_io* io) {
  double numbers[400];
  int shape[3];
  self->laser = rehearse_device(io, "Laser");
  self->depth = rehearse_device(io, "Depth");
  EXPECT(rehearse_device_count(io) == 2 && self->laser >= 0 && self->depth >= 0);
  EXPECT(strcmp(rehearse_device_name(io, self->laser), "Laser") == 0);
  EXPECT(strcmp(rehearse_device_type(io, self->laser), "RangeSensor") == 0);
  EXPECT(rehearse_device_name(io, 9) == NULL && rehearse_device_type(io, 9) == NULL);
  EXPECT_ERROR(rehearse_device(io, "Nose"), REHEARSE_NOT_FOUND, "no device 'Nose'; it has ");
  EXPECT(rehearse_read_device(io, self->laser) == REHEARSE_OK && rehearse_read_device(io, self->depth) == REHEARSE_OK);
  EXPECT_ERROR(rehearse_read_device(io, 9), REHEARSE_BAD_ARGUMENT, "no device has the handle 9");
  EXPECT_ERROR(rehearse_device_numbers(io, self->laser, NULL, 3), REHEARSE_BAD_ARGUMENT, "null");
  EXPECT_ERROR(rehearse_set_device_numbers(io, self->laser, numbers, 0), REHEARSE_BAD_ARGUMENT, "can't be set");
  EXPECT_ERROR(rehearse_set_device_numbers(io, self->depth, numbers, 1), REHEARSE_BAD_ARGUMENT, "numbers, not 1");
  EXPECT(rehearse_image(io, self->depth, shape) == NULL && rehearse_points(io, self->depth, shape) == NULL);
  EXPECT(rehearse_image(io, self->laser, shape) == NULL && strstr(rehearse_error(io), "is a RangeSensor, no camera"));
  return REHEARSE_OK;
}

static int check_numbers(Everything* self, rehearse_io* io) {
  double numbers[7] = {0, 0, 0, 0, 0, 0, 0};
  EXPECT(rehearse_set(io, self->wheel, REHEARSE_U, 0.5) == REHEARSE_OK);
  EXPECT(rehearse_get(io, self->wheel, REHEARSE_U) == 0.5);
  EXPECT(rehearse_set(io, self->wheel, REHEARSE_Q, 1.0) == REHEARSE_OK);
  EXPECT(rehearse_set(io, self->wheel, REHEARSE_DQ, 1.0) == REHEARSE_OK);
  EXPECT_ERROR(rehearse_set(io, self->wheel, REHEARSE_DDQ, 1.0), REHEARSE_BAD_ARGUMENT, "is no command");
  EXPECT_ERROR(rehearse_set(io, 0, REHEARSE_U, 1.0), REHEARSE_BAD_ARGUMENT, "has no joint");
  EXPECT(isnan(rehearse_get(io, self->wheel, REHEARSE_POSE)) && isnan(rehearse_get(io, 0, REHEARSE_Q)));
  EXPECT(rehearse_get_numbers(io, 0, REHEARSE_POSE, numbers, 7) == REHEARSE_OK);
  EXPECT(fabs(numbers[0] + 2.2) < 1.0 && numbers[6] > 0.5);
  EXPECT_ERROR(rehearse_get_numbers(io, 0, REHEARSE_POSE, numbers, 6), REHEARSE_BAD_ARGUMENT, "has 7 numbers, not 6");
  EXPECT_ERROR(rehearse_get_numbers(io, 0, REHEARSE_Q, numbers, 6), REHEARSE_BAD_ARGUMENT, "has no list of numbers");
  EXPECT(rehearse_get_numbers(io, 0, REHEARSE_TWIST, numbers, 6) == REHEARSE_OK);
  EXPECT(rehearse_get_numbers(io, 0, REHEARSE_ACCELERATION, numbers, 6) == REHEARSE_OK);
  EXPECT_ERROR(rehearse_set_numbers(io, 0, REHEARSE_ACCELERATION, numbers, 6), REHEARSE_BAD_ARGUMENT, "commanded");
  memset(numbers, 0, sizeof numbers);
  EXPECT_ERROR(rehearse_set_numbers(io, 0, REHEARSE_POSE, numbers, 7), REHEARSE_BAD_ARGUMENT, "quaternion is zero");
  numbers[2] = 4.0; /* [N], upwards */
  EXPECT(rehearse_set_numbers(io, 0, REHEARSE_WRENCH, numbers, 6) == REHEARSE_OK);
  EXPECT(rehearse_set_numbers(io, 0, REHEARSE_TWIST, numbers, 6) == REHEARSE_OK);
  return REHEARSE_OK;
}

static int check_measurements(Everything* self, rehearse_io* io) {
  double ranges[2000];
  int shape[3];
  const unsigned char* pixels = rehearse_image(io, self->depth, shape);
  const float* points;
  const int count = rehearse_device_numbers(io, self->laser, NULL, 0);
  if (pixels) {
    EXPECT(shape[0] == 48 && shape[1] == 64 && shape[2] == 3);
    ++self->images;
  }
  points = rehearse_points(io, self->depth, shape);
  if (points) {
    EXPECT(shape[0] == 48 && shape[1] == 64 && shape[2] == 3);
    ++self->points;
  }
  if (self->tick < 50) return REHEARSE_OK;
  EXPECT(count > 1 && count < 2000);
  EXPECT(rehearse_device_numbers(io, self->laser, ranges, 2000) == count);
  EXPECT(ranges[count / 2] > 0.05 && ranges[count / 2] < 10.0);
  EXPECT(rehearse_device_numbers(io, self->laser, ranges, 1) == count);
  EXPECT(self->points > 0);
  return REHEARSE_OK;
}

static int initialize(void* state, rehearse_io* io) {
  Everything* self = state;
  int result = check_run(io);
  self->io = io;
  if (result >= 0) result = check_joints(self, io);
  if (result >= 0) result = check_enabling(self, io);
  if (result >= 0) result = check_devices(self, io);
  return result;
}

static int start(void* state) {
  rehearse_io* io = ((Everything*)state)->io;
  EXPECT_ERROR(rehearse_read(io, 0, REHEARSE_POSE), REHEARSE_TOO_LATE, "after initialize()");
  EXPECT_ERROR(rehearse_read_device(io, 0), REHEARSE_TOO_LATE, "after initialize()");
  EXPECT_ERROR(rehearse_set_no_delay(io, 0), REHEARSE_TOO_LATE, "after initialize()");
  return REHEARSE_OK;
}

#ifdef INCOMPLETE
__attribute__((unused))
#endif
static int
control(void* state) {
  Everything* self = state;
  rehearse_io* io = self->io;
  const int result = check_numbers(self, io);
  EXPECT(fabs(rehearse_time(io) - 0.005 * self->tick) < 1e-12);
  if (result < 0) return result;
  ++self->tick;
  return check_measurements(self, io) < 0 ? REHEARSE_FAILED : self->tick > 60 ? REHEARSE_FINISHED : REHEARSE_OK;
}

static void stop(void* state) { rehearse_print(((Everything*)state)->io, "stopped\n"); }

#ifndef VERSION
#define VERSION REHEARSE_CONTROLLER_ABI
#endif
#ifdef INCOMPLETE
const rehearse_controller_functions rehearse_controller = {VERSION, create, initialize, start, NULL, stop, destroy};
#else
const rehearse_controller_functions rehearse_controller = {VERSION, create, initialize, start, control, stop, destroy};
#endif
