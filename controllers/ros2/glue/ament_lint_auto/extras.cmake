# Called by nearly every package; there is no linter to find.
macro(ament_lint_auto_find_test_dependencies)
endmacro()
