// What differs between two campaigns besides their results.
#include <fmt/format.h>
#include <rehearse/campaign_report.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <utility>

namespace rehearse {
namespace {

using Texts = std::map<std::string, std::string>;

/// The text of each key of a scenario, without lines that are comments.
Texts texts_by_key(const std::string& scenario) {
  Texts texts;
  std::string key;
  std::istringstream lines(scenario);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string::npos || line[begin] == '#') continue;
    line.erase(line.find_last_not_of(" \t\r") + 1);
    const std::size_t colon = line.find(':');
    const bool is_key = begin == 0 && line[0] != '-' && colon != std::string::npos;
    if (is_key) key = line.substr(0, colon);
    texts[key] += is_key ? line.substr(std::min(line.find_first_not_of(' ', colon + 1), line.size())) : '\n' + line;
  }
  return texts;
}

Texts models_of(const Scenario& scenario) {
  Texts models;
  for (const ScenarioBody& body : scenario.bodies)
    if (!body.model_file.empty()) models[body.model_file] = body.model->source_text;
  return models;
}

Texts options_of(const CampaignOptions& options) {
  Texts texts{{"golden", options.golden.string()},
              {"case limit", fmt::format("{} s", options.case_limit)},
              {"call limit", fmt::format("{} s", options.host.call_limit)},
              {"memory limit", fmt::format("{} MB", options.host.memory_limit)}};
  for (const auto& [controller, library] : options.host.libraries) texts["library of " + controller] = library;
  return texts;
}

/// Calls `take` with each key whose texts differ, and with both; a text that is missing is empty.
template <class Take>
void for_each_change(const Texts& before, const Texts& now, Take take) {
  std::set<std::string> keys;
  for (const Texts* texts : {&before, &now})
    for (const auto& [key, text] : *texts) keys.insert(key);
  const auto text_of = [](const Texts& texts, const std::string& key) {
    const auto found = texts.find(key);
    return found == texts.end() ? std::string() : found->second;
  };
  for (const std::string& key : keys)
    if (text_of(before, key) != text_of(now, key)) take(key, text_of(before, key), text_of(now, key));
}

/// "duration: 3, was 2"; of texts with several lines the key.
std::string change_of(const std::string& key, const std::string& before, const std::string& now) {
  constexpr std::size_t longest = 60;
  const auto is_short = [](const std::string& text) {
    return text.size() <= longest && text.find('\n') == std::string::npos;
  };
  if (!is_short(before) || !is_short(now)) return key;
  return fmt::format("{}: {}, was {}", key, now.empty() ? "not stated" : now, before.empty() ? "not stated" : before);
}

void add_expectations(const Campaign& before, const Campaign& now, std::vector<std::string>& found) {
  const auto add_lone = [&](const Campaign& one, const Campaign& other, const char* what) {
    for (const std::string& text : one.expectations())
      if (std::ranges::find(other.expectations(), text) == other.expectations().end())
        found.push_back(fmt::format("{}: {}", what, text));
  };
  add_lone(now, before, "a new expectation");
  add_lone(before, now, "an expectation that is gone");
}

}  // namespace

std::vector<std::string> differences(const Campaign& before, const Campaign& now) {
  std::vector<std::string> found;
  for_each_change(before.libraries(), now.libraries(),
                  [&](const std::string& controller, const std::string& then, const std::string& library) {
                    const char* const what = then.empty() ? "a new controller" : "a controller that is gone";
                    found.push_back(fmt::format(
                        "{} {}", then.empty() || library.empty() ? what : "the library of the controller", controller));
                  });
  add_expectations(before, now, found);
  const bool has_other_expectations = before.expectations() != now.expectations();
  for_each_change(texts_by_key(before.scenario().text), texts_by_key(now.scenario().text),
                  [&](const std::string& key, const std::string& then, const std::string& text) {
                    if (key != "expect" || !has_other_expectations)
                      found.push_back("in the scenario " + change_of(key, then, text));
                  });
  for_each_change(
      models_of(before.scenario()), models_of(now.scenario()),
      [&](const std::string& model, const std::string&, const std::string&) { found.push_back("the model " + model); });
  for_each_change(options_of(before.options()), options_of(now.options()),
                  [&](const std::string& option, const std::string& then, const std::string& value) {
                    found.push_back(change_of(option, then, value));
                  });
  return found;
}

}  // namespace rehearse
