/* The types of rcl and rmw that show through the interface of C++. */
#ifndef REHEARSE_RCL_TYPES_H
#define REHEARSE_RCL_TYPES_H

#include <rcutils/time.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef int rcl_ret_t;
typedef int rmw_ret_t;
#define RCL_RET_OK 0
#define RCL_RET_ERROR 1
#define RCL_RET_TIMEOUT 2
#define RMW_RET_OK 0
#define RMW_RET_ERROR 1

typedef rcutils_time_point_value_t rcl_time_point_value_t;
typedef rcutils_duration_value_t rcl_duration_value_t;
typedef struct rcl_duration_s {
  rcl_duration_value_t nanoseconds;
} rcl_duration_t;

typedef enum rcl_clock_type_e {
  RCL_CLOCK_UNINITIALIZED = 0,
  RCL_ROS_TIME = 1,
  RCL_SYSTEM_TIME = 2,
  RCL_STEADY_TIME = 3
} rcl_clock_type_t;

typedef struct rmw_time_s {
  uint64_t sec;
  uint64_t nsec;
} rmw_time_t;

typedef enum rmw_qos_history_policy_e {
  RMW_QOS_POLICY_HISTORY_SYSTEM_DEFAULT = 0,
  RMW_QOS_POLICY_HISTORY_KEEP_LAST = 1,
  RMW_QOS_POLICY_HISTORY_KEEP_ALL = 2,
  RMW_QOS_POLICY_HISTORY_UNKNOWN = 3
} rmw_qos_history_policy_t;

typedef enum rmw_qos_reliability_policy_e {
  RMW_QOS_POLICY_RELIABILITY_SYSTEM_DEFAULT = 0,
  RMW_QOS_POLICY_RELIABILITY_RELIABLE = 1,
  RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT = 2,
  RMW_QOS_POLICY_RELIABILITY_UNKNOWN = 3,
  RMW_QOS_POLICY_RELIABILITY_BEST_AVAILABLE = 4
} rmw_qos_reliability_policy_t;

typedef enum rmw_qos_durability_policy_e {
  RMW_QOS_POLICY_DURABILITY_SYSTEM_DEFAULT = 0,
  RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL = 1,
  RMW_QOS_POLICY_DURABILITY_VOLATILE = 2,
  RMW_QOS_POLICY_DURABILITY_UNKNOWN = 3,
  RMW_QOS_POLICY_DURABILITY_BEST_AVAILABLE = 4
} rmw_qos_durability_policy_t;

typedef enum rmw_qos_liveliness_policy_e {
  RMW_QOS_POLICY_LIVELINESS_SYSTEM_DEFAULT = 0,
  RMW_QOS_POLICY_LIVELINESS_AUTOMATIC = 1,
  RMW_QOS_POLICY_LIVELINESS_MANUAL_BY_TOPIC = 3,
  RMW_QOS_POLICY_LIVELINESS_UNKNOWN = 4,
  RMW_QOS_POLICY_LIVELINESS_BEST_AVAILABLE = 5
} rmw_qos_liveliness_policy_t;

typedef struct rmw_qos_profile_s {
  rmw_qos_history_policy_t history;
  size_t depth;
  rmw_qos_reliability_policy_t reliability;
  rmw_qos_durability_policy_t durability;
  rmw_time_t deadline;
  rmw_time_t lifespan;
  rmw_qos_liveliness_policy_t liveliness;
  rmw_time_t liveliness_lease_duration;
  bool avoid_ros_namespace_conventions;
} rmw_qos_profile_t;

#define REHEARSE_QOS_PROFILE(name, kept, count, delivery, memory)                  \
  static const rmw_qos_profile_t name = {RMW_QOS_POLICY_HISTORY_##kept,            \
                                         count,                                    \
                                         RMW_QOS_POLICY_RELIABILITY_##delivery,    \
                                         RMW_QOS_POLICY_DURABILITY_##memory,       \
                                         {0, 0},                                   \
                                         {0, 0},                                   \
                                         RMW_QOS_POLICY_LIVELINESS_SYSTEM_DEFAULT, \
                                         {0, 0},                                   \
                                         false}
#ifdef __GNUC__
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-variable"
#endif
REHEARSE_QOS_PROFILE(rmw_qos_profile_default, KEEP_LAST, 10, RELIABLE, VOLATILE);
REHEARSE_QOS_PROFILE(rmw_qos_profile_services_default, KEEP_LAST, 10, RELIABLE, VOLATILE);
REHEARSE_QOS_PROFILE(rmw_qos_profile_sensor_data, KEEP_LAST, 5, BEST_EFFORT, VOLATILE);
REHEARSE_QOS_PROFILE(rmw_qos_profile_parameters, KEEP_LAST, 1000, RELIABLE, VOLATILE);
REHEARSE_QOS_PROFILE(rmw_qos_profile_parameter_events, KEEP_LAST, 1000, RELIABLE, VOLATILE);
REHEARSE_QOS_PROFILE(rmw_qos_profile_system_default, SYSTEM_DEFAULT, 0, SYSTEM_DEFAULT, SYSTEM_DEFAULT);
REHEARSE_QOS_PROFILE(rmw_qos_profile_best_available, KEEP_LAST, 10, BEST_AVAILABLE, BEST_AVAILABLE);
#ifdef __GNUC__
#pragma GCC diagnostic pop
#endif

#define RCL_ROS_ARGS_FLAG "--ros-args"
#define RCL_PARAM_FLAG "--param"
#define RCL_SHORT_PARAM_FLAG "-p"
#define RCL_PARAM_FILE_FLAG "--params-file"
#define RCL_REMAP_FLAG "--remap"
#define RCL_SHORT_REMAP_FLAG "-r"
#define RCL_LOG_LEVEL_FLAG "--log-level"

#define RMW_GID_STORAGE_SIZE 16u
typedef struct rmw_gid_s {
  const char* implementation_identifier;
  uint8_t data[RMW_GID_STORAGE_SIZE];
} rmw_gid_t;
typedef struct rmw_request_id_s {
  int8_t writer_guid[16];
  int64_t sequence_number;
} rmw_request_id_t;
typedef struct rmw_message_info_s {
  int64_t source_timestamp;
  int64_t received_timestamp;
  uint64_t publication_sequence_number;
  uint64_t reception_sequence_number;
  rmw_gid_t publisher_gid;
  bool from_intra_process;
} rmw_message_info_t;

#endif
