/* A controller in C, or in a language that calls C: version 1.
 *
 *   static int initialize(void* self, rehearse_io* io) { ...; return REHEARSE_OK; }
 *   static int control(void* self) { ...; return REHEARSE_OK; }
 *   REHEARSE_EXPORT const rehearse_controller_functions rehearse_controller = {
 *       .abi = REHEARSE_CONTROLLER_ABI, .create = create, .initialize = initialize, .control = control};
 *
 * A library exports the symbol rehearse_controller, and is named in a scenario as any other controller. It is called at
 * the same instants, and is recorded, replayed and audited alike: the functions below call Choreonoid's classes.
 *
 * A function that returns int returns a count, a handle or REHEARSE_OK, and a negative REHEARSE_... code on failure;
 * rehearse_error(io) is then a sentence about it. Failures change nothing. All functions are for the thread that calls
 * the controller.
 *
 * This file changes in one way only: a later version may add functions, and members at the end of the structure.
 *
 * C99 or C++20 (the example's designated initialisers; else the members in their order). */
#ifndef REHEARSE_CONTROLLER_H
#define REHEARSE_CONTROLLER_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define REHEARSE_CONTROLLER_ABI 1

#if defined(__GNUC__)
#define REHEARSE_EXPORT __attribute__((visibility("default")))
#else
#define REHEARSE_EXPORT
#endif

enum {
  REHEARSE_OK = 0,
  REHEARSE_FINISHED = 1,      /* returned by control(): nothing is left to do; it is called again nevertheless */
  REHEARSE_FAILED = -1,       /* a failure of the controller's own; see rehearse_set_error() */
  REHEARSE_NOT_FOUND = -2,    /* the model has no joint, link or device of that name or id */
  REHEARSE_BAD_ARGUMENT = -3, /* a handle, a quantity or a size is wrong */
  REHEARSE_TOO_LATE = -4      /* to be called in initialize() only */
};

/* Numbers of a joint and of a link, as bits. */
enum {
  REHEARSE_Q = 1 << 0,            /* displacement of a joint; as a command its target [rad or m] */
  REHEARSE_DQ = 1 << 1,           /* its velocity, or its target [rad/s or m/s] */
  REHEARSE_DDQ = 1 << 2,          /* its acceleration [rad/s² or m/s²]; not a command */
  REHEARSE_U = 1 << 3,            /* its torque or force [N·m or N] */
  REHEARSE_POSE = 1 << 4,         /* of a link in the world: x y z [m], quaternion x y z w */
  REHEARSE_TWIST = 1 << 5,        /* velocity of its origin [m/s], then angular velocity [rad/s], world axes */
  REHEARSE_ACCELERATION = 1 << 6, /* of its origin [m/s²], then angular [rad/s²], world axes; not a command */
  REHEARSE_WRENCH = 1 << 7        /* external force [N] and torque about the world's origin [N·m]; a command only */
};

/* The controller's view of its robot; valid from initialize() to destroy(). */
typedef struct rehearse_io rehearse_io;

/* The functions of a controller. Those that are null are not called; initialize and control are needed. `self` is the
 * pointer that create() returned, or null. A negative result of initialize() or start() keeps the controller out of the
 * run; one of control() is a failure, recorded with its tick. */
typedef struct rehearse_controller_functions {
  uint32_t abi; /* REHEARSE_CONTROLLER_ABI */
  void* (*create)(void);
  int (*initialize)(void* self, rehearse_io* io); /* names what is read and commanded */
  int (*start)(void* self);                       /* after initialize() of every controller */
  int (*control)(void* self);                     /* once a step */
  void (*stop)(void* self);                       /* after the last step */
  void (*destroy)(void* self);
} rehearse_controller_functions;

/* Exported by the controller's library. */
REHEARSE_EXPORT extern const rehearse_controller_functions rehearse_controller;

/* The run */

REHEARSE_EXPORT double rehearse_time_step(const rehearse_io* io); /* [s] */
REHEARSE_EXPORT double rehearse_time(const rehearse_io* io);      /* since the start of the run [s] */
REHEARSE_EXPORT const char* rehearse_name(const rehearse_io* io); /* the controller's, in the scenario */
/* The options of the run, a space, and those of this controller. */
REHEARSE_EXPORT const char* rehearse_options(const rehearse_io* io);
/* 1: a command acts in the step of its control(); 0, the default: one step later. In initialize() only. */
REHEARSE_EXPORT int rehearse_set_no_delay(rehearse_io* io, int on);
/* Text for people; it is recorded, a message for each line. */
REHEARSE_EXPORT void rehearse_print(rehearse_io* io, const char* text);
/* The sentence about the last failure; empty if there was none. Valid until the next call of a function. */
REHEARSE_EXPORT const char* rehearse_error(const rehearse_io* io);
/* States the sentence about the failure that the controller is about to return. Returns REHEARSE_FAILED. */
REHEARSE_EXPORT int rehearse_set_error(rehearse_io* io, const char* text);

/* Joints and links. A handle is the index of a link; the handle of a joint is that of the link that it moves. */

REHEARSE_EXPORT int rehearse_joint_count(const rehearse_io* io);
REHEARSE_EXPORT int rehearse_joint_of_id(rehearse_io* io, int id); /* 0 <= id < rehearse_joint_count() */
REHEARSE_EXPORT int rehearse_joint(rehearse_io* io, const char* name);
REHEARSE_EXPORT int rehearse_link_count(const rehearse_io* io); /* link 0 is the root */
REHEARSE_EXPORT int rehearse_link(rehearse_io* io, const char* name);
/* The name of the joint, and of the link; null: the handle is wrong. */
REHEARSE_EXPORT const char* rehearse_joint_name(rehearse_io* io, int joint);
REHEARSE_EXPORT const char* rehearse_link_name(rehearse_io* io, int link);

/* In initialize(): the quantities that are refreshed before each control(), and those that are sent after it. Quantities
 * of several calls add up for reading; the last call counts for commanding. */
REHEARSE_EXPORT int rehearse_read(rehearse_io* io, int link, int quantities);
REHEARSE_EXPORT int rehearse_command(rehearse_io* io, int link, int quantities);

/* One number of a joint. Before the first control() it is that of the initial state. NaN on failure. */
REHEARSE_EXPORT double rehearse_get(rehearse_io* io, int joint, int quantity);
REHEARSE_EXPORT int rehearse_set(rehearse_io* io, int joint, int quantity, double value);
/* The 7 numbers of a pose, or the 6 of another quantity of a link. `size` is 7 or 6, too. */
REHEARSE_EXPORT int rehearse_get_numbers(rehearse_io* io, int link, int quantity, double* numbers, int size);
REHEARSE_EXPORT int rehearse_set_numbers(rehearse_io* io, int link, int quantity, const double* numbers, int size);
/* The lower and the upper limit of REHEARSE_Q, REHEARSE_DQ or REHEARSE_U; infinite where the model states none. */
REHEARSE_EXPORT int rehearse_limits(rehearse_io* io, int joint, int quantity, double* lower, double* upper);

/* Devices: sensors, cameras, lights. A handle is the index of a device. */

REHEARSE_EXPORT int rehearse_device_count(const rehearse_io* io);
REHEARSE_EXPORT int rehearse_device(rehearse_io* io, const char* name);
/* The name, and the type, as "ForceSensor"; null: the handle is wrong. */
REHEARSE_EXPORT const char* rehearse_device_name(rehearse_io* io, int device);
REHEARSE_EXPORT const char* rehearse_device_type(rehearse_io* io, int device);
/* In initialize(): the device is refreshed before a control() whenever it has measured. */
REHEARSE_EXPORT int rehearse_read_device(rehearse_io* io, int device);
/* Copies the numbers of a device, at most `size`, and returns their count. Distances of a range sensor [m], rows of
 * angles; of any other device the numbers that are recorded, as force [N] and torque [N·m] of a force sensor. */
REHEARSE_EXPORT int rehearse_device_numbers(rehearse_io* io, int device, double* numbers, int size);
/* Changes the settings of a device, as those of a light, and sends them after the present call. The numbers are all
 * those that rehearse_device_numbers() copies. Not for range sensors. */
REHEARSE_EXPORT int rehearse_set_device_numbers(rehearse_io* io, int device, const double* numbers, int size);
/* The last image of a camera, top row first, and its shape: rows, columns, bytes of a pixel. Null before the first
 * image, and on failure. Valid until the next control(). */
REHEARSE_EXPORT const unsigned char* rehearse_image(rehearse_io* io, int device, int shape[3]);
/* The last points of a range camera, three numbers each, in the camera's frame [m], as an array of rows and columns.
 * Null before the first ones, and on failure. Valid until the next control(). */
REHEARSE_EXPORT const float* rehearse_points(rehearse_io* io, int device, int shape[3]);

#ifdef __cplusplus
}
#endif

#endif
