#include "standard_types.h"

#include <algorithm>
#include <map>
#include <vector>

namespace rehearse::bag {

namespace {

/// A type in each line: its name, then its fields, separated by commas. A type without a package is a type of the
/// same package, as in ROS; `Header` is std_msgs/Header. Source: ROS 2 Humble; later versions agree unless a line
/// states another version.
constexpr std::string_view all_types = R"(
builtin_interfaces/Time: int32 sec, uint32 nanosec
builtin_interfaces/Duration: int32 sec, uint32 nanosec
rosgraph_msgs/Clock: builtin_interfaces/Time clock
unique_identifier_msgs/UUID: uint8[16] uuid

std_msgs/Bool: bool data
std_msgs/Byte: byte data
std_msgs/Char: uint8 data
std_msgs/ColorRGBA: float32 r, float32 g, float32 b, float32 a
std_msgs/Empty: uint8 structure_needs_at_least_one_member
std_msgs/Float32: float32 data
std_msgs/Float64: float64 data
std_msgs/Header: builtin_interfaces/Time stamp, string frame_id
std_msgs/Int8: int8 data
std_msgs/Int16: int16 data
std_msgs/Int32: int32 data
std_msgs/Int64: int64 data
std_msgs/String: string data
std_msgs/UInt8: uint8 data
std_msgs/UInt16: uint16 data
std_msgs/UInt32: uint32 data
std_msgs/UInt64: uint64 data
std_msgs/MultiArrayDimension: string label, uint32 size, uint32 stride
std_msgs/MultiArrayLayout: MultiArrayDimension[] dim, uint32 data_offset
std_msgs/ByteMultiArray: MultiArrayLayout layout, byte[] data
std_msgs/Float32MultiArray: MultiArrayLayout layout, float32[] data
std_msgs/Float64MultiArray: MultiArrayLayout layout, float64[] data
std_msgs/Int8MultiArray: MultiArrayLayout layout, int8[] data
std_msgs/Int16MultiArray: MultiArrayLayout layout, int16[] data
std_msgs/Int32MultiArray: MultiArrayLayout layout, int32[] data
std_msgs/Int64MultiArray: MultiArrayLayout layout, int64[] data
std_msgs/UInt8MultiArray: MultiArrayLayout layout, uint8[] data
std_msgs/UInt16MultiArray: MultiArrayLayout layout, uint16[] data
std_msgs/UInt32MultiArray: MultiArrayLayout layout, uint32[] data
std_msgs/UInt64MultiArray: MultiArrayLayout layout, uint64[] data

geometry_msgs/Accel: Vector3 linear, Vector3 angular
geometry_msgs/AccelStamped: Header header, Accel accel
geometry_msgs/AccelWithCovariance: Accel accel, float64[36] covariance
geometry_msgs/AccelWithCovarianceStamped: Header header, AccelWithCovariance accel
geometry_msgs/Inertia: float64 m, Vector3 com, float64 ixx, float64 ixy, float64 ixz, float64 iyy, float64 iyz, float64 izz
geometry_msgs/InertiaStamped: Header header, Inertia inertia
geometry_msgs/Point: float64 x, float64 y, float64 z
geometry_msgs/Point32: float32 x, float32 y, float32 z
geometry_msgs/PointStamped: Header header, Point point
geometry_msgs/Polygon: Point32[] points
geometry_msgs/PolygonStamped: Header header, Polygon polygon
geometry_msgs/Pose: Point position, Quaternion orientation
geometry_msgs/Pose2D: float64 x, float64 y, float64 theta
geometry_msgs/PoseArray: Header header, Pose[] poses
geometry_msgs/PoseStamped: Header header, Pose pose
geometry_msgs/PoseWithCovariance: Pose pose, float64[36] covariance
geometry_msgs/PoseWithCovarianceStamped: Header header, PoseWithCovariance pose
geometry_msgs/Quaternion: float64 x, float64 y, float64 z, float64 w
geometry_msgs/QuaternionStamped: Header header, Quaternion quaternion
geometry_msgs/Transform: Vector3 translation, Quaternion rotation
geometry_msgs/TransformStamped: Header header, string child_frame_id, Transform transform
geometry_msgs/Twist: Vector3 linear, Vector3 angular
geometry_msgs/TwistStamped: Header header, Twist twist
geometry_msgs/TwistWithCovariance: Twist twist, float64[36] covariance
geometry_msgs/TwistWithCovarianceStamped: Header header, TwistWithCovariance twist
geometry_msgs/Vector3: float64 x, float64 y, float64 z
geometry_msgs/Vector3Stamped: Header header, Vector3 vector
geometry_msgs/Wrench: Vector3 force, Vector3 torque
geometry_msgs/WrenchStamped: Header header, Wrench wrench

sensor_msgs/BatteryState: Header header, float32 voltage, float32 temperature, float32 current, float32 charge, float32 capacity, float32 design_capacity, float32 percentage, uint8 power_supply_status, uint8 power_supply_health, uint8 power_supply_technology, bool present, float32[] cell_voltage, float32[] cell_temperature, string location, string serial_number
sensor_msgs/CameraInfo: Header header, uint32 height, uint32 width, string distortion_model, float64[] d, float64[9] k, float64[9] r, float64[12] p, uint32 binning_x, uint32 binning_y, RegionOfInterest roi
sensor_msgs/ChannelFloat32: string name, float32[] values
sensor_msgs/CompressedImage: Header header, string format, uint8[] data
sensor_msgs/FluidPressure: Header header, float64 fluid_pressure, float64 variance
sensor_msgs/Illuminance: Header header, float64 illuminance, float64 variance
sensor_msgs/Image: Header header, uint32 height, uint32 width, string encoding, uint8 is_bigendian, uint32 step, uint8[] data
sensor_msgs/Imu: Header header, geometry_msgs/Quaternion orientation, float64[9] orientation_covariance, geometry_msgs/Vector3 angular_velocity, float64[9] angular_velocity_covariance, geometry_msgs/Vector3 linear_acceleration, float64[9] linear_acceleration_covariance
sensor_msgs/JointState: Header header, string[] name, float64[] position, float64[] velocity, float64[] effort
sensor_msgs/Joy: Header header, float32[] axes, int32[] buttons
sensor_msgs/JoyFeedback: uint8 type, uint8 id, float32 intensity
sensor_msgs/JoyFeedbackArray: JoyFeedback[] array
sensor_msgs/LaserEcho: float32[] echoes
sensor_msgs/LaserScan: Header header, float32 angle_min, float32 angle_max, float32 angle_increment, float32 time_increment, float32 scan_time, float32 range_min, float32 range_max, float32[] ranges, float32[] intensities
sensor_msgs/MagneticField: Header header, geometry_msgs/Vector3 magnetic_field, float64[9] magnetic_field_covariance
sensor_msgs/MultiDOFJointState: Header header, string[] joint_names, geometry_msgs/Transform[] transforms, geometry_msgs/Twist[] twist, geometry_msgs/Wrench[] wrench
sensor_msgs/MultiEchoLaserScan: Header header, float32 angle_min, float32 angle_max, float32 angle_increment, float32 time_increment, float32 scan_time, float32 range_min, float32 range_max, LaserEcho[] ranges, LaserEcho[] intensities
sensor_msgs/NavSatFix: Header header, NavSatStatus status, float64 latitude, float64 longitude, float64 altitude, float64[9] position_covariance, uint8 position_covariance_type
sensor_msgs/NavSatStatus: int8 status, uint16 service
sensor_msgs/PointCloud: Header header, geometry_msgs/Point32[] points, ChannelFloat32[] channels
sensor_msgs/PointCloud2: Header header, uint32 height, uint32 width, PointField[] fields, bool is_bigendian, uint32 point_step, uint32 row_step, uint8[] data, bool is_dense
sensor_msgs/PointField: string name, uint32 offset, uint8 datatype, uint32 count
sensor_msgs/Range: Header header, uint8 radiation_type, float32 field_of_view, float32 min_range, float32 max_range, float32 range
sensor_msgs/RegionOfInterest: uint32 x_offset, uint32 y_offset, uint32 height, uint32 width, bool do_rectify
sensor_msgs/RelativeHumidity: Header header, float64 relative_humidity, float64 variance
sensor_msgs/Temperature: Header header, float64 temperature, float64 variance
sensor_msgs/TimeReference: Header header, builtin_interfaces/Time time_ref, string source

trajectory_msgs/JointTrajectory: Header header, string[] joint_names, JointTrajectoryPoint[] points
trajectory_msgs/JointTrajectoryPoint: float64[] positions, float64[] velocities, float64[] accelerations, float64[] effort, builtin_interfaces/Duration time_from_start
trajectory_msgs/MultiDOFJointTrajectory: Header header, string[] joint_names, MultiDOFJointTrajectoryPoint[] points
trajectory_msgs/MultiDOFJointTrajectoryPoint: geometry_msgs/Transform[] transforms, geometry_msgs/Twist[] velocities, geometry_msgs/Twist[] accelerations, builtin_interfaces/Duration time_from_start

control_msgs/DynamicJointState: Header header, string[] joint_names, InterfaceValue[] interface_values
control_msgs/InterfaceValue: string[] interface_names, float64[] values
control_msgs/JointControllerState: Header header, float64 set_point, float64 process_value, float64 process_value_dot, float64 error, float64 time_step, float64 command, float64 p, float64 i, float64 d, float64 i_clamp, bool antiwindup
control_msgs/JointJog: Header header, string[] joint_names, float64[] displacements, float64[] velocities, float64 duration

nav_msgs/GridCells: Header header, float32 cell_width, float32 cell_height, geometry_msgs/Point[] cells
nav_msgs/MapMetaData: builtin_interfaces/Time map_load_time, float32 resolution, uint32 width, uint32 height, geometry_msgs/Pose origin
nav_msgs/OccupancyGrid: Header header, MapMetaData info, int8[] data
nav_msgs/Odometry: Header header, string child_frame_id, geometry_msgs/PoseWithCovariance pose, geometry_msgs/TwistWithCovariance twist
nav_msgs/Path: Header header, geometry_msgs/PoseStamped[] poses

tf2_msgs/TFMessage: geometry_msgs/TransformStamped[] transforms
tf2_msgs/TF2Error: uint8 error, string error_string

diagnostic_msgs/DiagnosticArray: Header header, DiagnosticStatus[] status
diagnostic_msgs/DiagnosticStatus: byte level, string name, string message, string hardware_id, KeyValue[] values
diagnostic_msgs/KeyValue: string key, string value

rcl_interfaces/FloatingPointRange: float64 from_value, float64 to_value, float64 step
rcl_interfaces/IntegerRange: int64 from_value, int64 to_value, uint64 step
rcl_interfaces/Log: builtin_interfaces/Time stamp, uint8 level, string name, string msg, string file, string function, uint32 line
rcl_interfaces/Parameter: string name, ParameterValue value
rcl_interfaces/ParameterEvent: builtin_interfaces/Time stamp, string node, Parameter[] new_parameters, Parameter[] changed_parameters, Parameter[] deleted_parameters
rcl_interfaces/ParameterValue: uint8 type, bool bool_value, int64 integer_value, float64 double_value, string string_value, byte[] byte_array_value, bool[] bool_array_value, int64[] integer_array_value, float64[] double_array_value, string[] string_array_value

action_msgs/GoalInfo: unique_identifier_msgs/UUID goal_id, builtin_interfaces/Time stamp
action_msgs/GoalStatus: GoalInfo goal_info, int8 status
action_msgs/GoalStatusArray: GoalStatus[] status_list

lifecycle_msgs/State: uint8 id, string label
lifecycle_msgs/Transition: uint8 id, string label
lifecycle_msgs/TransitionEvent: uint64 timestamp, Transition transition, State start_state, State goal_state

shape_msgs/Mesh: MeshTriangle[] triangles, geometry_msgs/Point[] vertices
shape_msgs/MeshTriangle: uint32[3] vertex_indices
shape_msgs/Plane: float64[4] coef

stereo_msgs/DisparityImage: Header header, sensor_msgs/Image image, float32 f, float32 t, sensor_msgs/RegionOfInterest valid_window, float32 min_disparity, float32 max_disparity, float32 delta_d

visualization_msgs/ImageMarker: Header header, string ns, int32 id, int32 type, int32 action, geometry_msgs/Point position, float32 scale, std_msgs/ColorRGBA outline_color, uint8 filled, std_msgs/ColorRGBA fill_color, builtin_interfaces/Duration lifetime, geometry_msgs/Point[] points, std_msgs/ColorRGBA[] outline_colors
visualization_msgs/Marker: Header header, string ns, int32 id, int32 type, int32 action, geometry_msgs/Pose pose, geometry_msgs/Vector3 scale, std_msgs/ColorRGBA color, builtin_interfaces/Duration lifetime, bool frame_locked, geometry_msgs/Point[] points, std_msgs/ColorRGBA[] colors, string texture_resource, sensor_msgs/CompressedImage texture, UVCoordinate[] uv_coordinates, string text, string mesh_resource, MeshFile mesh_file, bool mesh_use_embedded_materials
visualization_msgs/MarkerArray: Marker[] markers
visualization_msgs/MeshFile: string filename, uint8[] data
visualization_msgs/UVCoordinate: float32 u, float32 v
)";

using Fields = std::vector<std::string>;

const std::map<std::string, Fields, std::less<>>& types() {
  static const auto parsed = [] {
    std::map<std::string, Fields, std::less<>> all;
    std::string_view rest = all_types;
    while (!rest.empty()) {
      std::string_view line = rest.substr(0, rest.find('\n'));
      rest.remove_prefix(std::min(rest.size(), line.size() + 1));
      if (line.empty()) continue;
      Fields& fields = all[std::string(line.substr(0, line.find(':')))];
      line.remove_prefix(line.find(':') + 2);
      while (!line.empty()) {
        const std::string_view field = line.substr(0, line.find(", "));
        fields.emplace_back(field);
        line.remove_prefix(std::min(line.size(), field.size() + 2));
      }
    }
    return all;
  }();
  return parsed;
}

/// The message type of a field, as std_msgs/Header; empty for a primitive type.
std::string used_type(std::string_view field, std::string_view package) {
  const std::string_view type = field.substr(0, field.find_first_of(" ["));
  if (type == "Header") return "std_msgs/Header";
  if (type.find('/') != std::string_view::npos) return std::string(type);
  const std::string own = std::string(package) + "/" + std::string(type);
  return types().contains(own) ? own : "";
}

void add_used_types(const std::string& name, std::vector<std::string>& names) {
  const std::string_view package = std::string_view(name).substr(0, name.find('/'));
  for (const std::string& field : types().at(name)) {
    const std::string used = used_type(field, package);
    if (used.empty() || std::ranges::find(names, used) != names.end()) continue;
    names.push_back(used);
    add_used_types(used, names);
  }
}

}  // namespace

std::optional<std::string> standard_definition(std::string_view type) {
  const std::size_t middle = type.find("/msg/");
  if (middle == std::string_view::npos) return std::nullopt;
  const std::string name = std::string(type.substr(0, middle)) + "/" + std::string(type.substr(middle + 5));
  if (!types().contains(name)) return std::nullopt;
  std::vector<std::string> names{name};
  add_used_types(name, names);
  std::string text;
  for (const std::string& own : names) {
    if (!text.empty()) text += std::string(80, '=') + "\nMSG: " + own + "\n";
    for (const std::string& field : types().at(own)) {
      const std::string used = used_type(field, std::string_view(own).substr(0, own.find('/')));
      text += used.empty() ? field : used + field.substr(field.find_first_of(" ["));
      text += '\n';
    }
  }
  return text;
}

}  // namespace rehearse::bag
