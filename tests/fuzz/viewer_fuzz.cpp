// Any bytes of a viewer, as a text or as a binary message: a request is read whose parts are within their bounds, or
// one diagnostic gives the reason, which can be sent back.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "viewing/live/viewer_protocol.h"

using namespace rehearse;

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

void examine(const Result<viewer_protocol::Request>& request) {
  if (!request) {
    require(request.errors().size() == 1 && !request.errors().front().message.empty());
    const auto level = viewer_protocol::Level::error;
    require(nlohmann::json::accept(viewer_protocol::status(level, request.errors().front().message)));
    return;
  }
  if (const auto* playback = std::get_if<viewer_protocol::Playback>(&*request)) {
    require(std::isfinite(playback->speed) && playback->speed > 0.0F);
    const auto status = viewer_protocol::PlaybackStatus::playing;
    require(viewer_protocol::playback_state(status, 0, playback->speed, playback->id).size() ==
            18 + playback->id.size());
  }
  if (const auto* get = std::get_if<viewer_protocol::GetParameters>(&*request))
    require(nlohmann::json::accept(viewer_protocol::parameter_values({{"a", 1}}, get->names, get->id)));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  examine(viewer_protocol::parse(std::string_view(reinterpret_cast<const char*>(data), size)));
  examine(viewer_protocol::parse(std::as_bytes(std::span(data, size))));
  return 0;
}
