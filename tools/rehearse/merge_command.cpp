// rehearse merge: merges several traces into one, in the order of time.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "core/mcap/merge.h"
#include "options.h"
#include "output.h"
#include "output_file.h"

namespace rehearse::tool {
namespace {

constexpr std::size_t most_sources = 1000;

struct MergeSettings {
  std::vector<std::string> sources;
  std::vector<std::string> prefixes;  // FILE=PREFIX
  std::string target;
  mcap::MergeOptions options;
  bool json = false;
};

/// The sources with their prefixes.
Result<std::vector<mcap::MergeSource>> sources_of(const MergeSettings& settings) {
  std::vector<mcap::MergeSource> sources;
  if (settings.sources.size() > most_sources)
    return error(fmt::format("{} files are too many: at most {} at a time", settings.sources.size(), most_sources));
  for (const std::string& file : settings.sources) sources.push_back({file, ""});
  for (const std::string& word : settings.prefixes) {
    const std::size_t at = word.rfind('=');
    const auto source = std::ranges::find_if(sources, [&](const mcap::MergeSource& candidate) {
      return at != std::string::npos && candidate.file == word.substr(0, at);
    });
    if (source == sources.end())
      return error(fmt::format("--prefix {} names none of the files", word),
                   "expected FILE=PREFIX, as left.mcap=/left");
    source->prefix = word.substr(at + 1);
  }
  return sources;
}

void tell(const MergeSettings& settings, const mcap::Merged& merged) {
  fmt::print("merged {}: {} in {}, {}, {}: {}, {}\n", count_text(settings.sources.size(), "file"),
             count_text(merged.messages, "message"), count_text(merged.channels, "channel"),
             count_text(merged.attachments, "attachment"), count_text(merged.metadata, "metadata record"),
             settings.target, file_size_text(merged.bytes));
  for (const std::string& remark : merged.remarks) fmt::print("  {}\n", remark);
}

Json result_json(const MergeSettings& settings, const mcap::Merged& merged) {
  return {{"file", settings.target},     {"sources", settings.sources},       {"messages", merged.messages},
          {"channels", merged.channels}, {"attachments", merged.attachments}, {"metadata", merged.metadata},
          {"size", merged.bytes},        {"remarks", merged.remarks}};
}

Exit run_merge(MergeSettings& settings) {
  const auto sources = sources_of(settings);
  if (!sources) return refuse(sources.errors());
  return write_trace(settings, "merging", [&](const std::filesystem::path& trace) {
    return mcap::merge(*sources, trace, settings.options);
  });
}

std::function<Exit()> declare_merge(CLI::App& options) {
  const auto settings = std::make_shared<MergeSettings>();
  options.add_option("TRACE", settings->sources, "recordings, or any other MCAP files")->required()->type_name("");
  options.add_option("-o,--output", settings->target, "the file to write; - is stdout")->required()->type_name("FILE");
  options.add_option("--prefix", settings->prefixes, "put before the topics of a file; repeatable")
      ->expected(1)
      ->take_all()
      ->type_name("FILE=PREFIX");
  options.add_flag("--keep-apart", settings->options.keep_apart,
                   "channels that are defined alike in several files don't become one");
  add_json_flag(options, settings->json);
  return [settings] { return run_merge(*settings); };
}

}  // namespace

extern const Verb merge_verb{
    "merge",
    "  rehearse merge walk.mcap cameras.mcap -o all.mcap\n"
    "  rehearse merge left.mcap right.mcap --prefix left.mcap=/left --prefix right.mcap=/right -o both.mcap\n"
    "\n"
    "By log time, then in the order of the command line, then as in the files.\n",
    declare_merge};

}  // namespace rehearse::tool
