# Compiles every SimpleController under SOURCE to an object, and reports how many succeed.
# cmake -D SOURCE=checkout -D OUTPUT=folder -D COMPILER=command -D FLAGS=flags -P compile_controllers.cmake
#
# All 34 of Choreonoid's compile; FireController and HoseNozzleController by headers whose particles and sliders do nothing.
set(least_of_all 34)
set(of_all 34)
set(least_in_folder 21)
set(folder sample/SimpleController)

file(GLOB_RECURSE candidates RELATIVE ${SOURCE} ${SOURCE}/*.cpp)
list(SORT candidates)
file(MAKE_DIRECTORY ${OUTPUT})
set(controllers 0)
set(compiled 0)
set(in_folder 0)
set(compiled_in_folder 0)
foreach(candidate ${candidates})
  file(STRINGS ${SOURCE}/${candidate} factory REGEX "^[ \t]*CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY" LIMIT_COUNT 1)
  if(NOT factory)
    continue()
  endif()
  string(REPLACE "/" "_" object ${candidate}.o)
  execute_process(
    COMMAND ${COMPILER} ${FLAGS} -w -fPIC -c ${SOURCE}/${candidate} -o ${OUTPUT}/${object}
    RESULT_VARIABLE failed ERROR_VARIABLE messages OUTPUT_QUIET)
  cmake_path(GET candidate PARENT_PATH parent)
  math(EXPR controllers "${controllers} + 1")
  if(parent STREQUAL folder)
    math(EXPR in_folder "${in_folder} + 1")
  endif()
  if(failed)
    string(REGEX MATCH "[^\n]*error:[^\n]*" first_error "${messages}")
    message(STATUS "does not compile: ${candidate}: ${first_error}")
    continue()
  endif()
  math(EXPR compiled "${compiled} + 1")
  if(parent STREQUAL folder)
    math(EXPR compiled_in_folder "${compiled_in_folder} + 1")
  endif()
endforeach()

message(STATUS "${compiled} of ${controllers} controllers compile, ${compiled_in_folder} of ${in_folder} in ${folder}")
if(compiled LESS least_of_all OR compiled_in_folder LESS least_in_folder)
  message(FATAL_ERROR "at least ${least_of_all} of ${of_all}, and ${least_in_folder} of ${least_in_folder} in ${folder}, "
                      "must compile")
endif()
