# The closed loop: the one library of the harness that simulates.
rehearse_add_library(simulation
  src/simulation/branch.cpp src/simulation/branch_source.cpp src/simulation/checkpoint_trial.cpp src/simulation/closed_loop.cpp src/simulation/noise_maker.cpp
  src/simulation/plant.cpp src/simulation/plant_run.cpp src/simulation/recorded_checkpoints.cpp src/simulation/recorded_commands.cpp
  src/simulation/session.cpp src/simulation/world_source.cpp)
target_link_libraries(rehearse_simulation
  PUBLIC Rehearse::harness
  PRIVATE Rehearse::world Rehearse::renderer Rehearse::cnoid fmt::fmt)
