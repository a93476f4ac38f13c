#include "ros2msg_literal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "base/text.h"
#include "ros2msg.h"

namespace rehearse::ros2msg {

namespace {

/// A type that needs no definition, because many writers leave it out.
struct WellKnown {
  std::string_view name;
  std::array<std::string_view, 4> fields;  // the last ones may be empty
};
constexpr WellKnown well_known[] = {
    {"builtin_interfaces/Time", {"int32 sec", "uint32 nanosec"}},
    {"builtin_interfaces/Duration", {"int32 sec", "uint32 nanosec"}},
    {"std_msgs/Header", {"builtin_interfaces/Time stamp", "string frame_id"}},
    {"service_msgs/ServiceEventInfo",
     {"uint8 event_type", "builtin_interfaces/Time stamp", "uint8[16] client_gid", "int64 sequence_number"}}};

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_name_character(char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; }

bool is_name(std::string_view text) {
  return !text.empty() && (is_letter(text[0]) || text[0] == '_') && std::ranges::all_of(text, is_name_character);
}

/// The line without its comment. A # within quotes begins no comment. A quote counts only where a text may begin, so an
/// apostrophe inside of a text is no quote.
std::string_view without_comment(std::string_view line) {
  char quote = 0;
  char before = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != 0) {
      if (c == '\\') {
        ++i;
      } else if (c == quote) {
        quote = 0;
      }
    } else if ((c == '"' || c == '\'') && (is_space(before) || before == '=' || before == '[' || before == ',')) {
      quote = c;
    } else if (c == '#') {
      return line.substr(0, i);
    }
    before = c;
  }
  return line;
}

std::optional<std::uint32_t> parse_count(std::string_view text) {
  const auto count = number_in<std::uint32_t>(text);
  return count && *count > 0 ? count : std::nullopt;
}

/// sensor_msgs/msg/Imu and sensor_msgs/Imu are the same type.
std::string canonical_name(std::string_view type) {
  std::string name(type);
  if (const auto middle = name.find("/msg/"); middle != std::string::npos) name.erase(middle, 4);
  return name;
}

// More than any message has, so that hostile text takes linear time.
constexpr std::size_t max_definitions = 1000;
constexpr std::size_t max_fields = 4096;
constexpr int max_depth = 64;

/// A field whose type is resolved when all definitions are known.
struct OpenField {
  std::size_t definition = 0;
  std::size_t field = 0;
  std::string type;  // as written in the schema
  int line = 0;
};

class Parser {
 public:
  Parser(std::string_view type, std::string file) : file_(std::move(file)) {
    schema_.definitions.push_back({canonical_name(type), {}, {}});
    by_name_.emplace(canonical_name(type), 0);
  }

  Result<Schema> parse(std::string_view text);

 private:
  void parse_line(std::string_view line);
  void begin_definition(std::string_view line);
  void begin_service(std::string_view name);
  void begin_response_of_root();
  void end_repeated();
  void add_definition(std::string name);
  void parse_declaration(std::string_view line);
  bool parse_type(std::string_view text, FieldType& type, std::string& message_name);
  void add_constant(const FieldType& type, std::string_view type_text, std::string_view name, std::string_view value);
  void add_field(FieldType type, std::string message_name, std::string_view name, std::string_view value);
  void resolve();
  std::optional<std::size_t> find_definition(std::string_view type, std::string_view package) const;
  std::optional<std::size_t> add_known(std::string_view type);
  void check_cycles();
  enum class Mark { unseen, open, done };  // open: contains the present definition
  void visit(std::size_t definition, int depth, std::vector<Mark>& marks);
  int line_of(std::size_t definition, std::size_t field) const;
  void complain(int line, std::string message, std::string hint = {});

  Definition& current() { return schema_.definitions.back(); }

  Schema schema_;
  std::string file_;
  std::map<std::string, std::size_t, std::less<>> by_name_;  // indices into the definitions
  std::vector<OpenField> open_fields_;
  Diagnostics errors_;
  std::vector<std::vector<std::string>> texts_{{}};  // the lines of each definition
  std::optional<std::size_t> repeats_;               // the definition that the present lines repeat
  std::vector<std::string> repeated_;                // lines that repeat this definition
  std::optional<std::size_t> service_;               // index of its request, which the response follows
  int line_ = 0;
  bool expects_heading_ = false;
};

Result<Schema> Parser::parse(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    ++line_;
    parse_line(trim(without_comment(text.substr(0, end))));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  if (expects_heading_) complain(line_, "the text ends before the expected line \"MSG: package/Name\"");
  end_repeated();
  resolve();
  if (errors_.empty()) check_cycles();
  if (!errors_.empty()) return errors_;
  return std::move(schema_);
}

void Parser::parse_line(std::string_view line) {
  if (line.empty()) return;
  if (line.find_first_not_of('=') == std::string_view::npos) {
    expects_heading_ = true;
  } else if (expects_heading_) {
    begin_definition(line);
  } else if (repeats_) {
    repeated_.emplace_back(line);
  } else if (line == "---" && service_ && schema_.definitions[*service_].name.ends_with("_Request")) {
    const std::string& request = schema_.definitions[*service_].name;
    service_ = schema_.definitions.size();
    add_definition(request.substr(0, request.rfind('_')) + "_Response");
  } else if (line == "---" && !service_ && schema_.definitions.size() == 1 && current().name.ends_with("_Event")) {
    begin_response_of_root();
  } else {
    texts_.back().emplace_back(line);
    parse_declaration(line);
  }
}

void Parser::add_definition(std::string name) {
  by_name_.emplace(name, schema_.definitions.size());
  schema_.definitions.push_back({std::move(name), {}, {}});
  texts_.emplace_back();
}

/// The text of a service without its line "SRV:" (seen in rosbag2 0.25): the fields before belong to the request.
void Parser::begin_response_of_root() {
  constexpr std::size_t suffix = std::string_view("_Event").size();
  Definition request = std::exchange(current(), {current().name, {}, {}});
  std::vector<OpenField> open = std::exchange(open_fields_, {});
  begin_service(current().name.substr(0, current().name.size() - suffix));
  current().fields = std::move(request.fields);
  current().constants = std::move(request.constants);
  for (OpenField& field : open) {
    field.definition = *service_;
    open_fields_.push_back(std::move(field));
  }
  service_ = schema_.definitions.size();
  add_definition(request.name.substr(0, request.name.size() - suffix) + "_Response");
}

/// Reports a type with two different definitions. Two equal definitions are valid: rosbag2 writes some types twice.
void Parser::end_repeated() {
  if (repeats_ && repeated_ != texts_[*repeats_])
    complain(line_, fmt::format("type {} is defined twice, differently", schema_.definitions[*repeats_].name));
  repeats_.reset();
  repeated_.clear();
}

/// The text of a service (SRV: package/srv/Name, the request's fields, ---, the response's fields), which rosbag2 0.26
/// writes for the events of a service, of type package/srv/Name_Event. An event contains an info, and a request or a
/// response.
void Parser::begin_service(std::string_view name) {
  const std::string service = canonical_name(name);
  if (schema_.definitions.size() > 1 || !current().fields.empty())
    return complain(line_, "a service is defined after a message");
  constexpr int max_parts = 1;
  const auto add_part = [&](const char* field, std::string type, FieldType::Shape shape) {
    FieldType part;
    part.is_message = true;
    part.shape = shape;
    part.count = shape == FieldType::Shape::sequence ? max_parts : 0;
    add_field(part, std::move(type), field, {});
  };
  add_part("info", "service_msgs/ServiceEventInfo", FieldType::Shape::single);
  add_part("request", service + "_Request", FieldType::Shape::sequence);
  add_part("response", service + "_Response", FieldType::Shape::sequence);
  service_ = schema_.definitions.size();
  add_definition(service + "_Request");
}

void Parser::begin_definition(std::string_view line) {
  constexpr std::string_view heading = "MSG:", service = "SRV:";
  expects_heading_ = false;
  end_repeated();
  if (line.starts_with(service)) return begin_service(trim(line.substr(service.size())));
  const std::string name = line.starts_with(heading) ? canonical_name(trim(line.substr(heading.size()))) : "";
  if (name.empty()) complain(line_, "no line \"MSG: package/Name\" follows the line of = signs");
  if (schema_.definitions.size() == max_definitions) {
    return complain(line_, fmt::format("more than {} types in one schema", max_definitions));
  }
  if (const auto known = by_name_.find(name); known != by_name_.end()) {
    repeats_ = known->second;
  } else {
    add_definition(name);
  }
}

void Parser::parse_declaration(std::string_view line) {
  const auto type_end = std::ranges::find_if(line, is_space);
  const std::string_view type_text(line.begin(), type_end);
  const std::string_view rest = trim(std::string_view(type_end, line.end()));
  const auto name_end = std::ranges::find_if_not(rest, is_name_character);
  const std::string_view name(rest.begin(), name_end);
  const std::string_view value = trim(std::string_view(name_end, rest.end()));
  if (!is_name(name)) return complain(line_, fmt::format("\"{}\" is neither a field nor a constant", line));
  FieldType type;
  std::string message_name;
  if (!parse_type(type_text, type, message_name)) return;
  if (value.starts_with('=')) {
    add_constant(type, type_text, name, trim(value.substr(1)));
  } else if (!value.empty() && name_end != rest.end() && !is_space(*name_end)) {
    complain(line_, fmt::format("\"{}\" is no name for a field", rest));
  } else {
    add_field(type, std::move(message_name), name, value);
  }
}

/// `message_name` stays empty for a primitive. False after an error was reported.
bool Parser::parse_type(std::string_view text, FieldType& type, std::string& message_name) {
  const std::string_view whole = text;
  const auto malformed = [&] { return complain(line_, fmt::format("\"{}\" is no type", whole)), false; };
  if (text.ends_with(']')) {
    const std::size_t open = text.rfind('[');
    if (open == std::string_view::npos) return malformed();
    std::string_view inside = text.substr(open + 1, text.size() - open - 2);
    text = text.substr(0, open);
    type.shape = FieldType::Shape::sequence;
    if (!inside.empty()) {
      const bool bound = inside.starts_with("<=");
      if (bound) inside.remove_prefix(2);
      const auto count = parse_count(inside);
      if (!count) return malformed();
      type.count = *count;
      if (!bound) type.shape = FieldType::Shape::array;
    }
  }
  if (text.starts_with("string<=")) {
    const auto bound = parse_count(text.substr(8));
    if (!bound) return malformed();
    type.string_bound = *bound;
    text = "string";
  }
  if (text == "wstring" || text.starts_with("wstring<=")) {
    return complain(line_, "type wstring can't be decoded: its encoding depends on the middleware"), false;
  }
  if (const auto primitive = find_primitive(text)) {
    type.primitive = *primitive;
    return true;
  }
  const bool plain = std::ranges::all_of(text, [](char c) { return is_name_character(c) || c == '/'; });
  if (text.empty() || !plain) return malformed();
  type.is_message = true;
  message_name = text;
  return true;
}

void Parser::add_constant(const FieldType& type, std::string_view type_text, std::string_view name,
                          std::string_view value) {
  if (type.is_message || type.shape != FieldType::Shape::single) {
    return complain(line_, fmt::format("constant {} can't be of type {}", name, type_text), "a primitive type");
  }
  if (value.empty()) return complain(line_, fmt::format("constant {} has no value", name));
  for (const Constant& constant : current().constants) {
    if (constant.name == name) return complain(line_, fmt::format("constant {} is declared twice", name));
  }
  if (current().constants.size() == max_fields) {
    return complain(line_, fmt::format("more than {} constants in one type", max_fields));
  }
  if (const std::string wrong = literal_problem(type, value); !wrong.empty()) {
    return complain(line_, fmt::format("constant {}: the value {}", name, wrong));
  }
  current().constants.push_back({std::string(name), type.primitive, std::string(without_quotes(type, value))});
}

void Parser::add_field(FieldType type, std::string message_name, std::string_view name, std::string_view value) {
  if (current().fields.size() == max_fields) {
    return complain(line_, fmt::format("more than {} fields in one type", max_fields));
  }
  for (const FieldDefinition& field : current().fields) {
    if (field.name == name) return complain(line_, fmt::format("field {} is declared twice", name));
  }
  if (type.is_message && !value.empty()) {
    return complain(line_, fmt::format("field {}: a message has no default", name));
  }
  if (const std::string wrong = value.empty() ? "" : literal_problem(type, value); !wrong.empty()) {
    return complain(line_, fmt::format("field {}: the default {}", name, wrong));
  }
  if (type.is_message) {
    open_fields_.push_back({schema_.definitions.size() - 1, current().fields.size(), std::move(message_name), line_});
  }
  current().fields.push_back({std::string(name), type, std::string(value)});
}

void Parser::resolve() {
  // An empty request or response has one byte.
  FieldType byte;
  byte.primitive = Primitive::uint8;
  for (Definition& definition : schema_.definitions)
    if (service_ && definition.fields.empty() &&
        (definition.name.ends_with("_Request") || definition.name.ends_with("_Response")))
      definition.fields.push_back({"structure_needs_at_least_one_member", byte, {}});
  // The list grows during the loop: a well-known type may use further types.
  for (std::size_t i = 0; i < open_fields_.size(); ++i) {
    const OpenField open = open_fields_[i];
    const std::string type = canonical_name(open.type);
    const std::string enclosing = schema_.definitions[open.definition].name;
    auto found = find_definition(type, enclosing.substr(0, enclosing.find('/')));
    if (!found) found = add_known(type);
    if (found) {
      schema_.definitions[open.definition].fields[open.field].type.message = *found;
    } else {
      complain(open.line, fmt::format("type {} is used but not defined", open.type));
    }
  }
}

/// A name without package is a type of the same package; Header, if that package has none, is std_msgs/Header.
std::optional<std::size_t> Parser::find_definition(std::string_view type, std::string_view package) const {
  const auto find = [&](std::string_view name) -> std::optional<std::size_t> {
    const auto place = by_name_.find(name);
    return place == by_name_.end() ? std::nullopt : std::optional(place->second);
  };
  if (type.find('/') != std::string_view::npos) return find(type);
  if (const auto same_package = find(fmt::format("{}/{}", package, type))) return same_package;
  return type == "Header" ? find("std_msgs/Header") : std::nullopt;
}

/// Adds a well-known type. Must be called after the text is parsed.
std::optional<std::size_t> Parser::add_known(std::string_view type) {
  if (type == "Header") type = "std_msgs/Header";
  const auto known = std::ranges::find(well_known, type, &WellKnown::name);
  if (known == std::end(well_known)) return std::nullopt;
  const std::size_t index = schema_.definitions.size();
  add_definition(std::string(type));
  line_ = 0;  // its fields have no line in the text
  for (const std::string_view field : known->fields)
    if (!field.empty()) parse_declaration(field);
  return index;
}

void Parser::check_cycles() {
  std::vector<Mark> marks(schema_.definitions.size(), Mark::unseen);
  for (std::size_t i = 0; i < marks.size(); ++i) visit(i, 0, marks);
}

/// Visits definitions depth first. A constant limits the depth, so that the stack can't overflow.
void Parser::visit(std::size_t definition, int depth, std::vector<Mark>& marks) {
  if (marks[definition] == Mark::done || !errors_.empty()) return;
  marks[definition] = Mark::open;
  const std::vector<FieldDefinition>& fields = schema_.definitions[definition].fields;
  for (std::size_t i = 0; i < fields.size() && errors_.empty(); ++i) {
    if (!fields[i].type.is_message) continue;
    const std::size_t used = fields[i].type.message;
    if (marks[used] == Mark::open) {
      complain(line_of(definition, i), fmt::format("type {} contains itself", schema_.definitions[used].name));
    } else if (depth == max_depth) {
      complain(line_of(definition, i), fmt::format("types are nested more than {} deep", max_depth));
    } else {
      visit(used, depth + 1, marks);
    }
  }
  marks[definition] = Mark::done;
}

int Parser::line_of(std::size_t definition, std::size_t field) const {
  for (const OpenField& open : open_fields_) {
    if (open.definition == definition && open.field == field) return open.line;
  }
  return 0;
}

void Parser::complain(int line, std::string message, std::string hint) {
  constexpr std::size_t limit = 20;
  if (errors_.size() < limit) errors_.push_back({Severity::error, file_, line, 0, std::move(message), std::move(hint)});
}

}  // namespace

Result<Schema> Schema::parse(std::string_view type, std::string_view text, std::string file) {
  return Parser(type, std::move(file)).parse(text);
}

}  // namespace rehearse::ros2msg
