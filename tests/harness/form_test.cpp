// Forms and their JSON Schemas; tests/tools/schema_test.py compares them with files and outputs.
#include "core/form/form.h"

#include <gmock/gmock.h>

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/form/form_schema.h"
#include "core/form/form_table.h"
#include "core/scenario/bound_form.h"
#include "core/scenario/scenario_forms.h"
#include "core/scenario/scenario_values.h"

namespace rehearse {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

const Form& leaf_form() {
  static const Form form{"leaf",
                         "a leaf",
                         {{"length", types::quantity(length_units, {0.0, 2.0, "[m]", true}), "its length [m]", "1"},
                          {"color", types::word({"green", "red"}), "its colour", "green"},
                          {"name", types::name(), "its name", required},
                          {"vein", types::flag(), "it has one"},
                          {"stem", types::flag(), "it has one"}},
                         {{"vein", "stem"}}};
  return form;
}

const Form& branch_form() {
  static const Form form{"branch",
                         "a branch",
                         {{"leaves", types::list(types::of(leaf_form), 1, 3), "its leaves"},
                          {"branches", types::map(types::of(branch_form)), "further ones"}},
                         {},
                         {{"leaves", "branches"}}};
  return form;
}

Json schema_of(const ValueType& type) { return Json::parse(schema_text("a test", type)); }

TEST(FormSchema, ClosesTheMapAndDemandsItsKeys) {
  const Json leaf = schema_of(types::of(leaf_form))["$defs"]["leaf"];
  EXPECT_EQ(leaf["additionalProperties"], false);
  EXPECT_EQ(leaf["required"], Json::array({"name"}));
  EXPECT_EQ(leaf["allOf"], Json::parse(R"([{"anyOf": [{"required": ["vein"]}, {"required": ["stem"]}]}])"));
}

TEST(FormSchema, HasTypesDefaultsAndTexts) {
  const Json keys = schema_of(types::of(leaf_form))["$defs"]["leaf"]["properties"];
  EXPECT_EQ(keys["color"],
            Json::parse(R"({"enum": ["green", "red"], "default": "green", "description": "its colour"})"));
  EXPECT_EQ(keys["length"]["default"], 1);
  EXPECT_EQ(keys["length"]["anyOf"][0], Json::parse(R"({"type": "number", "exclusiveMinimum": 0, "maximum": 2})"));
  EXPECT_THAT(keys["length"]["anyOf"][1]["pattern"].get<std::string>(), HasSubstr("(m|mm|cm)$"));
  EXPECT_FALSE(keys["vein"].contains("default"));
}

TEST(FormSchema, RefersToAFormThatContainsItself) {
  const Json branch = schema_of(types::of(branch_form))["$defs"]["branch"];
  EXPECT_EQ(branch["properties"]["branches"]["additionalProperties"]["$ref"], "#/$defs/branch");
  EXPECT_EQ(branch["properties"]["leaves"]["minItems"], 1);
  EXPECT_EQ(branch["properties"]["leaves"]["maxItems"], 3);
  EXPECT_EQ(branch["allOf"][0]["oneOf"].size(), 2u);
}

TEST(FormTable, HasARowForEachKeyWithItsValuesAndItsDefault) {
  EXPECT_EQ(table_text(leaf_form()),
            "| key | what | values | default |\n"
            "| --- | --- | --- | --- |\n"
            "| `length` | its length [m] | number above 0 and at most 2 [m], or with m, mm or cm | `1` |\n"
            "| `color` | its colour | `green` or `red` | `green` |\n"
            "| `name` | its name | text | required |\n"
            "| `vein` | it has one | `true` or `false` |  |\n"
            "| `stem` | it has one | `true` or `false` |  |\n");
  EXPECT_EQ(find_form(types::of(branch_form), "leaf"), &leaf_form());
  EXPECT_EQ(find_form(types::of(branch_form), "root"), nullptr);
}

/// A leaf while it is read.
struct Leaf {
  enum class Color { green, red };
  double length = 0.25;
  int veins = 3;
  std::optional<double> weight;
  double worth = 0.0;
  Color color = Color::red;
  std::string name;
  Eigen::Vector3d place{0.0, 0.5, 1.0};
};

const BoundForm<Leaf>& bound_leaf_form() {
  static const BoundForm<Leaf> form{
      "leaf",
      "a leaf",
      {{"length", &Leaf::length, types::quantity(length_units, {0.0, 2.0, "[m]"}), "its length [m]"},
       {"veins", &Leaf::veins, {1, 9}, "their number"},
       {"weight", &Leaf::weight, {0.0, 1.0}, "its weight"},
       {"worth", &Leaf::worth, {0.0, 1.0, "", true}, "above 0"},
       {"color",
        &Leaf::color,
        {"green or red", {{"green", Leaf::Color::green}, {"red", Leaf::Color::red}}},
        "its colour"},
       {"name", &Leaf::name, types::name(), "its name", {"a name"}},
       {"place", &Leaf::place, {-1.0, 1.0}, "its place"},
       FormKey{"stem", types::text(), "read by hand", "long"}}};
  return form;
}

TEST(BoundForm, HasTheDefaultsAndTypesOfTheMembers) {
  std::map<std::string_view, std::string> defaults;
  for (const FormKey& key : bound_leaf_form().keys) defaults[key.name] = key.fallback;
  const std::map<std::string_view, std::string> expected{
      {"length", "0.25"}, {"veins", "3"},       {"weight", ""},           {"worth", ""},
      {"color", "red"},   {"name", "required"}, {"place", "[0, 0.5, 1]"}, {"stem", "long"}};
  EXPECT_EQ(defaults, expected);
  EXPECT_EQ(bound_leaf_form().find("veins")->type.kind, ValueType::Kind::whole);
}

TEST(BoundForm, ReadsEachKeyIntoItsMember) {
  Findings findings("leaf.yaml");
  const Result<YamlNodePtr> leaf =
      parse_yaml("{name: A, length: 5 mm, weight: 0.5, color: green, veins: 12}", "leaf.yaml");
  ASSERT_TRUE(leaf);
  Leaf read;
  bound_leaf_form().read(Keys(findings, **leaf, bound_leaf_form()), read);
  EXPECT_EQ(read.name, "A");
  EXPECT_EQ(read.length, 0.005);
  EXPECT_EQ(read.weight, 0.5);
  EXPECT_EQ(read.color, Leaf::Color::green);
  EXPECT_EQ(read.veins, 3);
  ASSERT_EQ(findings.errors().size(), 1u);
  EXPECT_EQ(findings.errors()[0].message, "veins is 12");
  EXPECT_EQ(findings.errors()[0].hint, "expected a whole number from 1 to 9");
  ASSERT_NE(findings.find_default(**leaf, "place"), nullptr);
  EXPECT_EQ(*findings.find_default(**leaf, "place"), (std::vector<std::string>{"0", "0.5", "1"}));
}

TEST(BoundForm, DemandsAKeyThatHasToBeStated) {
  Findings findings("leaf.yaml");
  const Result<YamlNodePtr> leaf = parse_yaml("{veins: 2}", "leaf.yaml");
  ASSERT_TRUE(leaf);
  Leaf read;
  bound_leaf_form().read(Keys(findings, **leaf, bound_leaf_form()), read);
  ASSERT_EQ(findings.errors().size(), 1u);
  EXPECT_EQ(findings.errors()[0].message, "a leaf has no 'name'");
  EXPECT_EQ(findings.errors()[0].hint, "expected name: a name");
}

/// Calls `take` with each form inside the type, each once.
void for_each_form(const ValueType& type, std::set<const Form*>& known, const std::function<void(const Form&)>& take) {
  for (const ValueType& part : type.parts) for_each_form(part, known, take);
  if (!type.form || !known.insert(&type.form()).second) return;
  take(type.form());
  for (const FormKey& key : type.form().keys) for_each_form(key.type, known, take);
}

TEST(ScenarioForms, HaveATextForEachKeyAndEachKeyOnce) {
  std::set<const Form*> forms;
  for_each_form(types::of(scenario_form), forms, [](const Form& form) {
    std::set<std::string_view> names;
    for (const FormKey& key : form.keys) {
      EXPECT_FALSE(key.text.empty()) << form.owner << ": " << key.name;
      EXPECT_TRUE(names.insert(key.name).second) << form.owner << ": " << key.name;
    }
    for (const auto& groups : {form.needed, form.one_of})
      for (const auto& group : groups)
        for (const std::string_view key : group) EXPECT_NE(form.find(key), nullptr) << form.owner << ": " << key;
  });
  EXPECT_GT(forms.size(), 50u);
}

TEST(KeysDeathTest, EndWhenTheDefaultThatIsReadIsNotThatOfTheForm) {
  Findings findings("leaf.yaml");
  const Result<YamlNodePtr> leaf = parse_yaml("{name: A}", "leaf.yaml");
  ASSERT_TRUE(leaf);
  const Keys keys(findings, **leaf, leaf_form());
  double length = 2.0;
  EXPECT_DEATH(keys.read("length", length), "default");
  EXPECT_DEATH(keys.read("width", length), "in the form");
}

}  // namespace
}  // namespace rehearse
