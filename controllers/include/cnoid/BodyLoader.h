// BodyLoader: reads a body from a model file, a copy of its own for a controller's calculations.
//
//   cnoid::BodyPtr model = cnoid::BodyLoader().load(cnoid::shareDir() + "/model/misc/box1.body");
//
// Rehearse loads the formats that its scenarios load. The recording contains the name and hash of the file, as of each
// file that a controller opens, so a replay on a machine without the file reports it as missing.
#pragma once

#include "AbstractBodyLoader.h"

#include <functional>
#include <initializer_list>

namespace cnoid {

class CNOID_GENERAL_EXPORT BodyLoader : public AbstractBodyLoader {
 public:
  /// For a program that hosts controllers: makes the loader of files whose names end with the extension ("body"). The
  /// last one registered counts. The factory's code must not be unloaded.
  static void registerLoader(const std::string& extension, std::function<AbstractBodyLoaderPtr()> factory);
  static void registerLoader(std::initializer_list<const char*> extensions,
                             std::function<AbstractBodyLoaderPtr()> factory);

  BodyLoader();
  ~BodyLoader() override;
  BodyLoader(const BodyLoader&) = delete;
  BodyLoader& operator=(const BodyLoader&) = delete;

  void setMessageSink(std::ostream& os) override;
  void setVerbose(bool on) override;

  bool load(Body* body, const std::string& filename) override;
  /// A new body, whose first owner is the caller; null, with a message, if the file can't be read.
  Body* load(const std::string& filename);
  /// The loader of the last file's format; null before the first.
  AbstractBodyLoaderPtr lastActualBodyLoader() const { return lastLoader_; }

 private:
  std::ostream* sink_;
  bool isVerbose_ = false;
  AbstractBodyLoaderPtr lastLoader_;
};

}  // namespace cnoid
