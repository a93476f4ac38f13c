# How every target of ours is compiled and where it lands. One place, because bits depend on it.

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(CMAKE_INSTALL_RPATH "$ORIGIN;$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")

include(RehearseBits)
rehearse_refuse_other_flags()

find_package(Eigen3 3.4 REQUIRED NO_MODULE)

add_library(rehearse_flags INTERFACE)
target_compile_options(rehearse_flags INTERFACE
  -ffp-contract=off  # a fused multiply-add rounds once where two instructions round twice: other bits on other CPUs
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wimplicit-fallthrough
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
