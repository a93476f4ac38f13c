// rehearse doc: opens the site that was installed with the command, or prints the pages that it is made of.
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
  std::string_view site;  // path in the folder of the site
  std::string_view summary;
};

constexpr Topic topics[] = {
    {"start", "README.md", "learn/index.html", "the way from nothing to a first verdict"},
    {"command", "tools/README.md", "reference/verbs.html", "the verbs, expressions, JSON, gdb"},
    {"controllers", "controllers/README.md", "reference/cnoid.html", "the API of controllers, member by member"},
    {"scenarios", "fixtures/README.md", "reference/scenario.html",
     "scenarios, models, tolerances, expectations, maps of logs"},
    {"verdicts", "harness/README.md", "concepts/index.html", "how runs are recorded, replayed, compared and audited"},
    {"traces", "harness/TRACE_FORMAT.md", "reference/trace_format.html", "the content of a trace file"},
    {"goldens", "golden/README.md", "concepts/goldens.html", "goldens: review, acceptance, noise"},
    {"physics", "engine/README.md", "concepts/physics.html", "the simulation: bodies, joints, contacts, sensors"},
};

/// The folder of the manual's pages, in the build folder or installed.
fs::path manual() { return (own_program().parent_path() / "../share/doc/rehearse").lexically_normal(); }

/// The site: installed beside the manual, or built by tools/docs in the build folder; empty if there is none.
fs::path site() {
  for (const fs::path& folder : {manual() / "site", (own_program().parent_path() / "../docs").lexically_normal()})
    if (std::error_code ignored; fs::exists(folder / "index.html", ignored)) return folder;
  return {};
}

/// Replaces this process by the desktop's browser, if there is a desktop. Returns if there is none.
void open_in_browser(const fs::path& page) {
  const auto is_set = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != '\0';
  };
  if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY")) return;
  fmt::print("file://{}\n", page.string());
  std::fflush(stdout);
  execlp("xdg-open", "xdg-open", page.c_str(), nullptr);
}

Exit list_topics() {
  for (const Topic& topic : topics) fmt::print("{:<13}{}\n", topic.name, topic.summary);
  fmt::print("\nThe pages: {}\n", manual().string());
  if (const fs::path pages = site(); !pages.empty())
    fmt::print("In a browser: file://{}\n", (pages / "index.html").string());
  return Exit::done;
}

Exit show(const std::string& name, bool as_text) {
  const auto topic = std::find_if(std::begin(topics), std::end(topics), [&](const Topic& t) { return t.name == name; });
  if (topic == std::end(topics))
    return refuse(error(fmt::format("there is no topic '{}'", name), "rehearse doc lists the topics"));
  if (const fs::path pages = site(); !as_text && is_terminal(stdout) && !pages.empty())
    open_in_browser(pages / topic->site);
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
  const auto as_text = std::make_shared<bool>(false);
  options.add_option("TOPIC", *topic, "the page to show; without one, topics are listed")->type_name("");
  options.add_flag("--text", *as_text, "as text, at the terminal, also if a browser can show the page");
  return [topic, as_text] { return topic->empty() ? list_topics() : show(*topic, *as_text); };
}

}  // namespace

const Verb doc_verb{"doc", "  rehearse doc\n  rehearse doc scenarios\n  rehearse doc scenarios --text\n", declare_doc};

}  // namespace rehearse::tool
