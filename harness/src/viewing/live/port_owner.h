// The program that listens on a port of this machine. Internal.
#pragma once

#include <cstdint>
#include <string>

namespace rehearse {

/// "python3 (process 4711)"; "another program" if the system doesn't tell, as for a program of another user.
std::string owner_of_port(std::uint16_t port);

}  // namespace rehearse
