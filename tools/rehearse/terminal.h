// A person at a terminal: single keys, and whether there is anybody to press them.
#pragma once

#include <string_view>

namespace rehearse::tool {

/// Keys are read from stdin and what is asked is on stdout: both are a terminal.
bool somebody_is_there();

/// Waits for one of these keys, without Enter; any other is passed over. '\0' if there will be none any more: the end
/// of the input, Ctrl-C, Ctrl-D. The terminal is as it was when this returns.
char read_key(std::string_view keys);

}  // namespace rehearse::tool
