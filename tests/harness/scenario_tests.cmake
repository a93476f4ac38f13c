rehearse_add_test(scenario_tests LABEL unit SHARDS 1
  SOURCES form_test.cpp scenario_test.cpp scenario_actuators_test.cpp scenario_sensors_test.cpp scenario_values_test.cpp scenario_bodies_test.cpp scenario_broken_test.cpp
          scenario_expectations_test.cpp scenario_hostile_test.cpp scenario_joystick_test.cpp scenario_keys_test.cpp scenario_noise_test.cpp
          scenario_variations_test.cpp
  LIBRARIES Rehearse::harness nlohmann_json::nlohmann_json)
