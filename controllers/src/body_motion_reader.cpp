// Reading a BodyMotion from a .seq file.
//
// The names in a file changed with the format's versions:
//   version         1                                  2                   3                           4
//   type            BodyMotion                         CompositeSeq        CompositeSeq                CompositeSeq
//   joints          JointPosition                      JointDisplacement   MultiJointDisplacementSeq JointDisplacement
//   links           LinkPosition                       LinkPosition        MultiLinkPositionSeq        LinkPosition
//   ZMP             ZMP, RelativeZMP, RelativeZmp      ZMP                 ZMPSeq                      ZMP
//   named by        content or purpose                 content             content                     content
// A component inherits values that it does not state itself (frame rate, version) from the file's top level.

#include <cnoid/BodyMotion>
#include <cnoid/YAMLReader>
#include <cnoid/ZMPSeq>

#include "numbers.h"

namespace cnoid {

namespace {

double readVersion(const Mapping& archive) {
  const ValueNode* node = archive.find({"format_version", "formatVersion"});
  if (!node->isValid()) return 1.0;
  const double version = node->toDouble();
  if (!(version >= 1.0 && version < 5.0)) {
    node->throwException("motions of format version " + printNumber(version) + " can't be read (versions 1 to 4 can)");
  }
  return version;
}

bool isThird(double version) { return version >= 3.0 && version < 4.0; }

const char* jointContent(double version) {
  if (version < 2.0) return "JointPosition";
  return isThird(version) ? "MultiJointDisplacementSeq" : "JointDisplacement";
}

const char* linkContent(double version) { return isThird(version) ? "MultiLinkPositionSeq" : "LinkPosition"; }

bool isRelativeZmp(const std::string& content, double version) {
  return version < 2.0 && (content == "RelativeZMP" || content == "RelativeZmp");
}

bool isZmp(const std::string& content, double version) {
  return content == (isThird(version) ? "ZMPSeq" : "ZMP") || isRelativeZmp(content, version);
}

bool isPoseSeq(const std::string& type, double version) {
  return type == "MultiSE3Seq" || (version < 2.0 && (type == "MultiSe3Seq" || type == "MultiAffine3Seq"));
}

std::string contentOf(const Mapping& component, double version) {
  std::string content;
  if (!component.read("content", content) && version < 2.0) component.read("purpose", content);
  return content;
}

MappingPtr withInherited(const Mapping& component, const Mapping& top) {
  const MappingPtr merged = component.clone();
  const MappingPtr inherited = top.clone();
  inherited->remove("content");  // the content of the whole file doesn't apply to a part
  inherited->remove("purpose");
  inherited->remove("components");
  inherited->remove("frames");
  if (!component.contains("type")) component.throwException("the key \"type\" is missing");
  merged->insert(inherited);
  return merged;
}

}  // namespace

bool BodyMotion::load(const std::string& filename, std::ostream& os) {
  YAMLReader reader;
  clearExtraSeqs();
  setDimension(0, 1, 1);
  try {
    return readSeqOf(filename, reader.loadDocument(filename)->toMapping(), os);
  } catch (const ValueNode::Exception& problem) {
    return refuse(filename, problem, os);
  }
}

bool BodyMotion::doReadSeq(const Mapping* archive, std::ostream& os) {
  clearExtraSeqs();
  setDimension(0, 1, 1);
  try {
    const double version = readVersion(*archive);
    const ValueNode& type = (*archive)["type"];
    const std::string expected = version < 2.0 ? "BodyMotion" : seqType();
    if (type.toString() != expected) {
      type.throwException("a " + type.toString() + " stands where a " + expected + " is expected");
    }
    const Listing& components = *(*archive)["components"].toListing();
    for (const auto& component : components) {
      readComponent(*withInherited(*component->toMapping(), *archive), version, os);
    }
    const auto joints = extraSeq<MultiValueSeq>(jointDisplacementContentName());
    const auto links = extraSeq<MultiSE3Seq>(linkPositionContentName());
    if (!joints && !links) components.throwException("the motion holds neither joint displacements nor link positions");
    if (joints && links && joints->numFrames() != links->numFrames()) {
      components.throwException("the motion has " + std::to_string(joints->numFrames()) +
                                " frames of joint displacements and " + std::to_string(links->numFrames()) +
                                " of link positions");
    }
  } catch (const ValueNode::Exception&) {
    clearExtraSeqs();
    setDimension(0, 1, 1);
    throw;
  }
  updateBodyStateSeqWithLinkPosSeqAndJointPosSeq();
  clearExtraSeq(linkPositionContentName());
  clearExtraSeq(jointDisplacementContentName());
  return true;
}

void BodyMotion::readComponent(const Mapping& component, double version, std::ostream& os) {
  const std::string type = component["type"].toString();
  const std::string content = contentOf(component, version);
  std::shared_ptr<AbstractSeq> seq;
  std::string name = content;
  if (type == "MultiValueSeq") {
    seq = std::make_shared<MultiValueSeq>();
    if (content == jointContent(version)) name = jointDisplacementContentName();
  } else if (isPoseSeq(type, version)) {
    seq = std::make_shared<MultiSE3Seq>();
    if (content == linkContent(version)) name = linkPositionContentName();
  } else if (type == "Vector3Seq" && isZmp(content, version)) {
    const auto zmp = std::make_shared<ZMPSeq>();
    zmp->setRootRelative(isRelativeZmp(content, version));
    name = zmp->seqContentName();
    seq = zmp;
  } else if (type == "Vector3Seq") {
    seq = std::make_shared<Vector3Seq>();
  } else {
    const ValueNode& node = component["type"];
    os << placeOf(node.line(), node.column()) << "warning: a component of the unknown type " << type
       << " is passed over\n";
    return;
  }
  readPart(*seq, &component, os);
  seq->setSeqContentName(name);
  setExtraSeq(seq);
}

}  // namespace cnoid
