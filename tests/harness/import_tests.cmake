rehearse_add_test(import_tests LABEL unit SHARDS 1
  SOURCES import_test.cpp import_broken_test.cpp import_items_test.cpp import_outside_test.cpp
  LIBRARIES Rehearse::choreonoid)
