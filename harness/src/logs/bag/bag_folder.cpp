#include "bag_folder.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.h"
#include "core/mcap/container.h"
#include "yaml/yaml_tree.h"

namespace rehearse::bag {

namespace fs = std::filesystem;

namespace {

constexpr const char* file_name = "metadata.yaml";
constexpr std::string_view top_key = "rosbag2_bagfile_information";
constexpr std::size_t most_files = 0x3000;

/// The entries of a map; the first entry of each name counts.
const YamlNode* find(const YamlNode* node, std::string_view key) {
  if (node == nullptr || node->kind != YamlNode::Kind::map) return nullptr;
  for (std::size_t i = 0; i < node->keys.size(); ++i)
    if (node->keys[i]->text == key) return node->items[i].get();
  return nullptr;
}

std::string text_of(const YamlNode* node) {
  return node != nullptr && node->kind == YamlNode::Kind::scalar ? node->text : "";
}

constexpr std::string_view suffixes[] = {".db3", ".db3.zstd", ".mcap", ".mcap.zstd", ".mcap.zst"};

std::string storage_of(const fs::path& file) {
  const std::string name = file.filename().string();
  return name.ends_with(suffixes[0]) || name.ends_with(suffixes[1]) ? "sqlite3" : "mcap";
}

/// The name of a log as rosbag2 forms it: friday_12.db3 is the part 12 of friday.
struct PartName {
  fs::path file;
  std::string recording;     // with the suffix: friday_.db3
  std::int64_t number = -1;  // -1: the name has none
};

/// nullopt: the file isn't named as a log.
std::optional<PartName> part_name(const fs::path& file) {
  const std::string name = file.filename().string();
  for (const std::string_view suffix : suffixes) {
    if (!name.ends_with(suffix)) continue;
    const std::string stem = name.substr(0, name.size() - suffix.size());
    const std::size_t digits = stem.find_last_of('_') + 1;  // 0: there is no _
    const auto number = digits == 0 ? std::nullopt : number_in<std::int64_t>(stem.substr(digits));
    if (!number || *number < 0) return PartName{file, name};
    return PartName{file, stem.substr(0, digits).append(suffix), *number};
  }
  return std::nullopt;
}

class FolderReader {
 public:
  explicit FolderReader(fs::path folder) : path_(std::move(folder)) { folder_.metadata = path_ / file_name; }

  Result<Folder> read();
  Result<Folder> read_without_metadata();

 private:
  Diagnostic wrong(const YamlNode& at, std::string message, std::string hint = {}) const {
    Diagnostic diagnostic = error_in(folder_.metadata.string(), std::move(message), std::move(hint));
    diagnostic.line = at.line;
    diagnostic.column = at.column;
    return diagnostic;
  }
  void report(const YamlNode& at, std::string message, std::string hint = {}) {
    problems_.push_back(wrong(at, std::move(message), std::move(hint)));
  }
  std::optional<StatedNumber> number(const YamlNode* node, std::string_view what);
  void read_storage(const YamlNode& bag);
  void read_compression(const YamlNode& bag);
  void read_files(const YamlNode& bag);
  void read_topics(const YamlNode& bag);

  const fs::path path_;
  Folder folder_;
  Diagnostics problems_;
};

/// A whole number of at least 0; nullopt without a node.
std::optional<StatedNumber> FolderReader::number(const YamlNode* node, std::string_view what) {
  if (node == nullptr) return std::nullopt;
  const std::string text = text_of(node);
  const auto value = number_in<std::int64_t>(text);
  if (value && *value >= 0) return StatedNumber{*value, node->line};
  report(*node, fmt::format("{} is {}", what, text.empty() ? "no number" : in_quotes(text)),
         "expected a whole number of at least 0");
  return std::nullopt;
}

void FolderReader::read_storage(const YamlNode& bag) {
  const YamlNode* storage = find(&bag, "storage_identifier");
  folder_.storage = text_of(storage);
  if (!folder_.storage.empty() && folder_.storage != "mcap" && folder_.storage != "sqlite3")
    report(*storage, fmt::format("the storage {} can't be read", in_quotes(folder_.storage)),
           "expected mcap or sqlite3; ros2 bag convert writes one of these");
}

void FolderReader::read_compression(const YamlNode& bag) {
  const YamlNode* mode = find(&bag, "compression_mode");
  const YamlNode* format = find(&bag, "compression_format");
  std::string stated = text_of(mode);
  std::ranges::transform(stated, stated.begin(), [](char c) { return c >= 'a' ? c - 'a' + 'A' : c; });
  if (stated.empty() || stated == "NONE") return;
  if (stated != "FILE" && stated != "MESSAGE") {
    report(*mode, fmt::format("the compression_mode {} is unknown", in_quotes(mode->text)),
           "expected NONE, FILE or MESSAGE");
  } else if (text_of(format) != "zstd") {
    report(format ? *format : *mode, fmt::format("the compression_format {} is unknown", in_quotes(text_of(format))),
           "expected zstd");
  }
  folder_.compressed_messages = stated == "MESSAGE";
}

void FolderReader::read_files(const YamlNode& bag) {
  const YamlNode* files = find(&bag, "relative_file_paths");
  if (files == nullptr || files->kind != YamlNode::Kind::list || files->items.empty())
    return report(files ? *files : bag, "it names no file in 'relative_file_paths'", "expected a list of files");
  if (files->items.size() > most_files)
    return report(*files, fmt::format("it names {} files", files->items.size()),
                  fmt::format("expected at most {}", most_files));
  for (const YamlNodePtr& item : files->items) {
    const fs::path file = text_of(item.get());
    // Early versions name the files with the folder's own name before them.
    fs::path found = path_ / file;
    std::error_code ignored;
    if (!fs::exists(found, ignored)) found = path_ / file.filename();
    if (file.empty() || !fs::exists(found, ignored)) {
      report(*item, fmt::format("it names the file {}, which isn't in the folder", in_quotes(file.string())),
             "copy it there; or ros2 bag reindex makes a new metadata.yaml from the existing files");
    } else if (fs::is_directory(found, ignored)) {
      report(*item, fmt::format("it names {}, which is a folder", in_quotes(file.string())), "expected a file");
    } else {
      folder_.files.push_back(std::move(found));
    }
  }
}

void FolderReader::read_topics(const YamlNode& bag) {
  const YamlNode* topics = find(&bag, "topics_with_message_count");
  if (topics == nullptr || topics->kind != YamlNode::Kind::list) return;
  for (const YamlNodePtr& item : topics->items) {
    const YamlNode* about = find(item.get(), "topic_metadata");
    FolderTopic topic{text_of(find(about, "name")), text_of(find(about, "type")), 0, item->line};
    if (const auto count = number(find(item.get(), "message_count"), "the message_count of a topic"))
      topic.messages = static_cast<std::uint64_t>(count->value);
    if (topic.name.empty()) report(*item, "a topic has no name", "expected topic_metadata: {name: ..., type: ...}");
    folder_.topics.push_back(std::move(topic));
  }
}

Result<Folder> FolderReader::read() {
  std::error_code ignored;
  if (!fs::exists(folder_.metadata, ignored)) return read_without_metadata();
  const auto text = REHEARSE_TRY(read_yaml_file(folder_.metadata, "the metadata of a rosbag2 folder"));
  const auto root = REHEARSE_TRY(parse_yaml(text, folder_.metadata.string()));
  const YamlNode* bag = find(root.get(), top_key);
  if (bag == nullptr || bag->kind != YamlNode::Kind::map)
    return wrong(*root, fmt::format("it has no map '{}'", top_key), "expected the metadata of a rosbag2 folder");
  number(find(bag, "version"), "version");  // only to report a mistake in it
  read_storage(*bag);
  read_compression(*bag);
  read_files(*bag);
  read_topics(*bag);
  folder_.messages = number(find(bag, "message_count"), "message_count");
  folder_.start = number(find(find(bag, "starting_time"), "nanoseconds_since_epoch"), "starting_time");
  folder_.duration = number(find(find(bag, "duration"), "nanoseconds"), "duration");
  if (!problems_.empty()) return problems_;
  if (folder_.storage.empty()) folder_.storage = storage_of(folder_.files.front());
  return folder_;
}

Result<Folder> FolderReader::read_without_metadata() {
  folder_.metadata.clear();
  std::error_code failed;
  std::vector<PartName> parts;
  for (fs::directory_iterator entry(path_, failed), end; !failed && entry != end; entry.increment(failed)) {
    const auto part = part_name(entry->path());
    if (part && entry->is_regular_file(failed)) parts.push_back(*part);
  }
  if (failed) return error_in(path_.string(), fmt::format("can't read the folder: {}", failed.message()));
  if (parts.empty() || parts.size() > most_files)
    return error_in(path_.string(),
                    fmt::format("can't read the trace: it is a directory without {}, and with {} logs of rosbag2",
                                file_name, parts.empty() ? "no" : "too many"),
                    "name a file in it; or ros2 bag reindex makes this file from the files in the folder");
  std::ranges::stable_sort(parts, [](const PartName& a, const PartName& b) { return a.number < b.number; });
  for (std::size_t i = 1; i < parts.size(); ++i)
    if (parts[i].recording != parts[0].recording || parts[i].number == parts[i - 1].number)
      return error_in(
          path_.string(),
          fmt::format("it has no {}, and {} and {} aren't the parts of one recording", file_name,
                      in_quotes(parts[i - 1].file.filename().string()), in_quotes(parts[i].file.filename().string())),
          "name one of its files; merge joins several");
  for (PartName& part : parts) folder_.files.push_back(std::move(part.file));
  folder_.storage = storage_of(folder_.files.front());
  return folder_;
}

}  // namespace

fs::path folder_of(const fs::path& log) { return mcap::folder_of(log); }

Result<Folder> read_folder(const fs::path& folder) { return FolderReader(folder).read(); }

}  // namespace rehearse::bag
