// Rules for the contacts of a body's links: pairs that touch each other, and links that touch nothing.
#include <algorithm>
#include <set>

#include "body_draft.h"

namespace rehearse::body {
namespace {

using Pair = std::array<int, 2>;

constexpr std::size_t max_pairs = 1'000'000;

class RuleReader {
 public:
  RuleReader(Model& model, Document& document)
      : model_(model), document_(document), touches_nothing_(model.links.size(), false), below_(model.links.size()) {
    for (std::size_t i = 1; i < model.links.size(); ++i)
      below_[static_cast<std::size_t>(model.links[i].parent)].push_back(static_cast<int>(i));
  }

  void read_rules(const YamlNode& rules) {
    if (rules.kind != YamlNode::Kind::list) return document_.error(rules, "collision_detection_rules isn't a list");
    for (const YamlNodePtr& item : rules.items) {
      Mapping rule(*item, "a collision rule", document_);
      for (const auto& [name, value] : rule.unread()) read_rule(name, *value);
    }
  }

  void read_old(const YamlNode& node) {
    Mapping keys(node, "collisionDetection", document_);
    if (!keys.is_map()) return;
    separate_chains(static_cast<int>(std::clamp(keys.soft_number({"excludeTreeDepth"}, 1.0), 0.0, 1000.0)));
    if (const YamlNode* links = keys.find({"excludeLinks"}))
      for (const int link : links_of(*links)) touches_nothing_[static_cast<std::size_t>(link)] = true;
    if (const YamlNode* groups = keys.find({"excludeLinkGroups"})) {
      for (const YamlNodePtr& item : groups->items) {
        if (item->kind == YamlNode::Kind::empty) continue;
        Mapping group(*item, "a group of links", document_);
        if (const YamlNode* links = group.find({"links"})) separate(links_of(*links));
        group.find({"name"});
        group.finish();
      }
    }
    keys.finish();
  }

  void apply() {
    model_.apart.assign(apart_.begin(), apart_.end());
    for (std::size_t i = 0; i < model_.links.size(); ++i)
      if (touches_nothing_[i]) model_.links[i].collisions.clear();
  }

 private:
  void read_rule(const std::string& rule, const YamlNode& value) {
    if (rule == "disabled_link_chain_level") {
      separate_chains(static_cast<int>(std::clamp(read_number(value, rule, document_).value_or(0.0), 0.0, 1000.0)));
    } else if (rule == "disabled_link_group") {
      separate(links_of(value));
    } else if (rule == "enabled_link_group") {
      const std::vector<int> links = links_of(value);
      for (std::size_t i = 0; i < links.size(); ++i) {
        touches_nothing_[static_cast<std::size_t>(links[i])] = false;
        for (std::size_t k = i + 1; k < links.size(); ++k)
          apart_.erase({std::min(links[i], links[k]), std::max(links[i], links[k])});
      }
    } else if (rule == "enabled_links" || rule == "disabled_links") {
      set_touching(links_of(value), rule == "enabled_links");
    } else {
      document_.passed_over(value, "a collision rule", rule);
    }
  }

  void set_touching(const std::vector<int>& links, bool touches) {
    for (const int link : links) {
      touches_nothing_[static_cast<std::size_t>(link)] = !touches;
      if (touches) std::erase_if(apart_, [link](const Pair& pair) { return pair[0] == link || pair[1] == link; });
    }
  }

  /// The links that a list names; all for the word "all". Names that aren't links are passed over, as in Choreonoid.
  std::vector<int> links_of(const YamlNode& node) {
    std::vector<int> links;
    if (node.kind == YamlNode::Kind::scalar && node.text == "all")
      for (std::size_t i = 0; i < model_.links.size(); ++i) links.push_back(static_cast<int>(i));
    for (const YamlNodePtr& item : node.items) {
      const int link = model_.find_link(item->text);
      if (link >= 0)
        links.push_back(link);
      else
        document_.warning(*item, "a collision rule names '" + item->text + "', which is not a link");
    }
    return links;
  }

  void separate(const std::vector<int>& links) {
    for (std::size_t i = 0; i < links.size(); ++i)
      for (std::size_t k = i + 1; k < links.size(); ++k) add(links[i], links[k]);
  }

  /// Links that at most `level` joints separate, free ones aside.
  void separate_chains(int level) {
    for (std::size_t i = 0; i < model_.links.size(); ++i) walk(static_cast<int>(i), static_cast<int>(i), -1, level);
  }

  void walk(int from, int at, int before, int level) {
    if (level <= 0 || apart_.size() > max_pairs) return;
    const auto step = [&](int to) {
      add(from, to);
      walk(from, to, at, level - 1);
    };
    const Link& link = model_.links[static_cast<std::size_t>(at)];
    if (link.parent >= 0 && link.parent != before && link.joint.type != JointType::free) step(link.parent);
    for (const int child : below_[static_cast<std::size_t>(at)])
      if (child != before && model_.links[static_cast<std::size_t>(child)].joint.type != JointType::free) step(child);
  }

  void add(int a, int b) {
    if (a == b || apart_.size() > max_pairs) return;
    apart_.insert({std::min(a, b), std::max(a, b)});
    if (apart_.size() > max_pairs)
      document_.findings().error(0, "the rules of collision separate more than a million pairs of links");
  }

  Model& model_;
  Document& document_;
  std::vector<bool> touches_nothing_;
  std::vector<std::vector<int>> below_;  // by link: its children
  std::set<Pair> apart_;
};

}  // namespace

void apply_collision_rules(const CollisionRules& rules, Model& model) {
  if (rules.document == nullptr) return;
  RuleReader reader(model, *rules.document);
  if (rules.rules != nullptr)
    reader.read_rules(*rules.rules);
  else
    reader.read_old(*rules.old);
  reader.apply();
}

}  // namespace rehearse::body
