// ResultStream: stdout for the results of a program alone.
//
// A controller prints on stdout. A program whose stdout another program reads keeps it for its results: these go to a
// descriptor of their own, and everything else that is printed on stdout goes to stderr. Processes that are forked
// later inherit both.
#pragma once

#include <cstdio>

namespace rehearse {

/// From now on only result_stream() prints on stdout. It has no effect if stdout can't be written to, as when it is
/// closed, so that the program finds the error as it would without this call.
void keep_stdout_for_results();

/// Undoes it, for a program that replaces this one and inherits stdout.
void give_stdout_back();

/// Where a program prints its results: stdout, unless that is kept.
std::FILE* result_stream();

/// The descriptor of the kept stdout; -1: it isn't kept.
int result_descriptor();

}  // namespace rehearse
