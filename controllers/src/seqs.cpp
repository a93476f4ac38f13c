// The kinds of sequences in a .seq file.

#include <cnoid/EigenUtil>
#include <cnoid/MultiSE3Seq>
#include <cnoid/MultiValueSeq>
#include <cnoid/Vector3Seq>

#include "seq_reader.h"

namespace cnoid {

// --- MultiValueSeq

MultiValueSeq::MultiValueSeq() : MultiSeq("MultiValueSeq") {}

MultiValueSeq::MultiValueSeq(int numFrames, int numParts) : MultiValueSeq() { setDimension(numFrames, numParts); }

MultiValueSeq::~MultiValueSeq() = default;

std::shared_ptr<AbstractSeq> MultiValueSeq::cloneSeq() const { return std::make_shared<MultiValueSeq>(*this); }

bool MultiValueSeq::doReadSeq(const Mapping* archive, std::ostream&) {
  const SeqHeader header = readSeqHeader(*archive, *this, {"MultiValueSeq"});
  const int n = readNumParts(*archive);
  const Listing& frames = checkedFrames(*archive, header, n);
  setDimension(0, n);
  fillFrames(frames, header, *this, [&](int index, const Listing& values, int first) {
    const Frame to = frame(index);
    for (int j = 0; j < n; ++j) to[j] = values[first + j].toDouble();
  });
  return true;
}

// --- MultiSE3Seq

namespace {

/// The order of the numbers of a pose in the file.
enum class PoseFormat { XYZQWQXQYQZ, XYZQXQYQZQW, XYZRPY };

PoseFormat readPoseFormat(const Mapping& archive, double formatVersion) {
  const ValueNode& node = archive[formatVersion < 2.0 ? "format" : "SE3Format"];
  const std::string& name = node.toString();
  if (name == "XYZQWQXQYQZ") return PoseFormat::XYZQWQXQYQZ;
  if (name == "XYZQXQYQZQW" && formatVersion < 2.0) return PoseFormat::XYZQXQYQZQW;
  if (name == "XYZRPY") return PoseFormat::XYZRPY;
  node.throwException("poses can't be written as \"" + name + "\" (they can as XYZQWQXQYQZ and XYZRPY)");
}

SE3 readPose(const ValueNode& node, PoseFormat format) {
  const Listing& values = *node.toListing();
  const int expected = format == PoseFormat::XYZRPY ? 6 : 7;
  if (values.size() != expected) {
    values.throwException("a pose of " + std::to_string(values.size()) + " numbers stands where poses have " +
                          std::to_string(expected));
  }
  const auto number = [&values](int i) { return values[i].toDouble(); };
  const Vector3 p(number(0), number(1), number(2));
  switch (format) {
    case PoseFormat::XYZRPY: return SE3(p, rotFromRpy(number(3), number(4), number(5)));
    case PoseFormat::XYZQXQYQZQW: return SE3(p, Quaternion(number(6), number(3), number(4), number(5)));
    case PoseFormat::XYZQWQXQYQZ: break;
  }
  return SE3(p, Quaternion(number(3), number(4), number(5), number(6)));
}

}  // namespace

MultiSE3Seq::MultiSE3Seq() : MultiSeq("MultiSE3Seq") {}

MultiSE3Seq::MultiSE3Seq(int numFrames, int numParts) : MultiSE3Seq() { setDimension(numFrames, numParts); }

MultiSE3Seq::~MultiSE3Seq() = default;

std::shared_ptr<AbstractSeq> MultiSE3Seq::cloneSeq() const { return std::make_shared<MultiSE3Seq>(*this); }

SE3 MultiSE3Seq::defaultValue() const { return SE3(Isometry3::Identity()); }

bool MultiSE3Seq::doReadSeq(const Mapping* archive, std::ostream&) {
  const bool isFirstVersion = archive->get({"format_version", "formatVersion"}, 1.0) < 2.0;
  const SeqHeader header = isFirstVersion
                               ? readSeqHeader(*archive, *this, {"MultiSE3Seq", "MultiSe3Seq", "MultiAffine3Seq"})
                               : readSeqHeader(*archive, *this, {"MultiSE3Seq"});
  const int n = readNumParts(*archive);
  const PoseFormat format = readPoseFormat(*archive, header.formatVersion);
  const Listing& frames = checkedFrames(*archive, header, n);
  setDimension(0, n);
  fillFrames(frames, header, *this, [&](int index, const Listing& values, int first) {
    const Frame to = frame(index);
    for (int j = 0; j < n; ++j) to[j] = readPose(values[first + j], format);
  });
  return true;
}

// --- Vector3Seq

Vector3Seq::Vector3Seq(int numFrames) : Seq("Vector3Seq") { setNumFrames(numFrames); }

Vector3Seq::~Vector3Seq() = default;

std::shared_ptr<AbstractSeq> Vector3Seq::cloneSeq() const { return std::make_shared<Vector3Seq>(*this); }

bool Vector3Seq::doReadSeq(const Mapping* archive, std::ostream&) {
  const SeqHeader header = readSeqHeader(*archive, *this, {"Vector3Seq"});
  const Listing& frames = checkedFrames(*archive, header, 3);
  fillFrames(frames, header, *this, [&](int index, const Listing& values, int first) {
    frame(index) = Vector3(values[first].toDouble(), values[first + 1].toDouble(), values[first + 2].toDouble());
  });
  return true;
}

}  // namespace cnoid
