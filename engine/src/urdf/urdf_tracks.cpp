#include "urdf_draft.h"
#include "urdf_values.h"

#include <tinyxml2.h>

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

/// <pseudo_continuous_track/>, or with a flag in it.
bool is_on(const XMLElement& element, Findings& findings) {
  return text_of(element).empty() || read_text_flag(element, findings).value_or(false);
}

}  // namespace

std::vector<TrackDraft> read_tracks(const XMLElement& robot, Findings& findings) {
  std::vector<TrackDraft> tracks;
  for (const auto* block = robot.FirstChildElement("gazebo"); block != nullptr;
       block = block->NextSiblingElement("gazebo")) {
    const XMLElement* track = block->FirstChildElement("pseudo_continuous_track");
    if (track == nullptr || !is_on(*track, findings)) continue;
    if (const char* reference = block->Attribute("reference"))
      tracks.push_back({reference, track->GetLineNum()});
    else
      findings.error(track->GetLineNum(), "a track names no joint",
                     "its <gazebo> names the joint: <gazebo reference=\"JOINT\">");
  }
  return tracks;
}

}  // namespace rehearse::urdf
