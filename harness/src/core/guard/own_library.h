#pragma once

#include <filesystem>

namespace rehearse {

/// The folder of the shared libraries of Rehearse; empty if it is unknown.
std::filesystem::path own_library_folder();

}  // namespace rehearse
