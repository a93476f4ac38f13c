// For any bytes, the URDF loader returns a model or errors, and never crashes or hangs.
#include <rehearse/urdf.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  const auto result = rehearse::parse_urdf(text, "fuzz.urdf", {.meshes = rehearse::UrdfOptions::Meshes::skip});
  // A model that passed has one root and every parent before its children: what the rest of the engine relies on.
  if (!result) return 0;
  for (std::size_t i = 0; i < result->links.size(); ++i) {
    const int parent = result->links[i].parent;
    if ((i == 0) != (parent < 0) || parent >= static_cast<int>(i)) std::abort();
  }
  return 0;
}
