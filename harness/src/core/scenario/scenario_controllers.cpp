#include "bound_form.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <utility>

namespace rehearse {
namespace {

constexpr Range any_thread_delay{0.0, 1e6, "[s]"};
const Words<bool> kinds_of_turns{"turns, free, or a delay for each name of a thread",
                                 {{"turns", false}, {"free", true}}};

const BoundForm<ScenarioController>& bound_controller_form() {
  static const BoundForm<ScenarioController> form{
      "controller",
      "a controller",
      {FormKey{"name", types::name(),
               "names its channels, unique in its body, children included; default: the name of its library, or of its "
               "class"},
       FormKey{"library", types::some_text(),
               "a name such as SR1MinimumController, a path, FILE.py:CLASS, or FILE.so:CLASS of a component", required},
       {"options", &ScenarioController::options, "its option string"},
       {"delay", &ScenarioController::delay, "its outputs act one tick later"},
       {"optional", &ScenarioController::optional, "the run goes on without it if it refuses to take part, see below"},
       FormKey{"threads",
               types::either(
                   {types::word(kinds_of_turns.names()), types::map(types::quantity(time_units, any_thread_delay))}),
               "its own threads run in turns, or free, as the kernel lets them; or in turns with delays: NAME: TIME is "
               "how much later the thread of that name goes on when it was woken",
               "turns"},
       FormKey{"children", types::list(types::of(controller_form)),
               "controllers that share its body and are called after it; a child's own children are started and "
               "stopped, but never called, as in Choreonoid"}}};
  return form;
}

// Reads the controllers of one body. Children and their parent need different names, because they share its body's
// channels.
class ControllerReader {
 public:
  ControllerReader(Findings& findings, const ScenarioBody& body, const std::string& file)
      : findings_(findings), body_(body), file_(file) {}

  std::vector<ScenarioController> read_list(const YamlNode& node, std::string_view label) {
    std::vector<ScenarioController> controllers;
    const char* const what = "a list of controllers, each with its library";
    for (const YamlNodePtr& item : rehearse::read_list(findings_, node, label, what))
      controllers.push_back(read(*item));
    return controllers;
  }

 private:
  ScenarioController read(const YamlNode& node) {
    const Keys keys(findings_, node, controller_form());
    ScenarioController controller;
    controller.place = {file_, node.line, node.column};
    if (!keys.is_map()) return controller;
    const YamlNode* library = keys.require("library", "a name such as SR1MinimumController, or a path");
    if (library != nullptr) {
      controller.library = read_text(findings_, *library, "library", "a name or a path").value_or("");
      controller.place = {file_, library->line, library->column};
      if (library->kind == YamlNode::Kind::scalar && library->text.empty())
        expected(findings_, *library, "library", "a name or a path");
    }
    read_name(keys, library, controller);
    bound_controller_form().read(keys, controller);
    read_threads(keys, controller.threads);
    if (const YamlNode* children = keys.find("children"))
      for (ScenarioController& child : read_list(*children, "children")) add_child(std::move(child), controller);
    return controller;
  }

  void read_threads(const Keys& keys, ThreadRules& threads) {
    const YamlNode* const node = keys.find("threads");
    if (node == nullptr) return keys.set_default("threads", {kinds_of_turns.name_of(threads.are_free)});
    if (node->kind == YamlNode::Kind::map) {
      for (const NamedEntry& entry : read_entries(findings_, *node))
        if (const auto delay = read_seconds(findings_, *entry.value, entry.name, any_thread_delay))
          threads.delays[entry.name] = *delay;
      return;
    }
    for (const auto& [word, are_free] : kinds_of_turns.all)
      if (node->kind == YamlNode::Kind::scalar && node->text == word) {
        threads.are_free = are_free;
        return;
      }
    expected(findings_, *node, "threads", kinds_of_turns.what);
  }

  static void add_child(ScenarioController child, ScenarioController& parent) {
    std::vector<ScenarioController> below = std::exchange(child.children, {});
    parent.children.push_back(std::move(child));
    for (ScenarioController& grandchild : below) {
      grandchild.is_called = false;
      parent.children.push_back(std::move(grandchild));
    }
  }

  void read_name(const Keys& keys, const YamlNode* library, ScenarioController& controller) {
    const YamlNode* node = keys.find("name");
    if (node != nullptr) {
      controller.name = rehearse::read_name(findings_, *node, "name").value_or("");
    } else {
      controller.name = name_of_library(controller.library);
      node = library;
    }
    if (controller.name.empty()) return;  // reported already
    const auto [first, is_new] = first_line_.emplace(controller.name, node->line);
    if (!is_new)
      findings_.error(*node, fmt::format("a second controller of {} is named '{}'", body_.name, controller.name),
                      fmt::format("the first is in line {}; expected a name of its own", first->second));
  }

  Findings& findings_;
  const ScenarioBody& body_;
  const std::string& file_;
  std::map<std::string, int> first_line_;
};

}  // namespace

const Form& controller_form() { return bound_controller_form(); }

std::string name_of_library(const std::string& library) {
  const std::size_t colon = library.rfind(':');
  return std::filesystem::path(colon == std::string::npos ? library : library.substr(colon + 1)).stem().string();
}

void read_controllers(Findings& findings, const YamlNode& node, ScenarioBody& body, const std::string& file) {
  body.controllers = ControllerReader(findings, body, file).read_list(node, "controllers");
}

}  // namespace rehearse
