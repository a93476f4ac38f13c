# rehearse_add_simple_controller(NAME sources...): a controller's library, NAME.so, to be named in a scenario.
#
# The library is a module without a prefix, C++17, and links Rehearse::cnoid only. It lands where the harness looks for
# controllers of the build: lib/rehearse/controllers in the build folder. Other libraries that it needs are added with
# target_link_libraries(NAME PRIVATE ...). choreonoid_add_simple_controller is a synonym, so that a CMakeLists.txt
# written for Choreonoid stays as it is.

function(rehearse_add_simple_controller name)
  if(NOT ARGN)
    message(FATAL_ERROR "rehearse_add_simple_controller(${name}): name at least one source file")
  endif()
  add_library(${name} MODULE ${ARGN})
  set_target_properties(${name} PROPERTIES
    PREFIX ""
    CXX_STANDARD 17
    CXX_STANDARD_REQUIRED ON
    CXX_EXTENSIONS OFF
    CXX_VISIBILITY_PRESET hidden  # the factory and the API's classes are visible whatever this says
    VISIBILITY_INLINES_HIDDEN ON
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/rehearse/controllers)
  # A fused multiply-add rounds once where two instructions round twice: other commands on other CPUs.
  target_compile_options(${name} PRIVATE -ffp-contract=off)
  target_link_libraries(${name} PRIVATE Rehearse::cnoid)
endfunction()

function(choreonoid_add_simple_controller name)
  rehearse_add_simple_controller(${name} ${ARGN})
endfunction()
