# A library that sets variables by rehearse_variable() loads into a program without Rehearse, whatever compiler,
# language and linker strictness it was made with; a program that defines the function receives the variables.
# cmake -D SOURCE=folder -D INCLUDE=folder -D OUTPUT=folder -D GXX=g++ [-D CLANGXX=clang++] -P load_everywhere.cmake
set(strict -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror)
set(linking -Wl,-z,now -Wl,-z,defs -Wl,--no-undefined)
file(MAKE_DIRECTORY ${OUTPUT})

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE messages)
  if(result)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\n${output}${messages}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

function(expect library listens expected)
  run(${OUTPUT}/program${listens} ${OUTPUT}/${library})
  if(NOT output STREQUAL expected)
    message(FATAL_ERROR "${library} in program${listens} says '${output}', expected '${expected}'")
  endif()
endfunction()

run(${GXX} -x c -std=c99 -D_GNU_SOURCE ${strict} ${SOURCE}/plain_program.c -o ${OUTPUT}/program -ldl)
run(${GXX} -x c -std=c99 -D_GNU_SOURCE -DLISTENS ${strict} ${SOURCE}/plain_program.c -o ${OUTPUT}/program_listens
    -ldl -rdynamic)
foreach(compiler GXX CLANGXX)
  if(NOT ${compiler})
    continue()
  endif()
  foreach(language c99 c11 c++11 c++17 c++20)
    string(REGEX REPLACE "[0-9]+" "" kind ${language})
    foreach(flags -O0 -O2 "-O2;-fvisibility=hidden")
      list(JOIN flags "" suffix)
      set(library speaker_${compiler}_${language}${suffix}.so)
      run(${${compiler}} -x ${kind} -std=${language} ${strict} ${flags} -I${INCLUDE} -fPIC -shared ${linking}
          ${SOURCE}/speaker.c -o ${OUTPUT}/${library})
      expect(${library} "" "42\n")
      expect(${library} _listens "phase=0.25 phase=0.5 42\n")
    endforeach()
  endforeach()
endforeach()
