// AbstractBodyLoader: interface of classes that read a body from a model file.
#pragma once

#include "Config.h"

#include <iosfwd>
#include <memory>
#include <string>

namespace cnoid {

class Body;

class CNOID_GENERAL_EXPORT AbstractBodyLoader {
 public:
  AbstractBodyLoader();
  virtual ~AbstractBodyLoader();

  /// Where errors, warnings and notes are written; std::cerr by default.
  virtual void setMessageSink(std::ostream& os);
  /// On: notes are written, too. Off by default.
  virtual void setVerbose(bool on);
  /// No effect: links of the API have no shapes.
  virtual void setShapeLoadingEnabled(bool on);
  virtual void setDefaultDivisionNumber(int n);
  virtual void setDefaultCreaseAngle(double theta);

  /// Replaces the body by the one in the file. False, with a message, if the file can't be read.
  virtual bool load(Body* body, const std::string& filename) = 0;
};

using AbstractBodyLoaderPtr = std::shared_ptr<AbstractBodyLoader>;

}  // namespace cnoid
