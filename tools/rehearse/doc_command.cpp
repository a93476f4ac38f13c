// rehearse doc: prints the manual that was installed with the command.
#include <fmt/format.h>
#include <rehearse/pin.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>

#include "command.h"
#include "progress.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

struct Topic {
  std::string_view name;
  std::string_view page;  // path in the folder of the manual
  std::string_view summary;
};

constexpr Topic topics[] = {
    {"start", "README.md", "the way from nothing to a first verdict"},
    {"command", "tools/README.md", "the verbs, expressions, JSON, gdb"},
    {"controllers", "controllers/README.md", "the API of controllers, member by member"},
    {"scenarios", "fixtures/README.md", "scenarios, models, tolerances, expectations, maps of logs"},
    {"verdicts", "harness/README.md", "how runs are recorded, replayed, compared and audited"},
    {"traces", "harness/TRACE_FORMAT.md", "the content of a trace file"},
    {"goldens", "golden/README.md", "goldens: review, acceptance, noise"},
    {"physics", "engine/README.md", "what is simulated, and how"},
};

/// The folder of the manual's pages, in the build folder or installed.
fs::path manual() { return (own_program().parent_path() / "../share/doc/rehearse").lexically_normal(); }

Exit list_topics() {
  for (const Topic& topic : topics) fmt::print("{:<13}{}\n", topic.name, topic.summary);
  fmt::print("\nThe pages: {}\n", manual().string());
  return Exit::done;
}

Exit show(const std::string& name) {
  const auto topic = std::find_if(std::begin(topics), std::end(topics), [&](const Topic& t) { return t.name == name; });
  if (topic == std::end(topics))
    return refuse(error(fmt::format("there is no topic '{}'", name), "rehearse doc lists the topics"));
  const fs::path page = manual() / topic->page;
  std::ifstream stream(page, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream || text.str().empty())
    return refuse(error(fmt::format("can't read {}", page.string()), "the manual is installed with the command"));
  if (is_terminal(stdout)) {
    const char* pager = std::getenv("PAGER");
    const std::string program = pager && *pager ? pager : "less";
    execlp(program.c_str(), program.c_str(), page.c_str(), nullptr);
  }
  fmt::print("{}", text.str());  // without a terminal or a pager
  return Exit::done;
}

std::function<Exit()> declare_doc(CLI::App& options) {
  const auto topic = std::make_shared<std::string>();
  options.add_option("TOPIC", *topic, "the page to show; without one, topics are listed")->type_name("");
  return [topic] { return topic->empty() ? list_topics() : show(*topic); };
}

}  // namespace

const Verb doc_verb{"doc", "  rehearse doc\n  rehearse doc scenarios\n", declare_doc};

}  // namespace rehearse::tool
