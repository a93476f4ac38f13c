# Choreonoid's sample controllers, unmodified, compiled with Rehearse's headers: cmake -DREHEARSE_CHOREONOID_SOURCE=DIR,
# where DIR is a checkout of Choreonoid. Its sources are not part of this repository, so without it the test is skipped.
set(REHEARSE_CHOREONOID_SOURCE "" CACHE PATH "A checkout of Choreonoid, whose sample controllers are to be compiled")

set(REHEARSE_OUTSIDE_PROJECTS "" CACHE PATH "A folder of checkouts, OWNER+NAME each, whose projects are to be imported")

# Adds the test that compiles the controllers in the checkouts below SOURCE, of which LEAST must compile.
function(add_compile_test name source checkouts least output)
  set(test CnoidCompatibility.${name})
  if(source AND REHEARSE_GXX)
    add_test(NAME ${test}
      COMMAND ${CMAKE_COMMAND}
        -D SOURCE=${source}
        -D CHECKOUTS=${checkouts}
        -D LEAST=${least}
        -D OUTPUT=${CMAKE_CURRENT_BINARY_DIR}/${output}
        -D "COMPILER=${launcher};${REHEARSE_GXX}"
        -D "FLAGS=${user_flags}"
        -P ${CMAKE_CURRENT_SOURCE_DIR}/compile_controllers.cmake)
  else()
    add_test(NAME ${test} COMMAND ${CMAKE_COMMAND} -E echo "skipped: there is no checkout of the controllers, or no g++")
    set_tests_properties(${test} PROPERTIES SKIP_REGULAR_EXPRESSION "^skipped:")
  endif()
  set_tests_properties(${test} PROPERTIES LABELS compat TIMEOUT 1800)
endfunction()

# All 34 of Choreonoid's compile; FireController and HoseNozzleController by headers whose particles and sliders do nothing.
add_compile_test(ChoreonoidsOwnControllersCompileUnmodified "${REHEARSE_CHOREONOID_SOURCE}" "" 34 compat)
# Those of others that need no library which Rehearse does not offer.
add_compile_test(ControllersOfOthersCompileUnmodified "${REHEARSE_OUTSIDE_PROJECTS}" "*+*" 94 outside)

# The commit that the pages are about, and what a checkout has changed since; its public names that are missing here.
set(choreonoid_commit 25994f3eda49a83e700db62f3501613c5acfc0b7)
set(reference ${PROJECT_SOURCE_DIR}/tools/site/pages/reference)
find_package(Python3 COMPONENTS Interpreter)
# rehearse_page_test(NAME LABEL NEEDS arguments of python...): skipped if NEEDS is empty or there is no python.
function(rehearse_page_test name label needs)
  if(Python3_FOUND AND needs)
    add_test(NAME ${name} COMMAND ${Python3_EXECUTABLE} ${ARGN})
  else()
    add_test(NAME ${name} COMMAND ${CMAKE_COMMAND} -E echo "skipped: there is no checkout of Choreonoid, or no python3")
    set_tests_properties(${name} PROPERTIES SKIP_REGULAR_EXPRESSION "^skipped:")
  endif()
  set_tests_properties(${name} PROPERTIES LABELS ${label} TIMEOUT 60)
endfunction()
set(here ${CMAKE_CURRENT_SOURCE_DIR})
rehearse_page_test(CnoidCompatibility.ThePagesStateTheCommit compat "${REHEARSE_CHOREONOID_SOURCE}"
  ${here}/choreonoid_commit.py ${REHEARSE_CHOREONOID_SOURCE} ${choreonoid_commit} ${reference}/cnoid_differences.md)
rehearse_page_test(CnoidCompatibility.EachMissingNameHasItsReason compat "${REHEARSE_CHOREONOID_SOURCE}"
  ${here}/public_names.py ${REHEARSE_CHOREONOID_SOURCE} ${PROJECT_SOURCE_DIR}/controllers/include/cnoid
  ${here}/missing_names.txt ${reference}/cnoid_names.md)
rehearse_page_test(CnoidPages.EachMemberThatWorksIsCalledByATest unit ON
  ${here}/api_page.py ${PROJECT_SOURCE_DIR}/tests ${reference}/cnoid.md ${reference}/cnoid_devices.md
  ${reference}/cnoid_motions.md)

# Its sample projects, imported and run.
string(JOIN " " project_compiler ${launcher} "${REHEARSE_GXX}" ${user_flags} -O1 -w -fPIC -shared -ffp-contract=off)
rehearse_add_test(projects_checkout_test LABEL compat TIMEOUT 900 SOURCES projects_checkout_test.cpp
                  LIBRARIES Rehearse::simulation Rehearse::choreonoid)
target_compile_definitions(projects_checkout_test PRIVATE CHOREONOID_SOURCE="${REHEARSE_CHOREONOID_SOURCE}"
  COMPILE="${project_compiler}" OUTPUT="${CMAKE_CURRENT_BINARY_DIR}/projects")

# A public controller of a humanoid: cmake -DREHEARSE_VNOID_SOURCE=DIR, a checkout of vnoid.
set(REHEARSE_VNOID_SOURCE "" CACHE PATH "A checkout of vnoid, whose sample robot is to walk")
rehearse_add_test(vnoid_checkout_test LABEL compat TIMEOUT 600 SOURCES vnoid_checkout_test.cpp
                  LIBRARIES Rehearse::simulation Rehearse::choreonoid)
target_compile_definitions(vnoid_checkout_test PRIVATE VNOID_SOURCE="${REHEARSE_VNOID_SOURCE}"
  COMPILE="${project_compiler}" OUTPUT="${CMAKE_CURRENT_BINARY_DIR}/vnoid")

# Projects and bodies of others: cmake -DREHEARSE_OUTSIDE_PROJECTS=DIR, a folder of checkouts.
rehearse_add_test(outside_checkout_test LABEL compat TIMEOUT 900 SOURCES outside_checkout_test.cpp
                  LIBRARIES Rehearse::harness Rehearse::choreonoid)
target_compile_definitions(outside_checkout_test PRIVATE OUTSIDE_PROJECTS="${REHEARSE_OUTSIDE_PROJECTS}"
  CHOREONOID_SOURCE="${REHEARSE_CHOREONOID_SOURCE}")
