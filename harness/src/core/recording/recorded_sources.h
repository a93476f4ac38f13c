// The files and texts from which a run is made, as a recording contains them.
#pragma once

#include <rehearse/scenario.h>

#include <string>
#include <vector>

namespace rehearse {

/// A file or text from which a run is made, as a recording contains it.
struct SourceFile {
  std::string name;  // as the scenario states it: a recording doesn't contain folders of its machine
  std::string media_type;
  std::string text;
};

/// The scenario, its models with their load reports, and the digests of their meshes.
std::vector<SourceFile> sources_of(const Scenario& scenario);

}  // namespace rehearse
