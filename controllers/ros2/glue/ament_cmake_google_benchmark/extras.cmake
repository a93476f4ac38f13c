# Time does not pass while code runs, so a benchmark would measure nothing.
macro(ament_add_google_benchmark target)
  message(STATUS "benchmark left out: ${target}")
endmacro()
