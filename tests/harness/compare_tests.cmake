rehearse_add_test(judging_test LABEL unit
  SOURCES compare_test.cpp picture_difference_test.cpp golden_test.cpp tolerance_test.cpp
  LIBRARIES Rehearse::harness Rehearse::png)
