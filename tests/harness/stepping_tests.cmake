# Expressions, and formulas over time against an evaluator from their definitions.
rehearse_add_test(expression_test LABEL unit SHARDS 1
  SOURCES
    expression/expression_test.cpp
    expression/formula_random_test.cpp
    expression/formula_table_test.cpp
    expression/judgement_test.cpp
  LIBRARIES Rehearse::harness fmt::fmt)
target_include_directories(expression_test PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})

# Recordings tick by tick. The controllers are those of session_tests.
rehearse_add_test(stepping_tests LABEL sim SHARDS 1
  SOURCES
    stepping/stepped_trace_test.cpp
  LIBRARIES Rehearse::simulation Rehearse::viewing Rehearse::simulation)
target_include_directories(stepping_tests PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_definitions(stepping_tests PRIVATE TEST_CONTROLLERS="${CMAKE_BINARY_DIR}/tests/controllers")
add_dependencies(stepping_tests Behaviours HingePd HingePdChanged)
