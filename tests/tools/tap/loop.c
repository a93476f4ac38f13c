/* A robot's loop with a tap: loop NAME MODEL TICKS JOINTS [WORDS...]. JOINTS: the number of joints J0, J1, ..., or the
 * names of the joints with commas between them.
 *   late            the IMU has new numbers in every third tick only
 *   variables       sets a variable in each tick
 *   images          names a picture in each tenth tick
 *   half            500 Hz
 *   fast            10 kHz; else 1 kHz
 *   paced           sleeps until its next tick; else it doesn't wait at all
 *   mark=K          sets a mark in tick K
 *   beyond=K        commands 1e6 N m in tick K
 *   crash=K         is killed before the end of tick K
 *   counter=FILE    the number of ended ticks is in the first 8 bytes of this file
 *   longest         prints the longest time from begin to end [ns]
 *   megabytes=N     of the ring
 *   spawn=N         starts a recorder
 *   replace         keeps an old ring aside */
#define _GNU_SOURCE
#include <fcntl.h>
#include <rehearse/tap.h>
#include <rehearse_variable.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "step.h"

typedef struct Words {
  int is_late, has_variables, has_images, is_paced, measures;
  long period; /* [ns] */
  long mark, beyond, crash;
  const char* counter;
  rehearse_tap_options options;
} Words;

static Words read_words(int count, char** words) {
  Words read = {0, 0, 0, 0, 0, 1000000, -1, -1, -1, NULL, {NULL, "Walk", 0, 0, 0, 0, 0, NULL}};
  int i;
  for (i = 0; i < count; ++i) {
    const char* const value = strchr(words[i], '=') ? strchr(words[i], '=') + 1 : "";
    read.is_late |= strcmp(words[i], "late") == 0;
    read.has_variables |= strcmp(words[i], "variables") == 0;
    read.has_images |= strcmp(words[i], "images") == 0;
    read.measures |= strcmp(words[i], "longest") == 0;
    if (strcmp(words[i], "fast") == 0) read.period = 100000;
    if (strcmp(words[i], "half") == 0) read.period = 2000000;
    read.is_paced |= strcmp(words[i], "paced") == 0;
    read.options.replace |= strcmp(words[i], "replace") == 0;
    if (strncmp(words[i], "mark=", 5) == 0) read.mark = atol(value);
    if (strncmp(words[i], "beyond=", 7) == 0) read.beyond = atol(value);
    if (strncmp(words[i], "crash=", 6) == 0) read.crash = atol(value);
    if (strncmp(words[i], "counter=", 8) == 0) read.counter = value;
    if (strncmp(words[i], "megabytes=", 10) == 0) read.options.megabytes = (unsigned)atoi(value);
    if (strncmp(words[i], "spawn=", 6) == 0) read.options.spawn = atoi(value);
  }
  read.options.time_step = 1.0 / (1e9 / (double)read.period);
  return read;
}

/* A number of the ended ticks that outlives the process. */
static volatile uint64_t* map_counter(const char* file) {
  static uint64_t none;
  int descriptor;
  void* memory;
  if (!file) return &none;
  descriptor = open(file, O_RDWR | O_CREAT, 0600);
  if (descriptor < 0 || ftruncate(descriptor, 8) != 0) exit(2);
  memory = mmap(NULL, 8, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  if (memory == MAP_FAILED) exit(2);
  return memory;
}

static long now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1000000000 + now.tv_nsec;
}

int main(int argc, char** argv) {
  char picture[32];
  static char names_of_joints[most_joints][16];
  const char* names[most_joints];
  char* name;
  double q_dq[2 * most_joints], imu[6] = {0}, u[most_joints];
  static Step self;
  struct timespec next;
  rehearse_tap* tap;
  volatile uint64_t* ended;
  Words words;
  long tick, ticks, begin, longest = 0;
  int i, joints, of_joints, of_imu, of_efforts;
  if (argc < 5) return 2;
  words = read_words(argc - 5, argv + 5);
  words.options.model = argv[2][0] ? argv[2] : NULL;
  ticks = atol(argv[3]);
  joints = atoi(argv[4]);
  for (i = 0; i < joints; ++i) {
    snprintf(names_of_joints[i], sizeof names_of_joints[i], "J%d", i);
    names[i] = names_of_joints[i];
  }
  for (name = joints == 0 ? strtok(argv[4], ",") : NULL; name && joints < most_joints; name = strtok(NULL, ","))
    names[joints++] = name;
  ended = map_counter(words.counter);
  tap = rehearse_tap_open(argv[1], &words.options);
  if (!tap) {
    fprintf(stderr, "%s\n", rehearse_tap_error());
    return 1;
  }
  of_joints = rehearse_tap_joints(tap, "Walker", names, (size_t)joints, REHEARSE_TAP_Q | REHEARSE_TAP_DQ);
  of_imu = rehearse_tap_imu(tap, "Walker", "Imu");
  of_efforts = rehearse_tap_commands(tap, "Walker", names, (size_t)joints, REHEARSE_TAP_U);
  if (of_joints < 0 || of_imu < 0 || of_efforts < 0 || rehearse_tap_parameter(tap, "gain", "40") != 0) {
    fprintf(stderr, "%s\n", rehearse_tap_error());
    return 1;
  }
  clock_gettime(CLOCK_MONOTONIC, &next);
  for (tick = 0; tick < ticks; ++tick) {
    for (i = 0; i < 2 * joints; ++i) q_dq[i] = 0.3 * sin(1e-3 * (double)tick * (1 + i % 7) + i);
    begin = now_ns();
    rehearse_tap_begin(tap, (int64_t)next.tv_sec * 1000000000 + next.tv_nsec);
    rehearse_tap_write(tap, of_joints, q_dq, (size_t)(2 * joints));
    if (!words.is_late || tick % 3 == 1) {
      for (i = 0; i < 6; ++i) imu[i] = 0.01 * cos(2e-3 * (double)tick + i);
      rehearse_tap_write(tap, of_imu, imu, 6);
    } else {
      rehearse_tap_absent(tap, of_imu);
    }
    step(&self, joints, q_dq, q_dq + joints, imu, u);
    if (tick == words.beyond) u[0] = 1e6;
    rehearse_tap_write(tap, of_efforts, u, (size_t)joints);
    if (words.has_variables) rehearse_variable("integral", self.integral[0]);
    if (words.has_images && tick % 10 == 0) {
      snprintf(picture, sizeof picture, "frames/%06ld.png", tick);
      rehearse_tap_image(tap, "Camera", picture);
    }
    if (tick == words.mark) rehearse_tap_mark(tap, "a touch");
    if (tick == words.crash) raise(SIGKILL);
    rehearse_tap_end(tap);
    if (now_ns() - begin > longest) longest = now_ns() - begin;
    *ended = (uint64_t)tick + 1;
    next.tv_nsec += words.period;
    if (next.tv_nsec >= 1000000000) {
      next.tv_nsec -= 1000000000;
      ++next.tv_sec;
    }
    if (words.is_paced) clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, NULL);
  }
  printf("%llu\n", (unsigned long long)rehearse_tap_dropped(tap));
  if (words.measures) printf("longest %ld\n", longest);
  rehearse_tap_close(tap);
  return 0;
}
