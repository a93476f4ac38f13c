// make_walk: computes SR1's walking pattern and writes it as a motion file; see walking_pattern.h.
#include <rehearse/urdf.h>

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>

#include "walking_pattern.h"

namespace {

using rehearse::tool::WalkParameters;

void add_options(CLI::App& options, WalkParameters& parameters) {
  const auto add = [&](const char* name, auto& value, const char* text) {
    options.add_option(name, value, text)->capture_default_str();
  };
  add("--steps", parameters.steps, "number of steps; the last one brings the feet side by side");
  add("--step-length", parameters.step_length, "[m]");
  add("--step-time", parameters.step_time, "[s]");
  add("--double-support", parameters.double_support, "time of a step on both feet [s]");
  add("--lift", parameters.lift, "of the swinging foot [m]");
  add("--waist-height", parameters.waist_height, "above the floor [m]");
  add("--zmp-ahead", parameters.zmp_ahead, "the zero moment point's distance ahead of the ankle [m]");
  add("--zmp-inside", parameters.zmp_inside, "its distance from the ankle towards the other foot [m]");
  add("--pause", parameters.pause, "time standing at the beginning and the end [s]");
  add("--frame-rate", parameters.frame_rate, "[1/s]");
}

int run(int argc, char** argv) {
  CLI::App options("Computes a walking pattern for SR1, and writes it as a motion file (.seq).", "make_walk");
  std::string model_file, output;
  WalkParameters parameters;
  options.add_option("MODEL", model_file, "SR1's URDF")->required();
  options.add_option("-o,--output", output, "the motion file")->required();
  add_options(options, parameters);
  CLI11_PARSE(options, argc, argv);

  const auto fail = [](const rehearse::Diagnostics& errors) {
    fmt::print(stderr, "{}", to_string(errors));
    return 2;
  };
  const auto model = rehearse::load_urdf(model_file);
  if (!model) return fail(model.errors());
  const auto pattern = rehearse::tool::walking_pattern(*model, parameters);
  if (!pattern) return fail(pattern.errors());
  std::ofstream file(output);
  file << rehearse::tool::motion_text(*pattern, parameters);
  if (!file.flush()) return fail({rehearse::error_in(output, "can't be written")});
  fmt::print("{}: {} frames, {} s, {} m; the zero moment point is at most {:.4f} m from the wanted one\n", output,
             pattern->frames.size(), pattern->duration, pattern->distance, pattern->zmp_error);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& problem) {  // no memory
    std::fprintf(stderr, "error: %s\n", problem.what());
    return 2;
  }
}
