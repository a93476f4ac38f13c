#include "seeds.h"

#include <fmt/format.h>
#include <rehearse/gtest.h>
#include <rehearse/trace.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "base/glob.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr int most_pieces = 4;  // of a golden

/// The samples of an input in a recording; empty: it has none.
std::vector<double> samples_of(const Trace& trace, const std::string& input) {
  for (const auto& [name, place] : trace.series()) {
    if (!name.ends_with("/" + input) || name.find('/') != name.size() - input.size() - 1) continue;
    const TraceChannel& channel = trace.channels()[place.channel];
    std::vector<double> samples;
    for (std::size_t row = 0; row < channel.rows(); ++row) samples.push_back(channel.number(row, place.column));
    return samples;
  }
  return {};
}

void add_pieces(const FuzzSetup& setup, const Trace& trace, std::vector<Inputs>& seeds) {
  std::vector<std::vector<double>> samples;
  std::size_t longest = 0;
  for (const InputColumn& column : setup.columns) {
    samples.push_back(column.joint >= 0 ? samples_of(trace, column.name) : std::vector<double>());
    longest = std::max(longest, samples.back().size());
  }
  const auto ticks = static_cast<std::size_t>(setup.plan.ticks);
  for (std::size_t piece = 0; piece < most_pieces && piece * ticks < longest; ++piece) {
    Inputs& inputs = seeds.emplace_back(inputs_at_start(setup.columns, setup.plan.ticks));
    for (std::size_t column = 0; column < samples.size(); ++column) {
      for (std::size_t tick = 0; tick < ticks && !samples[column].empty(); ++tick) {
        const double value = samples[column][std::min(piece * ticks + tick, samples[column].size() - 1)];
        if (std::isfinite(value)) inputs.at(static_cast<int>(tick), column) = setup.columns[column].clamped(value);
      }
    }
  }
}

}  // namespace

Result<std::vector<Inputs>> seeds_of(const FuzzSetup& setup) {
  std::vector<Inputs> seeds;
  if (setup.plan.seeds.empty()) return seeds;
  const fs::path folder = test_folders().golden;
  std::vector<fs::path> files;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed))
    if (entry.path().extension() == ".mcap" && matches(setup.plan.seeds, entry.path().stem().string()))
      files.push_back(entry.path());
  std::ranges::sort(files);
  if (files.empty())
    return error_in(folder.string(), fmt::format("no golden matches the seeds '{}'", setup.plan.seeds),
                    "expected a pattern of names as \"Hold.*\"");
  for (const fs::path& file : files) {
    const auto trace = Trace::load(file);
    if (!trace) return trace.errors();
    add_pieces(setup, *trace, seeds);
  }
  return seeds;
}

}  // namespace rehearse
