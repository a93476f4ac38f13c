// MessageOut: messages to people, each of a kind: normal, highlighted, a warning, an error.
//
// All messages go to one stream. A warning begins with "Warning: " and an error with "Error: "; a message that already
// begins so gets no second prefix.
#pragma once

#include "Config.h"
#include "Referenced.h"

#include <ostream>
#include <string>

namespace cnoid {

class CNOID_GENERAL_EXPORT MessageOut : public Referenced {
 public:
  enum MessageType { Normal, Highlighted, Warning, Error };

  /// Writes to `stream`, which must outlive this object.
  explicit MessageOut(std::ostream& stream) : stream_(stream) {}
  ~MessageOut() override;

  /// A MessageOut that writes to standard output.
  static MessageOut* master();

  void put(const std::string& message, int type = Normal);
  void putln(const std::string& message, int type = Normal) { put(message + "\n", type); }
  /// Does the same as putln: there is no screen for an alert.
  void notify(const std::string& message, int type = Normal) { putln(message, type); }

  void putHighlighted(const std::string& message) { put(message, Highlighted); }
  void putHighlightedln(const std::string& message) { putln(message, Highlighted); }
  void notifyHighlighted(const std::string& message) { notify(message, Highlighted); }
  void putWarning(const std::string& message) { put(message, Warning); }
  void putWarningln(const std::string& message) { putln(message, Warning); }
  void notifyWarning(const std::string& message) { notify(message, Warning); }
  void putError(const std::string& message) { put(message, Error); }
  void putErrorln(const std::string& message) { putln(message, Error); }
  void notifyError(const std::string& message) { notify(message, Error); }

  std::ostream& cout() { return stream_; }
  std::ostream& cerr() { return stream_; }
  void flush() { stream_.flush(); }

  /// True if an error was among the messages.
  bool hasErrors() const { return hasErrors_; }

 private:
  std::ostream& stream_;
  bool hasErrors_ = false;
};

using MessageOutPtr = ref_ptr<MessageOut>;

}  // namespace cnoid
