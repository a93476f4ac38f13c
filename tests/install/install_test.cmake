# Installs into a fresh folder, copies the consumer beside it, builds it, makes its golden, and checks it against that.
# The installed headers are those that the consumer's headers.txt lists, no more and no less.
# Then does the same with a project that `rehearse new` writes, with ctest, as its README describes.

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN}\nended in ${status}:\n${output}")
  endif()
endfunction()

set(prefix ${WORK}/prefix)
set(project ${WORK}/project)
set(new_project ${WORK}/my-arm)
file(REMOVE_RECURSE ${prefix} ${project} ${new_project})
run(${CMAKE_COMMAND} --install ${BUILD} --config ${CONFIG} --prefix ${prefix})
file(COPY ${SOURCE}/ DESTINATION ${project})
file(GLOB installed RELATIVE ${prefix}/include/rehearse ${prefix}/include/rehearse/*)
file(STRINGS ${SOURCE}/headers.txt promised)
list(TRANSFORM promised REPLACE " .*" "")
list(SORT installed)
list(SORT promised)
if(NOT installed STREQUAL promised)
  message(FATAL_ERROR "installed headers: ${installed}\npromised headers (headers.txt): ${promised}")
endif()
run(${CMAKE_COMMAND} -S ${project} -B ${project}/build -G ${GENERATOR}
    -D CMAKE_PREFIX_PATH=${prefix} -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_BUILD_TYPE=${CONFIG})
run(${CMAKE_COMMAND} --build ${project}/build)

# A program with a main() of its own. Linked plainly, and in the order of --as-needed, it loads the C library before
# librehearse_harness: it runs, and a single line says which guards are off. So does a program that loads the library.
function(expect_bench guards)
  execute_process(COMMAND ${ARGN} ${project}/build/lib/rehearse/controllers/Swing.so ${project}/models/pendulum.urdf
    RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE errors)
  string(REGEX MATCHALL "guards are off" told "${errors}")
  if(NOT status EQUAL 0 OR NOT output STREQUAL "u is -0.020 N·m\nu is -0.020 N·m\n" OR NOT told STREQUAL "${guards}")
    message(FATAL_ERROR "${ARGN}\nended in ${status}:\n${output}${errors}")
  endif()
endfunction()
set(libraries -I${prefix}/include -isystem ${EIGEN} -L${prefix}/${LIBRARIES} -Wl,-rpath,${prefix}/${LIBRARIES})
run(${COMPILER} -std=c++17 ${project}/own_main.cpp ${libraries} -Wl,--as-needed -lrehearse_testing
    -o ${WORK}/plain_main)
expect_bench("guards are off" ${WORK}/plain_main)
run(${COMPILER} -std=c++17 ${project}/own_main.cpp ${libraries} -Wl,--no-as-needed -lrehearse_testing
    -lrehearse_harness -o ${WORK}/guarded_main)
expect_bench("" ${WORK}/guarded_main)
expect_bench("" ${CMAKE_COMMAND} -E env LD_PRELOAD=${prefix}/${LIBRARIES}/librehearse_harness.so ${WORK}/plain_main)
run(${project}/build/own_main ${project}/build/lib/rehearse/controllers/Swing.so ${project}/models/pendulum.urdf)
find_program(python python3)
if(python)
  foreach(library harness testing)
    run(${python} -c "import ctypes, os
library = ctypes.CDLL('${prefix}/${LIBRARIES}/librehearse_${library}.so')
assert library.close(os.open('/dev/null', os.O_RDONLY)) == 0
raise SystemExit(os.waitstatus_to_exitcode(os.system('exit 0')))")
  endforeach()
endif()

# A loop with a tap leaves a ring that no recorder has read; the recorder saves it. The library in C needs no C++, and
# pkg-config finds it.
run(${project}/build/loop)
run(${prefix}/bin/rehearse tap consumer --recover -o ${WORK}/consumer.mcap)
run(${prefix}/bin/rehearse info ${WORK}/consumer.mcap)
execute_process(COMMAND ldd ${prefix}/${LIBRARIES}/librehearse_tap.so OUTPUT_VARIABLE needed COMMAND_ERROR_IS_FATAL ANY)
if(needed MATCHES "libstdc|libgcc|librehearse_[a-su-z]")
  message(FATAL_ERROR "librehearse_tap.so needs more than the C library:\n${needed}")
endif()
file(REAL_PATH ${prefix}/${LIBRARIES}/librehearse_tap.so tap)
file(SIZE ${tap} size)
if(size GREATER 100000)
  message(FATAL_ERROR "librehearse_tap.so has ${size} bytes: a robot's loop loads at most 100 kB")
endif()
find_program(pkg_config NAMES pkg-config pkgconf)
if(pkg_config)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${prefix}/${LIBRARIES}/pkgconfig
    ${pkg_config} --cflags --libs rehearse-tap
    OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  run(${COMPILER} -x c -std=c99 ${project}/loop.c -x none ${flags} -o ${WORK}/loop)
endif()

run(${CMAKE_COMMAND} -E env --unset=CI REHEARSE_GOLDEN=new ${project}/build/swing_test)
run(${CMAKE_COMMAND} -E env CI=true --unset=REHEARSE_GOLDEN ${project}/build/swing_test)
run(${prefix}/bin/rehearse record ${project}/scenarios/swing.yaml -o ${project}/swing.mcap
    --controller Swing=${project}/build/lib/rehearse/controllers/Swing.so)
run(${prefix}/bin/rehearse replay ${project}/swing.mcap
    --controller Swing=${project}/build/lib/rehearse/controllers/Swing.so)

# With COVERAGE each statement of a controller has a line, whatever the build type.
run(${CMAKE_COMMAND} -S ${project} -B ${project}/release -G ${GENERATOR}
    -D CMAKE_PREFIX_PATH=${prefix} -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${project}/release --target Swing CoveredSwing)
function(audit_coverage controller)
  execute_process(
    COMMAND ${prefix}/bin/rehearse audit ${project}/swing.mcap --coverage --lcov ${WORK}/swing.info
      --controller Swing=${project}/release/lib/rehearse/controllers/${controller}.so
    RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  set(status ${status} PARENT_SCOPE)
  set(output ${output} PARENT_SCOPE)
endfunction()
audit_coverage(Swing)
if(NOT status EQUAL 2 OR NOT output MATCHES "no lines in its debug information")
  message(FATAL_ERROR "the coverage of a Release without COVERAGE ended in ${status}:\n${output}")
endif()
audit_coverage(CoveredSwing)
file(READ ${WORK}/swing.info lines)
file(STRINGS ${project}/swing.cpp source)
set(line 0)
set(statements 0)
foreach(text IN LISTS source)
  math(EXPR line "${line} + 1")
  if(text MATCHES "^    [a-z]" AND NOT lines MATCHES "DA:${line},1\n")
    message(FATAL_ERROR "line ${line} of swing.cpp isn't executed with COVERAGE: ${output}\n${lines}")
  elseif(text MATCHES "^    [a-z]")
    math(EXPR statements "${statements} + 1")
  endif()
endforeach()
if(NOT status EQUAL 0 OR NOT statements EQUAL 8)
  message(FATAL_ERROR "the coverage with COVERAGE ended in ${status}, and has ${statements} statements:\n${output}")
endif()

# A new project goes from its golden to a passing test in each language.
set(languages c++ c)
find_program(cargo cargo)
if(cargo)
  list(APPEND languages rust)
else()
  message(STATUS "skipped: a new project in Rust; cargo isn't installed")
endif()
function(expect_note_on_old_build)
  file(APPEND ${new_project}/hold.cpp "// edited\n")
  execute_process(COMMAND ${CMAKE_COMMAND} -E env PWD=${new_project} ${CMAKE_CTEST_COMMAND} --test-dir build
    WORKING_DIRECTORY ${new_project} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE errors)
  if(NOT status EQUAL 0 OR NOT errors MATCHES "^note: hold.cpp is newer than Hold.so: .*cmake --build build\n$")
    message(FATAL_ERROR "a green ctest doesn't tell that its build is old: ${output}${errors}")
  endif()
endfunction()
foreach(language ${languages})
  file(REMOVE_RECURSE ${new_project})
  run(${prefix}/bin/rehearse new --language ${language} ${new_project})
  run(${CMAKE_COMMAND} -S ${new_project} -B ${new_project}/build -G ${GENERATOR}
      -D CMAKE_PREFIX_PATH=${prefix} -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_BUILD_TYPE=${CONFIG})
  run(${CMAKE_COMMAND} --build ${new_project}/build)
  run(${CMAKE_COMMAND} -E env --unset=CI REHEARSE_GOLDEN=new ${CMAKE_CTEST_COMMAND} --test-dir ${new_project}/build
      --output-on-failure)
  run(${CMAKE_COMMAND} -E env CI=true --unset=REHEARSE_GOLDEN ${CMAKE_CTEST_COMMAND} --test-dir ${new_project}/build
      --output-on-failure)
  if(language STREQUAL c++)
    expect_note_on_old_build()
  endif()
endforeach()

# `uninstall` removes what this installation has written, and nothing else.
file(WRITE ${prefix}/share/rehearse/mine.txt "of another program")
run(${CMAKE_COMMAND} -D BUILD=${BUILD} -P ${TOOLS}/cmake/uninstall.cmake)
file(GLOB_RECURSE left RELATIVE ${prefix} ${prefix}/*)
if(NOT left STREQUAL "share/rehearse/mine.txt" OR EXISTS ${prefix}/include/rehearse OR EXISTS ${BUILD}/install_manifest.txt)
  message(FATAL_ERROR "uninstall has left: ${left}")
endif()
