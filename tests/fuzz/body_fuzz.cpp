// For any bytes, the loader of .body files, and of OpenHRP's in VRML, returns a model or errors, and never crashes or
// hangs.
#include <rehearse/body.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  const std::string name = text.starts_with("#VRML") ? "/nowhere/fuzz.wrl" : "/nowhere/fuzz.body";
  const auto result = rehearse::parse_body(text, name, {.meshes = rehearse::UrdfOptions::Meshes::skip});
  if (!result) return 0;
  // What the rest of the engine relies on: one root, every parent before its children, dense ids of joints.
  for (std::size_t i = 0; i < result->links.size(); ++i) {
    const int parent = result->links[i].parent;
    if ((i == 0) != (parent < 0) || parent >= static_cast<int>(i)) std::abort();
  }
  for (std::size_t id = 0; id < result->joints.size(); ++id)
    if (result->links.at(static_cast<std::size_t>(result->joints[id])).joint.id != static_cast<int>(id)) std::abort();
  return 0;
}
