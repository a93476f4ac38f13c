// rehearse filter: copies a part of a trace, or all of it with different compression or chunks.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "core/trace/filter.h"
#include "options.h"
#include "output.h"
#include "output_file.h"

namespace rehearse::tool {
namespace {

struct FilterSettings {
  std::string source;
  std::string target;
  mcap::FilterOptions options;
  TimeSpan span;
  std::string ticks, compression;
  std::vector<std::string> attachments;
  bool no_attachments = false, no_metadata = false;
  bool json = false;
};

/// Options in the form of text, parsed.
Result<void> read_selection(FilterSettings& settings) {
  mcap::Selection& selection = settings.options.selection;
  selection.from = settings.span.from;
  selection.until = settings.span.until;
  if (!settings.ticks.empty()) {
    selection.ticks = REHEARSE_TRY(mcap::parse_tick_span(settings.ticks));
  }
  if (settings.compression == "zstd") settings.options.compression = mcap::Compression::zstd;
  if (settings.compression == "lz4") settings.options.compression = mcap::Compression::lz4;
  if (settings.compression == "none") settings.options.compression = mcap::Compression::none;
  if (!settings.attachments.empty() || settings.no_attachments) settings.options.attachments = settings.attachments;
  settings.options.metadata = !settings.no_metadata;
  return {};
}

void tell(const FilterSettings& settings, const mcap::Filtered& filtered) {
  fmt::print("wrote {} of {} in {}, {}, {}: {}, {}\n", filtered.messages,
             count_text(filtered.messages + filtered.left_out, "message"), count_text(filtered.channels, "channel"),
             count_text(filtered.attachments, "attachment"), count_text(filtered.metadata, "metadata record"),
             settings.target, file_size_text(filtered.bytes));
  if (filtered.messages > 0)
    fmt::print("from {} to {}\n", time_text(filtered.first_time), time_text(filtered.last_time));
  for (const std::string& remark : filtered.remarks) fmt::print("  {}\n", remark);
}

Json result_json(const FilterSettings& settings, const mcap::Filtered& filtered) {
  return {{"file", settings.target},           {"messages", filtered.messages},       {"left_out", filtered.left_out},
          {"channels", filtered.channels},     {"attachments", filtered.attachments}, {"metadata", filtered.metadata},
          {"first_time", filtered.first_time}, {"last_time", filtered.last_time},     {"size", filtered.bytes},
          {"remarks", filtered.remarks}};
}

Exit run_filter(FilterSettings& settings) {
  if (const auto read = read_selection(settings); !read) return refuse(read.errors());
  return write_trace(settings, "filtering", [&](const std::filesystem::path& trace) {
    return mcap::filter(settings.source, trace, settings.options);
  });
}

std::function<Exit()> declare_filter(CLI::App& options) {
  const auto settings = std::make_shared<FilterSettings>();
  options.add_option("TRACE", settings->source, "a recording, or any other MCAP file")->required()->type_name("");
  options.add_option("-o,--output", settings->target, "the file to write; - is stdout")->required()->type_name("FILE");
  options.add_option("--topics", settings->options.selection.topics, "these only; * stands for any text")
      ->type_name("GLOB...");
  options.add_option("--exclude", settings->options.exclude, "not these, even if they were chosen")
      ->type_name("GLOB...");
  add_time_span(options, settings->span, "only messages from this time on", "only messages before this time");
  options.add_option("--ticks", settings->ticks, "of a recording of ours, as 100..199; both included")
      ->type_name("A..B");
  CLI::Option* attachments =
      options.add_option("--attachments", settings->attachments, "these only, by name; * stands for any text")
          ->type_name("GLOB...");
  options.add_flag("--no-attachments", settings->no_attachments, "leave all of them out")->excludes(attachments);
  options.add_flag("--no-metadata", settings->no_metadata, "leave the metadata records out");
  options.add_option("--compression", settings->compression, "of all channels (as each was)")
      ->check(CLI::IsMember({"zstd", "lz4", "none"}))
      ->type_name("zstd|lz4|none");
  add_integer(options, "--level", "of the compression", -7, 22,
              [=](std::int64_t level) { settings->options.level = static_cast<int>(level); });
  add_integer(options, "--chunk-size", "a chunk ends when it reaches this [bytes] (786432)", 1, std::int64_t{1} << 30,
              [=](std::int64_t size) { settings->options.chunk_size = static_cast<std::size_t>(size); });
  add_json_flag(options, settings->json);
  return [settings] { return run_filter(*settings); };
}

}  // namespace

extern const Verb filter_verb{"filter",
                              "  rehearse filter walk.mcap -o fall.mcap --from 3.1 --until 3.4\n"
                              "  rehearse filter walk.mcap -o numbers.mcap --exclude '*/image' '*/depth'\n"
                              "  rehearse filter walk.mcap -o joints.mcap --topics '/SR1/*joints' --ticks 0..99\n"
                              "  rehearse filter bag.mcap -o small.mcap --compression zstd --level 19\n",
                              declare_filter};

}  // namespace rehearse::tool
