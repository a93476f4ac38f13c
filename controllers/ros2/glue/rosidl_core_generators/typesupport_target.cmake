# The target that packages link to use messages of their own: rosidl_get_typesupport_target(... rosidl_typesupport_cpp).
# It is the introspection, which is the only type support here.
set(typesupport_target ${rosidl_generate_interfaces_TARGET}__rosidl_typesupport_cpp)
add_library(${typesupport_target} INTERFACE)
add_library(${PROJECT_NAME}::${typesupport_target} ALIAS ${typesupport_target})
target_link_libraries(${typesupport_target} INTERFACE
  ${rosidl_generate_interfaces_TARGET}__rosidl_generator_cpp
  ${rosidl_generate_interfaces_TARGET}__rosidl_typesupport_introspection_cpp)
add_dependencies(${rosidl_generate_interfaces_TARGET} ${typesupport_target})
if(NOT rosidl_generate_interfaces_SKIP_INSTALL)
  install(TARGETS ${typesupport_target} EXPORT ${typesupport_target})
  rosidl_export_typesupport_targets(__rosidl_typesupport_cpp ${typesupport_target})
  ament_export_targets(${typesupport_target})
endif()
