# How every target of ours is compiled and where it lands. One place, because bits depend on it.

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(CMAKE_INSTALL_RPATH "$ORIGIN;$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")

# Sources of a target are compiled together, some at a time: half of a unit's time goes into headers that its neighbours
# include as well. With -DCMAKE_UNITY_BUILD=OFF each is compiled by itself: for whoever edits one and compiles again.
if(PROJECT_IS_TOP_LEVEL AND NOT DEFINED CMAKE_UNITY_BUILD)
  set(CMAKE_UNITY_BUILD ON)
endif()
if(NOT DEFINED CMAKE_UNITY_BUILD_BATCH_SIZE)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE 12)
endif()

include(RehearseBits)
rehearse_refuse_other_flags()

find_package(Eigen3 3.4 REQUIRED NO_MODULE)

add_library(rehearse_flags INTERFACE)
target_compile_options(rehearse_flags INTERFACE
  -ffp-contract=off  # a fused multiply-add rounds once where two instructions round twice: other bits on other CPUs
  # what a source declares shadows what its neighbours of a unity build keep to themselves
  $<$<NOT:$<BOOL:${CMAKE_UNITY_BUILD}>>:-Wshadow>
  -Wall -Wextra -Wpedantic -Wnon-virtual-dtor -Woverloaded-virtual -Wimplicit-fallthrough
  $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>  # it takes the sources of a unity build for headers
  $<$<BOOL:${REHEARSE_WERROR}>:-Werror>)
if(REHEARSE_SANITIZE)
  add_compile_options(-fsanitize=${REHEARSE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${REHEARSE_SANITIZE})
endif()

# rehearse_add_library(NAME SOURCES... ): the shared library librehearse_NAME.so, target Rehearse::NAME.
function(rehearse_add_library name)
  add_library(rehearse_${name} SHARED ${ARGN})
  add_library(Rehearse::${name} ALIAS rehearse_${name})
  set_target_properties(rehearse_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(rehearse_${name} PUBLIC cxx_std_20)
  target_include_directories(rehearse_${name} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
  target_link_libraries(rehearse_${name} PRIVATE $<BUILD_INTERFACE:rehearse_flags>)
endfunction()
