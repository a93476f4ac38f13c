# Robots from other projects: cmake -DREHEARSE_URDF_CORPUS=DIR, where `rehearse inspect` reads every .urdf below DIR.
# They are not part of this repository, so without it the test is skipped.
set(REHEARSE_URDF_CORPUS "" CACHE PATH "A folder with URDF files, all of which are to be inspected")

set(corpus_test UrdfCorpus.IsInspectedWithoutACrash)
if(REHEARSE_URDF_CORPUS)
  add_test(NAME ${corpus_test}
    COMMAND ${CMAKE_COMMAND}
      -D COMMAND=$<TARGET_FILE:rehearse>
      -D CORPUS=${REHEARSE_URDF_CORPUS}
      -D OUTPUT=${CMAKE_CURRENT_BINARY_DIR}/corpus.csv
      -P ${CMAKE_CURRENT_SOURCE_DIR}/inspect_corpus.cmake)
else()
  add_test(NAME ${corpus_test} COMMAND ${CMAKE_COMMAND} -E echo
    "skipped: there is no folder of URDF files (cmake -DREHEARSE_URDF_CORPUS=DIR)")
  set_tests_properties(${corpus_test} PROPERTIES SKIP_REGULAR_EXPRESSION "^skipped:")
endif()
set_tests_properties(${corpus_test} PROPERTIES LABELS corpus TIMEOUT 3600)
