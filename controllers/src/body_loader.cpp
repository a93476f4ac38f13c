#include <cnoid/Body>
#include <cnoid/BodyLoader>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <utility>

namespace cnoid {

namespace {

using Factory = std::function<AbstractBodyLoaderPtr()>;

/// By extension. Never destroyed, because a host may still load while it exits.
std::map<std::string, Factory>& factories() {
  static auto* all = new std::map<std::string, Factory>;
  return *all;
}

std::string inLowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

std::string extensionOf(const std::string& filename) {
  const std::string extension = std::filesystem::path(filename).extension().string();
  return inLowerCase(extension.empty() ? extension : extension.substr(1));
}

}  // namespace

AbstractBodyLoader::AbstractBodyLoader() = default;
AbstractBodyLoader::~AbstractBodyLoader() = default;
void AbstractBodyLoader::setMessageSink(std::ostream&) {}
void AbstractBodyLoader::setVerbose(bool) {}
void AbstractBodyLoader::setShapeLoadingEnabled(bool) {}
void AbstractBodyLoader::setDefaultDivisionNumber(int) {}
void AbstractBodyLoader::setDefaultCreaseAngle(double) {}

void BodyLoader::registerLoader(const std::string& extension, std::function<AbstractBodyLoaderPtr()> factory) {
  factories()[inLowerCase(extension)] = std::move(factory);
}

void BodyLoader::registerLoader(std::initializer_list<const char*> extensions,
                                std::function<AbstractBodyLoaderPtr()> factory) {
  for (const char* extension : extensions) registerLoader(extension, factory);
}

BodyLoader::BodyLoader() : sink_(&std::cerr) {}
BodyLoader::~BodyLoader() = default;
void BodyLoader::setMessageSink(std::ostream& os) { sink_ = &os; }
void BodyLoader::setVerbose(bool on) { isVerbose_ = on; }

bool BodyLoader::load(Body* body, const std::string& filename) {
  const auto factory = factories().find(extensionOf(filename));
  if (factory == factories().end()) {
    *sink_ << filename << ": error: no loader is registered for this file name extension";
    if (factories().empty()) *sink_ << ": this program isn't Rehearse";
    *sink_ << '\n';
    return false;
  }
  lastLoader_ = factory->second();
  lastLoader_->setMessageSink(*sink_);
  lastLoader_->setVerbose(isVerbose_);
  return lastLoader_->load(body, filename);
}

Body* BodyLoader::load(const std::string& filename) {
  BodyPtr body = new Body;
  return load(body, filename) ? body.retn() : nullptr;
}

}  // namespace cnoid
