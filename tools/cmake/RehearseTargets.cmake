# Compiler options and output folders of every target of Rehearse. They are in one place, because bits depend on them.

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(CMAKE_INSTALL_RPATH "$ORIGIN;$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")

# Unity builds: several sources of a target are compiled together, because half of a unit's time is spent in headers
# that the others include as well. With -DCMAKE_UNITY_BUILD=OFF each source is compiled separately: better for editing
# one.
if(PROJECT_IS_TOP_LEVEL AND NOT DEFINED CMAKE_UNITY_BUILD)
  set(CMAKE_UNITY_BUILD ON)
endif()
if(NOT DEFINED CMAKE_UNITY_BUILD_BATCH_SIZE)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE 40)
endif()

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

find_package(Eigen3 3.4 REQUIRED NO_MODULE)

add_library(rehearse_flags INTERFACE)
target_compile_options(rehearse_flags INTERFACE
  -ffp-contract=off  # a fused multiply-add rounds once where two instructions round twice: other bits on other CPUs
  -fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=  # messages name files from the checkout on, wherever it lies
  # in a unity build, declarations of one source shadow internal names of others
  $<$<NOT:$<BOOL:${CMAKE_UNITY_BUILD}>>:-Wshadow>
  -Wall -Wextra -Wpedantic -Wnon-virtual-dtor -Woverloaded-virtual -Wimplicit-fallthrough
  $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>  # it takes the sources of a unity build for headers
  $<$<BOOL:${REHEARSE_WERROR}>:-Werror>
  # Line numbers are enough to debug our own code; types take a third of the compiler's time, and seconds of gdb's. gdb
  # shows controllers by the types of controllers, and of the sources given to rehearse_types_for_gdb().
  $<$<AND:$<CONFIG:RelWithDebInfo>,$<NOT:$<STREQUAL:$<TARGET_PROPERTY:TYPE>,MODULE_LIBRARY>>>:-g1>)

# For code that takes little of a tick's time (most of it runs once per verb, file or verdict): the compiler needs two
# thirds of the time. Builds with flags of their own compile everything with them, unless REHEARSE_COLD_FLAGS is set.
if(CMAKE_CXX_FLAGS_RELWITHDEBINFO STREQUAL "-O2 -g -DNDEBUG")
  set(REHEARSE_COLD_FLAGS -Og CACHE STRING "Options of code that takes little of a tick's time")
endif()
add_library(rehearse_cold_flags INTERFACE)
target_link_libraries(rehearse_cold_flags INTERFACE rehearse_flags)
target_compile_options(rehearse_cold_flags INTERFACE $<$<CONFIG:RelWithDebInfo>:${REHEARSE_COLD_FLAGS}>)

# For code that takes most of a tick's time. GCC leaves products of Eigen's 3 x 3 matrices as calls, which are a tenth of
# a step of the direct solver.
add_library(rehearse_hot_flags INTERFACE)
target_link_libraries(rehearse_hot_flags INTERFACE rehearse_flags)
target_compile_definitions(rehearse_hot_flags INTERFACE
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

find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)
add_library(rehearse_xxhash INTERFACE)
target_include_directories(rehearse_xxhash INTERFACE ${XXHASH_INCLUDE_DIR})

# rehearse_types_for_gdb(SOURCES...): these sources are compiled separately, with all the types that they use.
function(rehearse_types_for_gdb)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON COMPILE_OPTIONS
    "$<$<CONFIG:RelWithDebInfo>:-g;$<IF:$<CXX_COMPILER_ID:GNU>,-femit-class-debug-always,-fstandalone-debug>>")
endfunction()

# For tests, which may include headers of all rooms, and for programs, which may include those after DOOR.
add_library(rehearse_private_headers INTERFACE)
target_include_directories(rehearse_private_headers INTERFACE ${PROJECT_SOURCE_DIR}/engine/src ${PROJECT_SOURCE_DIR}/harness/src)

# rehearse_room(NAME [HOT|COLD] SOURCES... PUBLIC headers... DOOR headers... MAY_USE rooms... LIBRARIES targets...): a folder
# below engine/src or harness/src as a separate target, rehearse_room_NAME. Without sources it is a folder of headers.
# HOT, COLD: the room takes most or little of a tick's time (rehearse_hot_flags, rehearse_cold_flags).
#
# A file of the room may include the room's own headers and those of the rooms after MAY_USE, no others: headers in
# their folders, by their paths below src, and their installed headers (PUBLIC, in include/rehearse). Programs in tools/
# may include installed headers, and the headers after DOOR. tests/determinism/rooms_test.cpp reads all this from the
# targets. LIBRARIES are targets of other projects, and Rehearse::cnoid.
function(rehearse_room name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "HOT;COLD" "" "SOURCES;PUBLIC;DOOR;MAY_USE;LIBRARIES")
  list(TRANSFORM arg_MAY_USE PREPEND rehearse_room_)
  set(room rehearse_room_${name})
  string(REGEX MATCH "^${PROJECT_SOURCE_DIR}/[a-z]+" part ${CMAKE_CURRENT_SOURCE_DIR})
  if(arg_SOURCES)
    add_library(${room} OBJECT ${arg_SOURCES})
    target_compile_features(${room} PRIVATE cxx_std_20)
    target_include_directories(${room} PUBLIC ${part}/include ${part}/src)
    set(flags rehearse_flags)
    if(arg_COLD)
      set(flags rehearse_cold_flags)
    elseif(arg_HOT)
      set(flags rehearse_hot_flags)
    endif()
    target_link_libraries(${room} PUBLIC ${arg_MAY_USE} ${arg_LIBRARIES} PRIVATE ${flags})
  else()
    add_library(${room} INTERFACE)
    target_include_directories(${room} INTERFACE ${part}/src)
    target_link_libraries(${room} INTERFACE ${arg_MAY_USE})
  endif()
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
    get_target_property(type ${room} TYPE)
    set(links "$<TARGET_PROPERTY:${room},LINK_LIBRARIES>")
    if(type STREQUAL INTERFACE_LIBRARY)
      set(links "$<TARGET_PROPERTY:${room},INTERFACE_LINK_LIBRARIES>")
    endif()
    string(APPEND lines "${room}|$<TARGET_PROPERTY:${room},REHEARSE_FOLDER>|${links}"
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
  # The library's own functions are bound when it is linked, not by name at every start.
  set(exports ${PROJECT_SOURCE_DIR}/tools/cmake/exports.map)
  target_link_options(rehearse_${name} PRIVATE -Wl,-Bsymbolic-functions -Wl,--version-script=${exports})
  set_target_properties(rehearse_${name} PROPERTIES LINK_DEPENDS ${exports})
  foreach(room IN LISTS arg_ROOMS)
    target_sources(rehearse_${name} PRIVATE $<TARGET_OBJECTS:rehearse_room_${room}>)
    get_target_property(libraries rehearse_room_${room} REHEARSE_LIBRARIES)
    target_link_libraries(rehearse_${name} PRIVATE ${libraries})
  endforeach()
  if(arg_ROOMS)
    string(REGEX MATCH "^${PROJECT_SOURCE_DIR}/[a-z]+" part ${CMAKE_CURRENT_SOURCE_DIR})
    target_include_directories(rehearse_${name} PUBLIC
      $<BUILD_INTERFACE:${part}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  endif()
  set_property(GLOBAL APPEND PROPERTY REHEARSE_LIBRARIES rehearse_${name})
endfunction()
