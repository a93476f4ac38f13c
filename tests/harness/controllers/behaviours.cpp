// The controller that creates the one named in its options.

#include "behaviours.h"

namespace behaviours {

std::map<std::string, Make>& registry() {
  static std::map<std::string, Make> all;
  return all;
}

namespace {

class Behaviours : public cnoid::SimpleController {
 public:
  bool configure(cnoid::SimpleControllerConfig* config) override {
    const Words words = config->options();
    const auto found = words.empty() ? registry().end() : registry().find(words[0]);
    if (found == registry().end()) {
      config->os() << "no behaviour '" << config->optionString() << "'\n";
      return false;
    }
    chosen_.reset(found->second(Words(words.begin() + 1, words.end())));
    return chosen_->configure(config);
  }
  bool initialize(cnoid::SimpleControllerIO* io) override { return chosen_->initialize(io); }
  bool start() override { return chosen_->start(); }
  bool control() override { return chosen_->control(); }
  void stop() override { chosen_->stop(); }
  void unconfigure() override { chosen_->unconfigure(); }

 private:
  std::unique_ptr<cnoid::SimpleController> chosen_;
};

}  // namespace
}  // namespace behaviours

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(behaviours::Behaviours)
