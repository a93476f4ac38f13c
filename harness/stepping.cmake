# Looking at a recording tick by tick. Part of the harness library: it replays controllers, but simulates nothing.
target_sources(rehearse_harness PRIVATE
  src/stepping/contact_history.cpp
  src/stepping/expression.cpp
  src/stepping/expression_lexer.cpp
  src/stepping/expression_parser.cpp
  src/stepping/message_finder.cpp
  src/stepping/name_search.cpp
  src/stepping/recorded_ticks.cpp
  src/stepping/replayed_outputs.cpp
  src/stepping/stepped_trace.cpp
  src/stepping/tick_view.cpp)
