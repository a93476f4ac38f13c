// rehearse golden: the accepted recordings, and how a run becomes one.
#include <fmt/format.h>
#include <rehearse/golden.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "command.h"
#include "options.h"
#include "output.h"

namespace rehearse::tool {
namespace {

struct Settings {
  std::string name;  // to be accepted
  bool json = false;
};

/// The goldens of the working directory, or of the nearest folder above it that has some.
Result<GoldenStore> open_store() {
  const auto folder = find_golden_folder("./");
  if (!folder) return folder.errors();
  return GoldenStore(*folder);
}

std::string state_of(const GoldenEntry& entry) {
  if (!entry.problem.empty()) return entry.problem;
  std::string state = entry.orphan() ? "no test or scenario names it" : "";
  if (entry.pending) state += std::string(state.empty() ? "" : "; ") + "a run waits to be accepted";
  return state.empty() ? "in use" : state;
}

Json json_of_entry(const GoldenEntry& entry) {
  return {{"name", entry.name},
          {"owners", entry.owners},
          {"bytes", entry.bytes},
          {"recorded_by", entry.recorded_by},
          {"pending", entry.pending},
          {"orphan", entry.orphan()},
          {"problem", entry.problem.empty() ? Json(nullptr) : Json(entry.problem)}};
}

void tell(const std::vector<GoldenEntry>& entries) {
  std::vector<TableRow> rows{{"golden", "size", "state", "named by"}};
  for (const GoldenEntry& entry : entries) {
    std::string owners;
    for (const std::string& owner : entry.owners) owners += (owners.empty() ? "" : ", ") + owner;
    rows.push_back({entry.name, file_size_text(entry.bytes), state_of(entry), owners.empty() ? "-" : owners});
  }
  print_table(rows);
}

Exit list(const Settings& settings) {
  const auto store = open_store();
  if (!store) return refuse(store.errors());
  const auto entries = list_goldens(*store, {store->folder() / ".."});
  if (!entries) return refuse(entries.errors());
  if (settings.json) {
    Json goldens = Json::array();
    for (const GoldenEntry& entry : *entries) goldens.push_back(json_of_entry(entry));
    print({{"folder", store->folder().string()}, {"goldens", goldens}});
  } else if (entries->empty()) {
    fmt::print("no goldens in {}\n", store->folder().string());
  } else {
    tell(*entries);
  }
  return Exit::done;
}

Exit accept(const Settings& settings) {
  const char* ci = std::getenv("CI");
  if (ci && std::string_view(ci) == "true")
    return refuse(error("goldens are only checked where CI is 'true'",
                        "accept them on a machine of yours, look at the digests, and commit them"));
  auto store = open_store();
  if (!store) return refuse(store.errors());
  const auto moved = store->accept_pending(settings.name);
  if (!moved) return refuse(moved.errors());
  fmt::print("accepted {}\n", store->trace_file(settings.name).string());
  if (*moved) {
    fmt::print("the run before it {}\n{}", verdict(**moved), table(**moved));
  } else {
    fmt::print("it is new\n");
  }
  fmt::print("look at {} and commit both files\n", store->digest_file(settings.name).string());
  return Exit::done;
}

std::function<Exit()> declare(CLI::App& options) {
  const auto settings = std::make_shared<Settings>();
  CLI::App* listing = options.add_subcommand("list", "all goldens, who names them, and whether they can be used");
  add_json_flag(*listing, settings->json);
  CLI::App* accepting = options.add_subcommand("accept", "make the run that waits the golden, and say what moved");
  accepting->add_option("NAME", settings->name, "Suite.Test")->required()->type_name("");
  options.require_subcommand(1);
  return [settings, listing] { return listing->parsed() ? list(*settings) : accept(*settings); };
}

}  // namespace

const Verb golden_verb{"golden",
                       "  rehearse golden list\n"
                       "  rehearse golden accept SR1.StandsUnderItsMinimumController\n",
                       declare};

}  // namespace rehearse::tool
