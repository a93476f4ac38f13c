// Models of robots, read by Debian's urdfdom.
#pragma once

#include <urdf_model/model.h>
#include <urdf_model/types.h>
#include <urdf_parser/urdf_parser.h>

#include <memory>
#include <string>

namespace urdf {

class Model : public ModelInterface {
 public:
  /// False: it can't be read.
  bool initString(const std::string& xml) { return take(parseURDF(xml)); }
  bool initFile(const std::string& file) { return take(parseURDFFile(file)); }

 private:
  bool take(const ModelInterfaceSharedPtr& read) {
    if (read) static_cast<ModelInterface&>(*this) = *read;
    return read != nullptr;
  }
};

using ModelSharedPtr = std::shared_ptr<Model>;
using ModelConstSharedPtr = std::shared_ptr<const Model>;
using ModelUniquePtr = std::unique_ptr<Model>;

}  // namespace urdf
