#include <cnoid/MessageOut>

#include <iostream>

namespace cnoid {

namespace {

bool beginsWith(const std::string& text, const std::string& start) { return text.compare(0, start.size(), start) == 0; }

}  // namespace

MessageOut::~MessageOut() = default;

MessageOut* MessageOut::master() {
  static const MessageOutPtr toStandardOutput = new MessageOut(std::cout);
  return toStandardOutput;
}

void MessageOut::put(const std::string& message, int type) {
  if (type == Error) hasErrors_ = true;
  if (type == Warning && !beginsWith(message, "Warning")) stream_ << "Warning: ";
  if (type == Error && !beginsWith(message, "Error")) stream_ << "Error: ";
  stream_ << message;
}

}  // namespace cnoid
