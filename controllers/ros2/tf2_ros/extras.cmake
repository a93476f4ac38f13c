# The buffer is that of tf2, a package of the user's workspace.
find_package(tf2 QUIET)
