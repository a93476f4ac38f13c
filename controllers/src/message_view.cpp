#include <cnoid/MessageView>

namespace cnoid {

MessageView* MessageView::instance() {
  static MessageView view;
  return &view;
}

void MessageView::put(const std::string& message, int type) { MessageOut::master()->put(message, type); }

void MessageView::flush() { MessageOut::master()->flush(); }

std::ostream& MessageView::cout(bool doFlush) {
  if (doFlush) flush();
  return MessageOut::master()->cout();
}

bool MessageView::hasErrorMessages() const { return MessageOut::master()->hasErrors(); }

std::ostream& mvout(bool doFlush) { return MessageView::instance()->cout(doFlush); }

}  // namespace cnoid
