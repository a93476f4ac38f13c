// MessageView: in Choreonoid the view of messages of the graphical interface. Here its messages go to standard output,
// as those of MessageOut::master().
#pragma once

#include "MessageOut.h"

#include <ostream>
#include <string>

namespace cnoid {

class CNOID_GENERAL_EXPORT MessageView {
 public:
  enum MessageType {
    Normal,
    Highlight,
    Warning,
    Error,
    // old names
    NORMAL = Normal,
    HIGHLIGHT = Highlight,
    WARNING = Warning,
    ERROR = Error
  };

  static MessageView* instance();
  static MessageView* mainInstance() { return instance(); }

  void put(const std::string& message, int type = Normal);
  void putln(const std::string& message, int type = Normal) { put(message + "\n", type); }
  void putln() { put("\n"); }
  void notify(const std::string& message, int type = Normal) { putln(message, type); }
  void put(int type, const std::string& message) { put(message, type); }
  void putln(int type, const std::string& message) { putln(message, type); }
  void flush();
  std::ostream& cout(bool doFlush = true);

  /// True if an error was among the messages.
  bool hasErrorMessages() const;
};

CNOID_GENERAL_EXPORT std::ostream& mvout(bool doFlush = true);

}  // namespace cnoid
