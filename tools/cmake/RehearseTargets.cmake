# Compiler options and output folders of every target of Rehearse. They are in one place, because bits depend on them.

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_LINK_DEPENDS_NO_SHARED ON)  # a program need not be linked anew when a library that it loads has changed
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(CMAKE_INSTALL_RPATH "$ORIGIN;$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")

# Unity builds: several sources of a target are compiled together, because much of a unit's time is spent in templates that
# the others instantiate as well. rehearse_unite() forms the groups of rooms and tests. With -DCMAKE_UNITY_BUILD=OFF each
# source is compiled separately.
if(PROJECT_IS_TOP_LEVEL AND NOT DEFINED CMAKE_UNITY_BUILD)
  set(CMAKE_UNITY_BUILD ON)
endif()
if(NOT DEFINED CMAKE_UNITY_BUILD_BATCH_SIZE)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE 40)
endif()
set(REHEARSE_UNITY_KB 120 CACHE STRING "About so much of a target's sources is compiled together [KB]; ten seconds for a fast core")

# rehearse_unite(TARGET SOURCES...): divides the sources of a unity build into groups of similar size, in their order.
function(rehearse_unite target)
  set(all 0)
  foreach(source IN LISTS ARGN)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} OUTPUT_VARIABLE file)
    set(size_of_${source} 0)
    if(EXISTS ${file})
      file(SIZE ${file} size_of_${source})
    endif()
    math(EXPR all "${all} + ${size_of_${source}}")
  endforeach()
  math(EXPR groups "(${all} + 500 * ${REHEARSE_UNITY_KB}) / (1000 * ${REHEARSE_UNITY_KB})")
  if(groups LESS 1)
    set(groups 1)
  endif()
  set(before 0)
  foreach(source IN LISTS ARGN)
    math(EXPR group "(${before} + ${size_of_${source}} / 2) * ${groups} / (${all} + 1)")
    math(EXPR before "${before} + ${size_of_${source}}")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${target}_${group})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
endfunction()

# Packages have the same bytes from whatever folder they are built: debug information has this prefix in the place of the
# checkout, and programs find the build's libraries relative to themselves. gdb then needs `set substitute-path`.
set(REHEARSE_SOURCE_PREFIX "" CACHE STRING "The place of the sources in debug information, instead of the checkout; tools/package sets it")
if(REHEARSE_SOURCE_PREFIX)
  add_compile_options(-fdebug-prefix-map=${PROJECT_SOURCE_DIR}=${REHEARSE_SOURCE_PREFIX})
  set(CMAKE_BUILD_RPATH_USE_ORIGIN ON)
endif()

# Code that only x86-64 can run is left out of builds for other processors.
set(REHEARSE_ON_X86_64 OFF)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|amd64|AMD64)$")
  set(REHEARSE_ON_X86_64 ON)
endif()

include(RehearseBits)
rehearse_refuse_other_flags()

set(has_types $<OR:$<STREQUAL:$<TARGET_PROPERTY:TYPE>,MODULE_LIBRARY>,$<BOOL:$<TARGET_PROPERTY:REHEARSE_HAS_TYPES>>>)
add_library(rehearse_flags INTERFACE)
target_compile_options(rehearse_flags INTERFACE
  -ffp-contract=off  # a fused multiply-add rounds once where two instructions round twice: other bits on other CPUs
  -fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=  # messages name files from the checkout on, wherever it lies
  # in a unity build, declarations of one source shadow internal names of others
  $<$<NOT:$<BOOL:${CMAKE_UNITY_BUILD}>>:-Wshadow>
  -Wall -Wextra -Wpedantic -Wnon-virtual-dtor -Woverloaded-virtual -Wimplicit-fallthrough
  $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>  # it takes the sources of a unity build for headers
  $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>  # ccache needs it
  # the compiler's garbage collection takes a tenth of its time; most units end below this size [KB]
  $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1000000>
  $<$<BOOL:${REHEARSE_WERROR}>:-Werror>
  # Line numbers are enough to debug our own code; types take a third of the compiler's time, and seconds of gdb's. gdb
  # shows controllers by the types of controllers, and of parts of the kind gdb.
  $<$<AND:$<CONFIG:RelWithDebInfo>,$<NOT:${has_types}>>:-g1>)

# For code that takes little of a tick's time (most of it runs once per verb, file or verdict): the compiler needs two
# thirds of the time. Builds with flags of their own compile everything with them, unless REHEARSE_COLD_FLAGS is set.
if(CMAKE_CXX_FLAGS_RELWITHDEBINFO STREQUAL "-O2 -g -DNDEBUG")
  set(REHEARSE_COLD_FLAGS -Og CACHE STRING "Options of code that takes little of a tick's time")
endif()
add_library(rehearse_cold_flags INTERFACE)
target_link_libraries(rehearse_cold_flags INTERFACE rehearse_flags)
target_compile_options(rehearse_cold_flags INTERFACE $<$<CONFIG:RelWithDebInfo>:${REHEARSE_COLD_FLAGS}>)

# For code whose types gdb shows: all of them, not only those that the source uses.
add_library(rehearse_gdb_flags INTERFACE)
target_link_libraries(rehearse_gdb_flags INTERFACE rehearse_flags)
target_compile_options(rehearse_gdb_flags INTERFACE
  $<$<CONFIG:RelWithDebInfo>:$<IF:$<CXX_COMPILER_ID:GNU>,-femit-class-debug-always,-fstandalone-debug>>)

# For code that takes most of a tick's time. GCC leaves products of Eigen's 3 x 3 matrices as calls, which are a tenth of
# a step of the direct solver.
add_library(rehearse_inlined_eigen INTERFACE)
target_compile_definitions(rehearse_inlined_eigen INTERFACE
  "EIGEN_STRONG_INLINE=inline __attribute__((always_inline))")

if(REHEARSE_SANITIZE)
  add_compile_options(-fsanitize=${REHEARSE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${REHEARSE_SANITIZE})
  if(REHEARSE_SANITIZE MATCHES address AND CMAKE_CXX_COMPILER_ID STREQUAL Clang AND NOT REHEARSE_FUZZ)
    # As gcc does. A runtime in the program itself would have functions before those of an audit's interposer.
    execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-runtime-dir
      OUTPUT_VARIABLE runtimes OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    add_link_options(-shared-libasan "LINKER:-rpath,${runtimes}")
    add_compile_definitions(__SANITIZE_ADDRESS__=1)
  endif()
endif()

# For tests, which may include headers of all rooms, and for programs, which may include those after DOOR.
add_library(rehearse_private_headers INTERFACE)
target_include_directories(rehearse_private_headers INTERFACE ${PROJECT_SOURCE_DIR}/engine/src ${PROJECT_SOURCE_DIR}/harness/src)

# Eigen and fmt, and macros on which their headers depend: the same for all that reuse the precompiled ones.
add_library(rehearse_parsed INTERFACE)
target_link_libraries(rehearse_parsed INTERFACE Eigen3::Eigen fmt::fmt)
# Eigen's alignment is part of the layout of public types: it must not depend on a user's -m flags.
target_compile_definitions(rehearse_parsed INTERFACE EIGEN_MAX_ALIGN_BYTES=16)

# Headers that most sources of the rooms and of the command include are parsed once for all. GCC stores the level of
# optimisation with them, so there is one target for each. The preset clang parses them in each source, and so finds a
# source that lacks an include. GCC stores the level of debug information, too, so the parts of the kind gdb, which have
# all types, parse these headers themselves.
function(rehearse_precompile name flags)  # and more headers
  set(empty ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  file(CONFIGURE OUTPUT ${empty} CONTENT "")
  add_library(${name} OBJECT ${empty})
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_link_libraries(${name} PRIVATE ${flags} rehearse_parsed)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/engine/include ${PROJECT_SOURCE_DIR}/harness/include)
  target_precompile_headers(${name} PRIVATE
    <algorithm> <array> <bit> <charconv> <chrono> <cmath> <cstdint> <cstring> <deque> <filesystem> <fstream> <functional>
    <iterator> <limits> <map> <memory> <numbers> <numeric> <optional> <set> <span> <sstream> <string> <string_view>
    <tuple> <utility> <variant> <vector> <Eigen/Core> <Eigen/Geometry> <fmt/format.h> <fmt/ranges.h>
    <nlohmann/json.hpp> <rehearse/io.h> <rehearse/mcap.h> <rehearse/messages.h> <rehearse/model.h>
    <rehearse/run_options.h> <rehearse/scenario.h> <rehearse/trace.h> ${ARGN})
endfunction()
rehearse_precompile(rehearse_cold_headers rehearse_cold_flags)
rehearse_precompile(rehearse_hot_headers rehearse_flags)

# rehearse_add_part(TARGET KIND SOURCES...): objects of sources with the same options. KIND cold: code that takes little
# of a tick's time; hot: it takes much; gdb: gdb shows its types.
function(rehearse_add_part target kind)
  set(flags_cold rehearse_cold_flags)
  set(flags_hot rehearse_flags)
  set(flags_gdb rehearse_gdb_flags)
  add_library(${target} OBJECT ${ARGN})
  target_link_libraries(${target} PRIVATE ${flags_${kind}} rehearse_parsed)
  if(kind STREQUAL gdb)
    set_target_properties(${target} PROPERTIES REHEARSE_HAS_TYPES ON)
  endif()
  rehearse_unite(${target} ${ARGN})
endfunction()

# rehearse_room(NAME SOURCES... [HOT sources...] [GDB sources...] PUBLIC headers... DOOR headers... MAY_USE rooms...
# LIBRARIES targets...): a folder below engine/src or harness/src as a separate target, rehearse_room_NAME. Without
# sources it is a folder of headers. HOT: sources that take much of a tick's time. GDB: sources with the types that gdb
# shows of controllers.
#
# A file of the room may include the room's own headers and those of the rooms after MAY_USE, no others: headers in
# their folders, by their paths below src, and their installed headers (PUBLIC, in include/rehearse). Programs in tools/
# may include installed headers, and the headers after DOOR. tests/determinism/rooms_test.cpp reads all this from the
# targets. LIBRARIES are targets of other projects, and Rehearse::cnoid.
function(rehearse_room name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;HOT;GDB;PUBLIC;DOOR;MAY_USE;LIBRARIES")
  list(TRANSFORM arg_MAY_USE PREPEND rehearse_room_)
  set(room rehearse_room_${name})
  string(REGEX MATCH "^${PROJECT_SOURCE_DIR}/[a-z]+" part ${CMAKE_CURRENT_SOURCE_DIR})
  add_library(${room} INTERFACE)
  target_include_directories(${room} INTERFACE ${part}/src)
  if(EXISTS ${part}/include)
    target_include_directories(${room} INTERFACE ${part}/include)
  endif()
  target_link_libraries(${room} INTERFACE ${arg_MAY_USE} ${arg_LIBRARIES} rehearse_parsed)
  set(kind_of_SOURCES cold)
  set(kind_of_HOT hot)
  set(kind_of_GDB gdb)
  foreach(key SOURCES HOT GDB)
    if(arg_${key})
      set(kind ${kind_of_${key}})
      rehearse_add_part(${room}_${kind} ${kind} ${arg_${key}})
      target_compile_features(${room}_${kind} PRIVATE cxx_std_20)
      target_link_libraries(${room}_${kind} PRIVATE ${room})
      if(TARGET rehearse_${kind}_headers)
        target_precompile_headers(${room}_${kind} REUSE_FROM rehearse_${kind}_headers)
      endif()
    endif()
  endforeach()
  set_target_properties(${room} PROPERTIES
    REHEARSE_FOLDER "${CMAKE_CURRENT_SOURCE_DIR}" REHEARSE_PUBLIC "${arg_PUBLIC}" REHEARSE_DOOR "${arg_DOOR}"
    REHEARSE_LIBRARIES "${arg_LIBRARIES}")
  set_property(GLOBAL APPEND PROPERTY REHEARSE_ROOMS ${room})
  list(TRANSFORM arg_PUBLIC PREPEND ${part}/include/rehearse/)
  set_property(GLOBAL APPEND PROPERTY REHEARSE_HEADERS ${arg_PUBLIC})
endfunction()

# rehearse_write_rooms(FILE): writes the graph of the rooms for the test: a line each of name, folder, links, public
# headers and doors, separated by |.
function(rehearse_write_rooms file)
  get_property(rooms GLOBAL PROPERTY REHEARSE_ROOMS)
  set(lines "")
  foreach(room IN LISTS rooms)
    string(APPEND lines "${room}|$<TARGET_PROPERTY:${room},REHEARSE_FOLDER>"
      "|$<TARGET_PROPERTY:${room},INTERFACE_LINK_LIBRARIES>"
      "|$<TARGET_PROPERTY:${room},REHEARSE_PUBLIC>|$<TARGET_PROPERTY:${room},REHEARSE_DOOR>\n")
  endforeach()
  file(GENERATE OUTPUT ${file} CONTENT "${lines}")
endfunction()

# rehearse_add_library(NAME SOURCES... ROOMS rooms...): the shared library librehearse_NAME.so, target Rehearse::NAME.
function(rehearse_add_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "ROOMS")
  add_library(rehearse_${name} SHARED ${arg_UNPARSED_ARGUMENTS})
  add_library(Rehearse::${name} ALIAS rehearse_${name})
  set_target_properties(rehearse_${name} PROPERTIES EXPORT_NAME ${name}
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_compile_features(rehearse_${name} PUBLIC cxx_std_20)
  target_link_libraries(rehearse_${name} PRIVATE $<BUILD_INTERFACE:rehearse_flags>)
  # It finds the other libraries beside itself, also in the build folder: CMake's own path there has empty entries, each of
  # which is searched for each library.
  set_target_properties(rehearse_${name} PROPERTIES INSTALL_RPATH $ORIGIN BUILD_WITH_INSTALL_RPATH ON)
  # The library's own names are bound when it is linked, not by name at every start.
  set(exports ${PROJECT_SOURCE_DIR}/tools/cmake/exports.map)
  target_link_options(rehearse_${name} PRIVATE -Wl,-Bsymbolic -Wl,--version-script=${exports})
  set_target_properties(rehearse_${name} PROPERTIES LINK_DEPENDS ${exports})
  # Of an inline function that several objects contain, the linker takes the first: that of sources that are optimised.
  foreach(kind hot gdb cold)
    foreach(room IN LISTS arg_ROOMS)
      if(TARGET rehearse_room_${room}_${kind})
        target_sources(rehearse_${name} PRIVATE $<TARGET_OBJECTS:rehearse_room_${room}_${kind}>)
      endif()
    endforeach()
  endforeach()
  foreach(room IN LISTS arg_ROOMS)
    get_target_property(libraries rehearse_room_${room} REHEARSE_LIBRARIES)
    target_link_libraries(rehearse_${name} PRIVATE ${libraries})
  endforeach()
  if(arg_ROOMS)
    target_include_directories(rehearse_${name} PUBLIC
      $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/engine/include> $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/harness/include>
      $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  endif()
  set_property(GLOBAL APPEND PROPERTY REHEARSE_LIBRARIES rehearse_${name})
endfunction()
