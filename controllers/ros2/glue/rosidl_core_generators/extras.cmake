# rosidl_generate_interfaces() runs the generators in the order in which they are found here.
find_package(rosidl_cmake REQUIRED)
find_package(rosidl_adapter REQUIRED)
find_package(rosidl_generator_cpp REQUIRED)
find_package(rosidl_typesupport_introspection_cpp REQUIRED)
# The introspection of C++ finds the generators of C, too. Nothing here uses them, and they take most of the time.
list(FILTER AMENT_EXTENSIONS_rosidl_generate_idl_interfaces EXCLUDE REGEX "^rosidl_(generator|typesupport_introspection)_c:")
find_package(ament_cmake_core REQUIRED)
ament_register_extension(rosidl_generate_idl_interfaces rosidl_core_generators typesupport_target.cmake)
