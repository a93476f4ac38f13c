# cmake -DMODULES=FOLDER -DFOLDER=FOLDER -DCOMPILER=FILE -P build_guard_test.cmake: the configuration of a build whose
# flags change bits is refused, wherever the flags come from; for a user's controllers CMake prints a warning.

file(REMOVE_RECURSE ${FOLDER})
file(WRITE ${FOLDER}/ours/CMakeLists.txt "
cmake_minimum_required(VERSION 3.25)
project(Guarded CXX)
add_compile_options(\${MORE_OPTIONS})
include(${MODULES}/RehearseBits.cmake)
rehearse_refuse_other_flags()
message(STATUS \"marked: '\${REHEARSE_OTHER_FLAGS}'\")
")
file(WRITE ${FOLDER}/theirs/CMakeLists.txt "
cmake_minimum_required(VERSION 3.25)
project(Users CXX)
include(${MODULES}/RehearseControllers.cmake)
add_library(Rehearse::cnoid INTERFACE IMPORTED)
rehearse_add_simple_controller(Walker walker.cpp)
target_compile_options(Walker PRIVATE \${WALKER_OPTIONS})
")
file(WRITE ${FOLDER}/theirs/walker.cpp "")
file(WRITE ${FOLDER}/toolchain.cmake "set(CMAKE_CXX_FLAGS_INIT \"-mavx2\")\n")
file(WRITE ${FOLDER}/wrapped "#!/bin/sh\nexec ${COMPILER} -mfma \"\$@\"\n")
file(CHMOD ${FOLDER}/wrapped PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)

set(count 0)
# configure(PROJECT WORDS... ): status and output of cmake; the variable CXXFLAGS is passed as CXXFLAGS.
macro(configure project)
  math(EXPR count "${count} + 1")
  execute_process(
    COMMAND ${CMAKE_COMMAND} -E env "CXXFLAGS=${CXXFLAGS}" ${CMAKE_COMMAND} -S ${FOLDER}/${project} -B ${FOLDER}/build${count}
            ${ARGN}
    RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  string(REGEX REPLACE "[ \n]+" " " output "${output}")  # CMake breaks lines where it likes
endmacro()

# refused(NAMED WORDS...): the build is refused, and the message names the flag.
macro(refused named)
  configure(ours ${ARGN})
  if(status EQUAL 0 OR NOT output MATCHES "flags that change the bits of recordings: [^ ]*.*${named}")
    message(SEND_ERROR "expected to be refused for ${named}: ${ARGN}\n${output}")
  endif()
endmacro()

macro(accepted marked)
  configure(ours ${ARGN})
  if(NOT status EQUAL 0 OR NOT output MATCHES "marked: '${marked}'")
    message(SEND_ERROR "expected to be accepted and marked '${marked}': ${ARGN}\n${output}")
  endif()
endmacro()

macro(warned wanted)
  configure(theirs -DCMAKE_CXX_COMPILER=${COMPILER} ${ARGN})
  if(NOT status EQUAL 0)
    message(SEND_ERROR "a user's project doesn't configure: ${ARGN}\n${output}")
  endif()
  set(is OFF)
  if(output MATCHES "The controller Walker is built with -")
    set(is ON)
  endif()
  if(NOT is STREQUAL "${wanted}")
    message(SEND_ERROR "expected a warning (${wanted}) of: ${ARGN}\n${output}")
  endif()
endmacro()

set(compiler -DCMAKE_CXX_COMPILER=${COMPILER})
accepted("" ${compiler})
accepted("" ${compiler} "-DCMAKE_CXX_FLAGS=-O2 -g -Wall -march=x86-64 -mtune=native" -DCMAKE_BUILD_TYPE=Debug)
foreach(flag -march=native -march=x86-64-v3 -mfma -mavx2 -ffast-math -Ofast -ffp-contract=fast)
  refused("${flag}" ${compiler} "-DCMAKE_CXX_FLAGS=-O2 ${flag}")
endforeach()
refused("-mfma" ${compiler} -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS_RELEASE=-O3 -mfma")
refused("-mavx" ${compiler} -DMORE_OPTIONS=-mavx)
refused("-mavx2" ${compiler} --toolchain ${FOLDER}/toolchain.cmake)
refused("__FMA__" -DCMAKE_CXX_COMPILER=${FOLDER}/wrapped)
set(CXXFLAGS "-march=native")
refused("-march=native" ${compiler})
set(CXXFLAGS "")
accepted("-mfma" ${compiler} -DCMAKE_CXX_FLAGS=-mfma -DREHEARSE_ALLOW_OTHER_FLAGS=ON)

warned(OFF)
warned(ON -DWALKER_OPTIONS=-ffast-math)
warned(ON -DCMAKE_CXX_FLAGS=-march=native)
