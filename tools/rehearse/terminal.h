// Input from a person at a terminal: single keys, and a test whether there is a terminal.
#pragma once

#include <string_view>

namespace rehearse::tool {

/// True if both stdin (keys) and stdout (questions) are terminals.
bool somebody_is_there();

/// Waits for one of these keys, without Enter; other keys are ignored. Returns '\0' at the end of the input, on Ctrl-C
/// and on Ctrl-D. The terminal's settings are restored before this returns.
char read_key(std::string_view keys);

}  // namespace rehearse::tool
