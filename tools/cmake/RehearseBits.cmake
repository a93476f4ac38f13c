# Compiler flags that change the bits of results, between processors or by rearranging arithmetic.
#
# Rehearse's build refuses them (rehearse_refuse_other_flags). For a user's controllers CMake prints a warning
# (rehearse_warn_of_other_flags): their commands would differ between machines.

# rehearse_find_other_flags(RESULT flags...): those of the flags that change bits; -march=x86-64 (and its levels without
# fused multiply-adds) changes none.
function(rehearse_find_other_flags result)
  set(found "")
  separate_arguments(words UNIX_COMMAND "${ARGN}")
  foreach(word IN LISTS words)
    string(REGEX REPLACE "^SHELL:" "" word "${word}")
    if(word MATCHES "^-m(arch|cpu)=" AND NOT word MATCHES "^-march=x86-64$")
      list(APPEND found ${word})
    elseif(word MATCHES "^(-mfma4?|-mavx.*|-mxop|-mf16c|-msse(3|4.*)|-mssse3|-mfpmath=.*|-m32|-mno-sse2?)$")
      list(APPEND found ${word})
    elseif(word MATCHES "^(-Ofast|-ffast-math|-funsafe-math-optimizations|-fassociative-math|-freciprocal-math)$")
      list(APPEND found ${word})
    elseif(word MATCHES "^(-ffinite-math-only|-fno-signed-zeros|-fsingle-precision-constant|-ffp-contract=(fast|on).*)$")
      list(APPEND found ${word})
    elseif(word MATCHES "^(-ffp-model=(fast|aggressive)|-fexcess-precision=fast|-ffloat-store|-frounding-math)$")
      list(APPEND found ${word})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES found)
  string(REPLACE ";" " " found "${found}")
  set(${result} "${found}" PARENT_SCOPE)
endfunction()

# rehearse_flags_of_directory(RESULT): all flags with which C++ sources of this folder are compiled, from all sources:
# the command line, CXXFLAGS, a toolchain file, add_compile_options.
function(rehearse_flags_of_directory result)
  set(all "${CMAKE_CXX_COMPILER_ARG1} ${CMAKE_CXX_FLAGS}")
  set(configurations ${CMAKE_BUILD_TYPE} ${CMAKE_CONFIGURATION_TYPES})
  foreach(configuration IN LISTS configurations)
    string(TOUPPER "${configuration}" upper)
    string(APPEND all " ${CMAKE_CXX_FLAGS_${upper}}")
  endforeach()
  get_directory_property(options COMPILE_OPTIONS)
  string(REPLACE ";" " " options "${options}")
  set(${result} "${all} ${options}" PARENT_SCOPE)
endfunction()

# rehearse_refuse_other_flags(): ends the configuration if this folder's flags change bits, or if the compiler's
# predefined macros show such a flag (for example of a wrapper). With REHEARSE_ALLOW_OTHER_FLAGS it continues,
# REHEARSE_OTHER_FLAGS names the flags, and recordings state them.
function(rehearse_refuse_other_flags)
  rehearse_flags_of_directory(flags)
  rehearse_find_other_flags(found ${flags})
  if(NOT found)
    rehearse_ask_compiler("${flags}" found)
  endif()
  set(REHEARSE_OTHER_FLAGS "${found}" PARENT_SCOPE)
  if(found AND NOT REHEARSE_ALLOW_OTHER_FLAGS)
    message(FATAL_ERROR
      "Rehearse would be built with flags that change the bits of recordings: ${found}\n"
      "Its goldens would hold on such machines only. Leave them out (CMAKE_CXX_FLAGS, CXXFLAGS, the toolchain file), or "
      "go on with -DREHEARSE_ALLOW_OTHER_FLAGS=ON; recordings then say so and are compared within tolerance.")
  elseif(found)
    message(WARNING "Rehearse is built with flags that change the bits of recordings: ${found}. Recordings say so.")
  endif()
endfunction()

# Flags that are the compiler's own defaults appear in no list. Sets the result to predefined macros that show them.
function(rehearse_ask_compiler flags result)
  separate_arguments(words UNIX_COMMAND "${flags}")
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/bits.cpp "")
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} ${words} -dM -E ${CMAKE_CURRENT_BINARY_DIR}/bits.cpp
    OUTPUT_VARIABLE macros ERROR_QUIET)
  set(found "")
  foreach(macro __FMA__ __FMA4__ __AVX__ __SSE3__ __FAST_MATH__ __ASSOCIATIVE_MATH__ __RECIPROCAL_MATH__)
    if(macros MATCHES "#define ${macro} 1")
      list(APPEND found ${macro})
    endif()
  endforeach()
  if(macros MATCHES "#define __FLT_EVAL_METHOD__ ([^0\n][^\n]*)")
    list(APPEND found "__FLT_EVAL_METHOD__=${CMAKE_MATCH_1}")
  endif()
  string(REPLACE ";" " " found "${found}")
  if(found)
    set(found "the compiler's own (${found})")
  endif()
  set(${result} "${found}" PARENT_SCOPE)
endfunction()

# rehearse_warn_of_other_flags(TARGET): runs at the end of the folder, so that flags set after the target's creation
# count, too.
function(rehearse_warn_of_other_flags target)
  cmake_language(EVAL CODE "cmake_language(DEFER CALL rehearse_warn_now ${target})")
endfunction()

function(rehearse_warn_now target)
  rehearse_flags_of_directory(flags)
  foreach(property COMPILE_OPTIONS LINK_OPTIONS)
    get_target_property(options ${target} ${property})
    if(options)
      string(REPLACE ";" " " options "${options}")
      string(APPEND flags " ${options}")
    endif()
  endforeach()
  rehearse_find_other_flags(found ${flags})
  if(found MATCHES "-Ofast|-ffast-math|-funsafe-math")
    set(more ", and its start-up code changes the arithmetic of the whole process that loads it")
  endif()
  if(found)
    message(WARNING
      "The controller ${target} is built with ${found}: its commands will have other last bits on other machines${more}.")
  endif()
endfunction()
