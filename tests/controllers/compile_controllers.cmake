# Compiles every SimpleController under SOURCE to an object, and reports how many succeed.
# cmake -D SOURCE=folder -D CHECKOUTS=pattern -D LEAST=count -D OUTPUT=folder -D COMPILER=command -D FLAGS=flags
#       -P compile_controllers.cmake
#
# CHECKOUTS are the folders below SOURCE that are searched; without it SOURCE itself is the checkout. Each controller has the usual folders
# of its checkout on its include path. One that does not compile is printed with its reason, and each reason with its
# count. Only a header that Rehearse does not have to offer is a reason: of ROS, of another library, of a plugin. Any
# other mistake fails.
cmake_minimum_required(VERSION 3.25)

# The kind of a header, as REGEX and NAME, in the order in which they are tried.
set(kinds
  "^(ros|tf|tf2|rclcpp|image_transport|[a-z0-9_]+_msgs)/" "ROS"
  "^pcl/" "PCL"
  "^boost/" "Boost"
  "^(robotoc)/" "another library"
  "^cnoid/(MessageView|Rotor|Thruster|DoseMeter|ext/.*)$" "a plugin of Choreonoid")

# Sets `result` to the kind of the header, or to "".
function(find_kind header result)
  set(rest ${kinds})
  while(rest)
    list(POP_FRONT rest pattern name)
    if(header MATCHES "${pattern}")
      set(${result} "${name}" PARENT_SCOPE)
      return()
    endif()
  endwhile()
  set(${result} "" PARENT_SCOPE)
endfunction()

# Sets `result` to what the source needs and Rehearse does not offer; "": nothing. The header that is missing decides,
# else the other headers of the source: messages of ROS are made when it is built.
function(find_reason source messages result)
  set(kind "")
  if(messages MATCHES "fatal error: ([^:]+): No such file")
    find_kind("${CMAKE_MATCH_1}" kind)
    if(NOT kind AND NOT CMAKE_MATCH_1 MATCHES "^cnoid/")
      file(STRINGS ${source} includes REGEX "^[ \t]*#include")
      foreach(include ${includes})
        if(NOT kind AND include MATCHES "[<\"]([^>\"]+)[>\"]")
          find_kind("${CMAKE_MATCH_1}" kind)
        endif()
      endforeach()
    endif()
  endif()
  set(${result} "${kind}" PARENT_SCOPE)
endfunction()

set(checkouts ${SOURCE})
if(CHECKOUTS)
  file(GLOB checkouts LIST_DIRECTORIES true ${SOURCE}/${CHECKOUTS})
  list(SORT checkouts)
endif()
file(MAKE_DIRECTORY ${OUTPUT})
set(controllers 0)
set(compiled 0)
set(wrong "")
set(reasons "")
foreach(checkout ${checkouts})
  file(GLOB_RECURSE candidates ${checkout}/*.cpp)
  list(SORT candidates)
  foreach(candidate ${candidates})
    file(STRINGS ${candidate} factory REGEX "^[ \t]*CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY" LIMIT_COUNT 1)
    if(NOT factory)
      continue()
    endif()
    math(EXPR controllers "${controllers} + 1")
    cmake_path(RELATIVE_PATH candidate BASE_DIRECTORY ${SOURCE} OUTPUT_VARIABLE name)
    cmake_path(GET candidate PARENT_PATH folder)
    string(REPLACE "/" "_" object ${name}.o)
    execute_process(
      COMMAND ${COMPILER} ${FLAGS} -I${checkout} -I${checkout}/src -I${checkout}/include -I${folder}/include
        -w -fPIC -c ${candidate} -o ${OUTPUT}/${object}
      RESULT_VARIABLE failed ERROR_VARIABLE messages OUTPUT_QUIET)
    if(NOT failed)
      math(EXPR compiled "${compiled} + 1")
      continue()
    endif()
    string(REGEX MATCH "error:[^\n]*" first_error "${messages}")
    find_reason(${candidate} "${messages}" reason)
    if(NOT reason)
      list(APPEND wrong ${name})
      set(reason "a mistake")
    endif()
    message(STATUS "does not compile: ${name}: ${reason}: ${first_error}")
    list(APPEND reasons "${reason}")
  endforeach()
endforeach()

message(STATUS "${compiled} of ${controllers} controllers compile")
set(each ${reasons})
list(REMOVE_DUPLICATES each)
foreach(reason ${each})
  set(same ${reasons})
  list(FILTER same INCLUDE REGEX "^${reason}$")
  list(LENGTH same count)
  message(STATUS "  ${count} need ${reason}")
endforeach()
if(wrong)
  message(FATAL_ERROR "these must compile: ${wrong}")
endif()
if(compiled LESS LEAST)
  message(FATAL_ERROR "at least ${LEAST} must compile")
endif()
