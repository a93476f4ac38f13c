#include "body_mapping.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "base/names.h"
#include "base/text.h"

namespace rehearse::body {

std::optional<double> leading_number(std::string_view text, bool& is_whole) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [rest, bad] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (bad != std::errc()) return std::nullopt;
  const std::string_view after(rest, static_cast<std::size_t>(text.data() + text.size() - rest));
  is_whole = after.find_first_not_of(" \t\r\n") == std::string_view::npos;
  return value;
}

std::optional<double> read_number(const YamlNode& node, std::string_view label, Document& document) {
  bool is_whole = false;
  const auto value = node.kind == YamlNode::Kind::scalar ? leading_number(node.text, is_whole) : std::nullopt;
  if (!value) {
    const std::string what =
        node.kind == YamlNode::Kind::scalar ? in_quotes(node.text) : "a list, a mapping or nothing";
    document.error(node, fmt::format("{} is {}, and a number is expected", label, what));
  } else if (std::isnan(*value)) {
    document.error(node, fmt::format("{} isn't a number", label));
    return std::nullopt;
  } else if (!is_whole) {
    document.warning(node, fmt::format("{} is {}; it is read as {}", label, in_quotes(node.text), *value));
  }
  return value;
}

std::optional<std::vector<double>> read_numbers(const YamlNode& node, std::size_t size, std::string_view label,
                                                Document& document) {
  if (node.kind != YamlNode::Kind::list || (size != 0 && node.items.size() != size)) {
    const std::string how_many = size == 0 ? "numbers" : fmt::format("{} numbers", size);
    document.error(node, fmt::format("{} isn't a list of {}", label, how_many));
    return std::nullopt;
  }
  std::vector<double> values;
  for (const YamlNodePtr& item : node.items) {
    const auto value = read_number(*item, label, document);
    if (!value) return std::nullopt;
    if (!std::isfinite(*value)) {
      document.error(*item, fmt::format("{} has an infinite number", label));
      return std::nullopt;
    }
    values.push_back(*value);
  }
  return values;
}

namespace {

/// True for a list of lists.
bool has_several(const YamlNode& node) {
  return node.kind == YamlNode::Kind::list && !node.items.empty() && node.items.front()->kind == YamlNode::Kind::list;
}

std::optional<Eigen::Matrix3d> read_one_rotation(const YamlNode& node, Document& document) {
  const auto values = read_numbers(node, 4, "a rotation", document);
  if (!values) return std::nullopt;
  const Eigen::Vector3d axis((*values)[0], (*values)[1], (*values)[2]);
  constexpr double shortest = 1e-6;
  if (axis.norm() < shortest) {
    document.error(node, "the axis of a rotation is zero", "[x, y, z, angle]");
    return std::nullopt;
  }
  const double angle = document.degrees ? (*values)[3] * std::numbers::pi / 180.0 : (*values)[3];
  if (!document.degrees && std::abs((*values)[3]) > 10.0)
    document.warning(node, fmt::format("a rotation by {} rad looks like degrees", (*values)[3]),
                     "the file states angleUnit: radian");
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

}  // namespace

std::optional<Eigen::Matrix3d> read_rotation(const YamlNode& node, Document& document) {
  if (node.kind == YamlNode::Kind::list && node.items.empty()) return Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  if (!has_several(node)) return read_one_rotation(node, document);
  Eigen::Matrix3d product = Eigen::Matrix3d::Identity();
  for (const YamlNodePtr& item : node.items) {
    const auto rotation = read_rotation(*item, document);
    if (!rotation) return std::nullopt;
    product = product * *rotation;
  }
  return product;
}

std::optional<Eigen::Vector3d> read_translation(const YamlNode& node, Document& document) {
  const auto one = [&document](const YamlNode& item) -> std::optional<Eigen::Vector3d> {
    const auto values = read_numbers(item, 3, "a translation", document);
    if (!values) return std::nullopt;
    return Eigen::Vector3d((*values)[0], (*values)[1], (*values)[2]);
  };
  if (!has_several(node)) return one(node);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const YamlNodePtr& item : node.items) {
    const auto translation = read_translation(*item, document);
    if (!translation) return std::nullopt;
    sum += *translation;
  }
  return sum;
}

Mapping::Mapping(const YamlNode& node, std::string_view kind, Document& document)
    : node_(node), kind_(kind), document_(document) {
  if (is_map())
    take(node, 0);
  else
    document.error(node, fmt::format("{} isn't a mapping of keys and values", kind));
}

void Mapping::take(const YamlNode& map, int depth) {
  std::map<std::string, Entry, std::less<>> own;
  std::vector<const YamlNode*> merges;
  for (std::size_t i = 0; i < map.keys.size() && i < map.items.size(); ++i) {
    const YamlNode& key = *map.keys[i];
    if (key.kind != YamlNode::Kind::scalar) {
      document_.error(key, fmt::format("a key of {} isn't a text", kind_));
      continue;
    }
    if (key.text == "<<" && !key.quoted) {
      merges.push_back(map.items[i].get());
      continue;
    }
    const auto [known, is_new] = own.insert_or_assign(key.text, Entry{&key, map.items[i].get()});
    if (!is_new)
      document_.warning(key, fmt::format("the key {} appears twice; the last one counts", in_quotes(key.text)));
  }
  for (auto& [name, entry] : own) entries_.emplace(name, entry);  // explicit keys go before merged ones
  for (const YamlNode* value : merges) merge(*value, depth + 1);
}

void Mapping::merge(const YamlNode& value, int depth) {
  if (value.kind == YamlNode::Kind::map && depth < max_body_depth) {
    take(value, depth);
  } else if (value.kind == YamlNode::Kind::list && depth < max_body_depth) {
    for (const YamlNodePtr& item : value.items) merge(*item, depth + 1);
  } else {
    document_.error(value, "the value of << isn't a mapping");
  }
}

const YamlNode* Mapping::find(Names names) {
  const YamlNode* found = nullptr;
  for (const std::string_view name : names) {
    asked_.emplace_back(name);
    const auto entry = entries_.find(name);
    if (entry == entries_.end()) continue;
    entry->second.is_read = true;
    if (found == nullptr && entry->second.value->kind != YamlNode::Kind::empty) found = entry->second.value;
  }
  return found;
}

std::optional<double> Mapping::number(Names names) {
  const YamlNode* value = find(names);
  return value == nullptr ? std::nullopt : read_number(*value, *names.begin(), document_);
}

std::optional<std::vector<double>> Mapping::numbers(Names names, std::size_t size) {
  const YamlNode* value = find(names);
  return value == nullptr ? std::nullopt : read_numbers(*value, size, *names.begin(), document_);
}

std::optional<Eigen::Vector3d> Mapping::vector(Names names) {
  const auto values = numbers(names, 3);
  if (!values) return std::nullopt;
  return Eigen::Vector3d((*values)[0], (*values)[1], (*values)[2]);
}

std::optional<std::string> Mapping::text(Names names) {
  const YamlNode* value = find(names);
  if (value == nullptr) return std::nullopt;
  if (value->kind == YamlNode::Kind::scalar && printable(value->text, value->text.size()) == value->text)
    return value->text;
  document_.error(*value, fmt::format("{} isn't a text of one line", *names.begin()));
  return std::nullopt;
}

std::optional<bool> Mapping::flag(Names names) {
  const YamlNode* value = find(names);
  if (value == nullptr) return std::nullopt;
  std::string word = value->text;
  std::ranges::transform(word, word.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (word == "y" || word == "yes" || word == "true" || word == "on") return true;
  if (word == "n" || word == "no" || word == "false" || word == "off") return false;
  document_.error(*value, fmt::format("{} is {}, and true or false is expected", *names.begin(), in_quotes(word)));
  return std::nullopt;
}

double Mapping::radians(double angle) const { return document_.degrees ? angle * std::numbers::pi / 180.0 : angle; }

std::optional<double> Mapping::angle(Names names) {
  const auto value = number(names);
  return value ? std::optional(radians(*value)) : std::nullopt;
}

double Mapping::soft_number(Names names, double otherwise) {
  const YamlNode* value = find(names);
  if (value == nullptr) return otherwise;
  bool is_whole = false;
  const auto read = value->kind == YamlNode::Kind::scalar ? leading_number(value->text, is_whole) : std::nullopt;
  if (read && is_whole && std::isfinite(*read)) return *read;
  document_.warning(
      *value, fmt::format("{} of {} isn't a number; {} is taken, as in Choreonoid", *names.begin(), kind_, otherwise));
  return otherwise;
}

double Mapping::soft_angle(Names names, double otherwise) {
  return find(names) == nullptr
             ? otherwise
             : radians(soft_number(names, document_.degrees ? otherwise * 180.0 / std::numbers::pi : otherwise));
}

Eigen::Affine3d Mapping::transform(bool has_scale) {
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  if (const YamlNode* translation = find({"translation"}))
    transform.translation() = read_translation(*translation, document_).value_or(Eigen::Vector3d::Zero());
  if (const YamlNode* rotation = find({"rotation"}))
    transform.linear() = read_rotation(*rotation, document_).value_or(Eigen::Matrix3d::Identity());
  const YamlNode* scale = has_scale ? find({"scale"}) : nullptr;
  if (scale == nullptr) return transform;
  if (scale->kind == YamlNode::Kind::scalar) {
    document_.warning(*scale, "a scale of one number has no effect", "write [x, y, z]");
    return transform;
  }
  const auto factors = read_numbers(*scale, 3, "scale", document_);
  if (!factors) return transform;
  const Eigen::Vector3d s((*factors)[0], (*factors)[1], (*factors)[2]);
  if (s.cwiseAbs().minCoeff() <= 0.0)
    document_.error(*scale, "a factor of the scale is 0", "1 keeps the size");
  else
    transform.linear() *= s.asDiagonal();
  return transform;
}

std::vector<std::pair<std::string, const YamlNode*>> Mapping::unread() const {
  std::vector<std::pair<std::string, const YamlNode*>> unread;
  for (const auto& [name, entry] : entries_)
    if (!entry.is_read) unread.emplace_back(name, entry.value);
  return unread;
}

void Mapping::finish(const std::vector<std::string_view>& without_effect) {
  for (const auto& [name, entry] : entries_) {
    if (entry.is_read) continue;
    const bool is_known = std::ranges::find(without_effect, name) != without_effect.end();
    const std::vector<std::string> near = is_known ? std::vector<std::string>() : near_names(name, asked_);
    if (near.empty())
      document_.passed_over(*entry.key, kind_, name);
    else
      document_.misspelt(*entry.key, kind_, name, name_hint(name, asked_, "keys"));
  }
}

}  // namespace rehearse::body
