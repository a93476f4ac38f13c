// For any bytes, the reader of MuJoCo's models returns a model or errors, and never crashes or hangs.
#include <rehearse/mjcf.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  const auto result = rehearse::parse_mjcf(text, "fuzz.xml",
                                           {.allow_unsupported = true, .meshes = rehearse::UrdfOptions::Meshes::skip});
  if (!result) return 0;
  // what the rest of the engine relies on
  for (std::size_t i = 0; i < result->links.size(); ++i) {
    const int parent = result->links[i].parent;
    if ((i == 0) != (parent < 0) || parent >= static_cast<int>(i)) std::abort();
  }
  for (const rehearse::Posture& posture : result->postures)
    if (posture.q.size() != result->joints.size()) std::abort();
  return 0;
}
