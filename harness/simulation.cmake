# The closed loop: the one library of the harness that simulates.
rehearse_add_library(simulation 
  src/checkpoint_trial.cpp src/noise_maker.cpp src/plant.cpp src/plant_run.cpp src/recorded_commands.cpp src/session.cpp)
target_link_libraries(rehearse_simulation
  PUBLIC Rehearse::harness
  PRIVATE Rehearse::world Rehearse::renderer Rehearse::cnoid fmt::fmt)
