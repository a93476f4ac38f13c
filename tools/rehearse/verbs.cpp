#include "verbs.h"

#include <algorithm>
#include <iterator>

#include "wings.h"

namespace rehearse::tool {
namespace {

constexpr std::string_view every_day = "Every day";
constexpr std::string_view campaigns_and_audits = "Campaigns and audits";
constexpr std::string_view files = "Recordings and logs as files";
constexpr std::string_view models = "Models and projects";

constexpr VerbSummary verbs[] = {
    {"new", every_day, "begin a repository of your own: a controller, its scenario, its tests", Program::read,
     Rounding::is_none},
    {"check", every_day, "run scenarios and compare them with their goldens", Program::simulate},
    {"golden", every_day, "list the goldens; review, accept or reject the runs that wait to be one; measure noise",
     Program::simulate},
    {"record", every_day, "run a scenario in closed loop and record the whole run", Program::simulate},
    {"replay", every_day, "feed a recording's inputs to its controllers, without physics, and compare commands",
     Program::read},
    {"step", every_day, "go through a recording tick by tick, backwards as well, and look at all of it", Program::read,
     Rounding::matters, "viewing"},
    {"report", every_day, "one HTML file of a run for a browser: robot, plots, pictures, and its golden beside it",
     Program::read, Rounding::is_none, "viewing"},
    {"serve", every_day,
     "play a recording to Foxglove or Lichtblick: robot, plots and pictures, to pause and to search", Program::read,
     Rounding::is_none, "viewing"},
    {"ui", every_day,
     "a page beside your editor: builds and checks what changes, shows reports, accepts runs",
     Program::read, Rounding::is_none, "viewing"},
    {"history", every_day, "how near to their bounds checks came, commit by commit: what drifts, jumps or is flaky",
     Program::read, Rounding::matters, "viewing"},
    {"doc", every_day, "show a page of the manual", Program::read, Rounding::is_none, "logs", true},
    {"sweep", campaigns_and_audits,
     "run many variations of a scenario, report which fail and why, and shrink a failing one", Program::of_the_wing,
     Rounding::matters, "campaigns"},
    {"fuzz", campaigns_and_audits, "search for inputs that break a controller: goes on with a fuzz test",
     Program::of_the_wing, Rounding::is_none, "fuzz"},
    {"fit", campaigns_and_audits, "fit numbers of a scenario to recordings of a robot, each with its interval",
     Program::of_the_wing, Rounding::matters, "fitting"},
    {"audit", campaigns_and_audits, "is a controller a function of its inputs, and if not, what else does it depend on",
     Program::of_the_wing, Rounding::matters, "audit"},
    {"info", files, "print duration, channels, metadata and events of a trace", Program::read, Rounding::is_none},
    {"cat", files, "print the messages of a trace, one a line", Program::read, Rounding::is_none},
    {"diff", files, "compare two traces and list their differences, the first one first", Program::read},
    {"export", files, "write a trace as tables (CSV), pictures or a video", Program::read, Rounding::is_none,
     "viewing"},
    {"filter", files, "write a part of a trace: topics, a span of time, of ticks", Program::read, Rounding::is_none},
    {"merge", files, "write several traces into one, in the order of time", Program::read, Rounding::is_none},
    {"recover", files, "save the readable messages of a trace that is cut or damaged", Program::read,
     Rounding::is_none},
    {"doctor", files, "find all that is wrong with trace files, each with its place", Program::read, Rounding::is_none,
     "logs", true},
    {"tap", files, "record what a robot's loop writes into its tap (<rehearse/tap.h>)", Program::of_the_wing,
     Rounding::is_none, "logs"},
    {"map", files, "write a first map from a robot's log to the inputs of a controller", Program::of_the_wing,
     Rounding::is_none, "logs"},
    {"inspect", models, "load a robot model and report its contents and findings", Program::read},
    {"actuators", models, "print the drives of a MuJoCo model as the actuators of a scenario", Program::read,
     Rounding::is_none},
    {"render", models, "draw a picture of a scenario or a model", Program::simulate},
    {"import", models, "write the scenario that a project of Choreonoid (.cnoid) runs", Program::of_the_wing,
     Rounding::is_none, "choreonoid"},
};

struct Wing {
  std::string_view name;
  bool is_built;
};
constexpr Wing wings[] = {{"", true},
                          {"logs", has_logs},
                          {"viewing", has_viewing},
                          {"campaigns", has_campaigns},
                          {"audit", has_audit},
                          {"choreonoid", has_choreonoid},
                          {"fuzz", has_fuzz},
                          {"fitting", has_fitting}};

}  // namespace

std::span<const VerbSummary> all_verbs() { return verbs; }

const VerbSummary* find_verb(std::string_view name) {
  const auto found = std::ranges::find_if(verbs, [&](const auto& verb) { return verb.name == name; });
  return found == std::end(verbs) ? nullptr : found;
}

bool is_in_this_build(std::string_view wing) {
  return std::ranges::any_of(wings, [&](const Wing& one) { return one.name == wing && one.is_built; });
}

}  // namespace rehearse::tool
