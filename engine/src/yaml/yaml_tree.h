// A YAML file as a tree in document order, every node with its place. Private to the project.
//
// A separate tree is needed because YAML::Node drops duplicate keys and throws in any of its functions. Anchors and
// aliases work: an alias is the same node as its anchor, with the place of the anchor.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

struct YamlNode;
using YamlNodePtr = std::shared_ptr<const YamlNode>;

struct YamlNode {
  enum class Kind { empty, scalar, list, map };
  Kind kind = Kind::empty;
  std::string text;                // of a scalar
  bool quoted = false;             // a scalar in quotes (or tagged): text, never a number
  std::vector<YamlNodePtr> keys;   // of a map, in document order, duplicates included
  std::vector<YamlNodePtr> items;  // of a list; of a map: the values, parallel to keys
  int line = 1;                    // 1-based; an empty value has the place of its key
  int column = 1;                  // 1-based
  std::size_t weight = 1;          // number of nodes below and including this one, aliases counted in full
};

/// The bytes of a file of at most 1 MiB; `what` is its expected content: "a scenario". A diagnostic has the file's
/// name.
Result<std::string> read_yaml_file(const std::filesystem::path& path, const std::string& what);

/// The nodes of a file that have an anchor, by its name.
using YamlAnchors = std::map<std::string, YamlNodePtr>;

/// A file that consists of several: the anchors of one can be used in another.
struct YamlDocument {
  YamlNodePtr root;  // never null
  YamlAnchors anchors;
};

/// Parses the first YAML document of a text, whatever follows it. Its aliases may name anchors of `outer`, if the
/// document is a map.
Result<YamlDocument> parse_yaml_document(const std::string& text, const std::string& file,
                                         const YamlAnchors& outer = {});

/// Parses one YAML document; never null. `file` is used in messages. Text without a document is an empty node. Fails if
/// the text isn't YAML, contains a second document, nests too deep, or if its aliases unfold to over a million nodes.
Result<YamlNodePtr> parse_yaml(const std::string& text, const std::string& file);

/// The text as a scalar of YAML: as it is if it is a plain word, else in double quotes.
std::string yaml_text(std::string_view text);

}  // namespace rehearse
