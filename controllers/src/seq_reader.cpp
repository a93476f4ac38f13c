#include "seq_reader.h"

#include "numbers.h"

#include <algorithm>
#include <cmath>

namespace cnoid {

namespace {

// of a sequence whose frames have times: limits the memory that a wrong time can cost
constexpr double maxFrames = 1.0e6;

int frameOfTime(const ValueNode& node, const AbstractSeq& seq) {
  const double time = node.toDouble();
  const double frame = (time - seq.getOffsetTime()) * seq.getFrameRate();
  if (!(frame >= 0.0 && frame < maxFrames)) {
    node.throwException("a frame can't have the time " + printNumber(time) +
                        ": it is before the first frame, or more " + "than a million frames behind it");
  }
  return static_cast<int>(frame);
}

double readFrameRate(const Mapping& archive) {
  const double rate = archive.get<double>({"frameRate", "frame_rate"});
  if (!(rate > 0.0) || !std::isfinite(rate)) {
    archive.find({"frameRate", "frame_rate"})->throwException("a frame rate must be a number above 0");
  }
  return rate;
}

}  // namespace

SeqHeader readSeqHeader(const Mapping& archive, AbstractSeq& seq, std::initializer_list<const char*> types) {
  SeqHeader header;
  header.formatVersion = archive.get({"format_version", "formatVersion"}, 1.0);

  const ValueNode& type = archive["type"];
  if (std::find(types.begin(), types.end(), type.toString()) == types.end()) {
    type.throwException("a " + type.toString() + " stands where a " + *types.begin() + " is expected");
  }
  std::string content;
  if (archive.read("content", content) || (header.formatVersion < 2.0 && archive.read("purpose", content))) {
    seq.setSeqContentName(content);
  }
  const ValueNode* hasFrameTime = archive.find({"has_frame_time", "hasFrameTime"});
  if (hasFrameTime->isValid()) {
    if (header.formatVersion < 2.0) hasFrameTime->throwException("frames have no times in format version 1");
    header.hasFrameTime = hasFrameTime->toBool();
  }
  seq.setFrameRate(readFrameRate(archive));
  return header;
}

int readNumParts(const Mapping& archive) {
  const int numParts = archive.get<int>({"numParts", "num_parts"});
  if (numParts < 1) archive.find({"numParts", "num_parts"})->throwException("\"numParts\" must be 1 or more");
  return numParts;
}

const Listing& checkedFrames(const Mapping& archive, const SeqHeader& header, int frameSize) {
  const ValueNode* node = archive.find("frames");
  if (!node->isValid()) archive.throwException("the key \"frames\" is missing");
  const Listing& frames = *node->toListing();
  if (frames.empty()) frames.throwException("\"frames\" holds no frame");
  const int expected = frameSize + (header.hasFrameTime ? 1 : 0);
  for (const auto& frame : frames) {
    const int size = frame->toListing()->size();
    if (size == expected) continue;
    frame->throwException("a frame of " + std::to_string(size) + " elements stands where frames have " +
                          std::to_string(expected) + (header.hasFrameTime ? ", the first of them the time" : ""));
  }
  return frames;
}

void fillFrames(const Listing& frames, const SeqHeader& header, AbstractSeq& seq,
                const std::function<void(int frame, const Listing& values, int first)>& setFrame) {
  seq.setNumFrames(header.hasFrameTime ? 0 : frames.size());
  for (int i = 0; i < frames.size(); ++i) {
    const Listing& values = *frames[i].toListing();
    const int frame = header.hasFrameTime ? frameOfTime(values[0], seq) : i;
    if (frame >= seq.getNumFrames()) seq.setNumFrames(frame + 1, true);
    setFrame(frame, values, header.hasFrameTime ? 1 : 0);
  }
}

}  // namespace cnoid
