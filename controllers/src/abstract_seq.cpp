#include <cnoid/AbstractSeq>
#include <sstream>

namespace cnoid {

AbstractSeq::AbstractSeq(const char* seqType) : seqType_(seqType) {}

AbstractSeq::~AbstractSeq() = default;

AbstractMultiSeq::~AbstractMultiSeq() = default;

double AbstractSeq::getTimeStep() const { return getFrameRate() > 0.0 ? 1.0 / getFrameRate() : 0.0; }

void AbstractSeq::setTimeStep(double step) { setFrameRate(step > 0.0 ? 1.0 / step : 0.0); }

double AbstractSeq::getTimeOfFrame(int frame) const {
  return getFrameRate() > 0.0 ? frame / getFrameRate() + getOffsetTime() : getOffsetTime();
}

int AbstractSeq::getFrameOfTime(double time) const {
  return static_cast<int>((time - getOffsetTime()) * getFrameRate());
}

int AbstractSeq::getOffsetTimeFrame() const { return static_cast<int>(getOffsetTime() * getFrameRate()); }

void AbstractSeq::setOffsetTimeFrame(int frame) { setOffsetTime(getFrameRate() > 0.0 ? frame / getFrameRate() : 0.0); }

double AbstractSeq::getTimeLength() const { return getFrameRate() > 0.0 ? getNumFrames() / getFrameRate() : 0.0; }

bool AbstractSeq::readSeq(const Mapping* archive, std::ostream& os) { return readSeqOf("", archive, os); }

bool AbstractSeq::readSeqOf(const std::string& file, const Mapping* archive, std::ostream& os) {
  file_ = file;
  message_.clear();
  std::ostringstream messages;
  bool isRead = false;
  try {
    isRead = doReadSeq(archive, messages);
  } catch (const ValueNode::Exception& problem) {
    messages << placeOf(problem.line(), problem.column()) << "error: " << problem.text() << "\n";
  }
  message_ = messages.str();
  os << message_;
  return isRead;
}

bool AbstractSeq::doReadSeq(const Mapping* archive, std::ostream&) {
  archive->throwException("a sequence of type " + seqType_ + " can't be read");
}

bool AbstractSeq::readPart(AbstractSeq& part, const Mapping* archive, std::ostream& os) {
  return part.doReadSeq(archive, os);
}

std::string AbstractSeq::placeOf(int line, int column) const {
  std::string place = file_;
  if (line > 0) place += (file_.empty() ? "line " : ":") + std::to_string(line) + ":" + std::to_string(column);
  return place.empty() ? place : place + ": ";
}

bool AbstractSeq::refuse(const std::string& file, const ValueNode::Exception& problem, std::ostream& os) {
  file_ = file;
  message_ = placeOf(problem.line(), problem.column()) + "error: " + problem.text() + "\n";
  os << message_;
  return false;
}

}  // namespace cnoid
