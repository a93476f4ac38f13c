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
run(${CMAKE_COMMAND} -E env --unset=CI REHEARSE_GOLDEN=new ${project}/build/swing_test)
run(${CMAKE_COMMAND} -E env CI=true --unset=REHEARSE_GOLDEN ${project}/build/swing_test)
run(${prefix}/bin/rehearse record ${project}/scenarios/swing.yaml -o ${project}/swing.mcap
    --controller Swing=${project}/build/lib/rehearse/controllers/Swing.so)
run(${prefix}/bin/rehearse replay ${project}/swing.mcap
    --controller Swing=${project}/build/lib/rehearse/controllers/Swing.so)

run(${prefix}/bin/rehearse new ${new_project})
run(${CMAKE_COMMAND} -S ${new_project} -B ${new_project}/build -G ${GENERATOR}
    -D CMAKE_PREFIX_PATH=${prefix} -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_BUILD_TYPE=${CONFIG})
run(${CMAKE_COMMAND} --build ${new_project}/build)
run(${CMAKE_COMMAND} -E env --unset=CI REHEARSE_GOLDEN=new ${CMAKE_CTEST_COMMAND} --test-dir ${new_project}/build
    --output-on-failure)
run(${CMAKE_COMMAND} -E env CI=true --unset=REHEARSE_GOLDEN ${CMAKE_CTEST_COMMAND} --test-dir ${new_project}/build
    --output-on-failure)
