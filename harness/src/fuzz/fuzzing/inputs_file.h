// The file of a finding, NAME.inputs: a text with a line for each change of an input. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <string>
#include <vector>

#include "fuzz_setup.h"
#include "inputs.h"

namespace rehearse {

/// The text: comments, the number of ticks, and the changes. `comments`: lines without their #.
std::string text_of_inputs(const FuzzSetup& setup, const Inputs& inputs, const std::vector<std::string>& comments);

/// Reads it; fails with the place of a mistake. `file`: for messages.
Result<Inputs> inputs_of_text(const FuzzSetup& setup, const std::string& text, const std::filesystem::path& file);

}  // namespace rehearse
