// The sub-verbs of `rehearse golden`: one file each, golden_NAME.cpp, declared together in golden_command.cpp.
#pragma once

#include <rehearse/golden.h>

#include <CLI/App.hpp>
#include <functional>
#include <string>
#include <vector>

#include "command.h"
#include "output.h"

namespace rehearse::tool {

/// Declares a sub-verb: adds its options to `options` and returns the function that runs it.
using DeclareGolden = std::function<Exit()>(CLI::App& options);

DeclareGolden declare_golden_list;
DeclareGolden declare_golden_review;
DeclareGolden declare_golden_accept;
DeclareGolden declare_golden_reject;
DeclareGolden declare_golden_prune;
DeclareGolden declare_golden_noise;

/// The goldens of the working directory, or of the nearest folder above it that has goldens.
Result<GoldenStore> open_store();

/// An error if CI is "true": there, goldens are only checked.
Result<void> check_may_decide();

/// An error unless either names or --all are given.
Result<void> check_choice(const std::vector<std::string>& names, bool all);

/// Prints the result of `accept` for one golden, for people: several lines.
void tell_accepted(const GoldenStore& store, const std::string& name, const Accepted& accepted);

}  // namespace rehearse::tool
