# cmake -D MODULE=RehearseControllers.cmake -D WORDS="..." -P: a call of rehearse_add_controller_test with these words.
include(${MODULE})
rehearse_add_controller_test(hold_test SOURCES hold_test.cpp ${WORDS})
