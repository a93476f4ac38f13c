#include "urdf_draft.h"
#include "urdf_materials.h"
#include "urdf_meshes.h"
#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <utility>

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

constexpr const char* known_shapes = "box, sphere, cylinder, capsule or mesh";

std::optional<Geometry> read_box(const XMLElement& element, Findings& findings) {
  const auto size = read_vector(element, "size", findings);
  if (!size) return std::nullopt;
  return Box{*size};
}

std::optional<Geometry> read_sphere(const XMLElement& element, Findings& findings) {
  const auto radius = read_number(element, "radius", findings);
  if (!radius) return std::nullopt;
  return Sphere{*radius};
}

template <class Round>
std::optional<Geometry> read_round(const XMLElement& element, Findings& findings) {
  const auto radius = read_number(element, "radius", findings);
  const auto length = read_number(element, "length", findings);
  if (!radius || !length) return std::nullopt;
  return Round{*radius, *length};
}

std::optional<Geometry> read_shape(XMLElement& element, Meshes& meshes, Meshes::Use use, Findings& findings) {
  const std::string_view kind = element.Name();
  if (kind == "box") return read_box(element, findings);
  if (kind == "sphere") return read_sphere(element, findings);
  if (kind == "cylinder") return read_round<Cylinder>(element, findings);
  if (kind == "capsule") {
    const auto capsule = read_round<Capsule>(element, findings);
    element.SetName("cylinder");  // urdfdom doesn't accept a capsule; a cylinder has the same attributes
    return capsule;
  }
  if (kind == "mesh") return meshes.read(element, use);
  if (kind == "plane") {
    findings.warning(element.GetLineNum(), "a <plane> is left out",
                     "take a large <box>, or a fixed body of the scenario");
    return std::nullopt;
  }
  findings.error(element.GetLineNum(), fmt::format("unknown geometry {}", tag(kind)),
                 fmt::format("a {}", known_shapes));
  return std::nullopt;
}

/// Removes the elements of a <geometry> that aren't shapes, with a warning, if there is a shape beside them.
void keep_shapes(XMLElement& geometry, Findings& findings) {
  const auto is_shape = [](const XMLElement& element) {
    return is_one_of(element.Name(), {"box", "sphere", "cylinder", "capsule", "mesh"});
  };
  const XMLElement* shape = geometry.FirstChildElement();
  while (shape != nullptr && !is_shape(*shape)) shape = shape->NextSiblingElement();
  if (shape == nullptr) return;
  XMLElement* next = geometry.FirstChildElement();
  while (next != nullptr) {
    XMLElement* element = std::exchange(next, next->NextSiblingElement());
    if (is_shape(*element)) continue;
    findings.warning(element->GetLineNum(),
                     fmt::format("{} in a <geometry> isn't a shape; it is left out", tag(element->Name())));
    geometry.DeleteChild(element);
  }
}

/// The smallest dimension of a shape [m].
double smallest(const Geometry& geometry) {
  struct Measure {
    double operator()(const Box& box) const { return box.size.minCoeff(); }
    double operator()(const Sphere& sphere) const { return sphere.radius; }
    double operator()(const Cylinder& cylinder) const { return std::min(cylinder.radius, cylinder.length); }
    double operator()(const Capsule& capsule) const { return capsule.length < 0.0 ? capsule.length : capsule.radius; }
    double operator()(const Mesh&) const { return unlimited; }
  };
  return std::visit(Measure{}, geometry);
}

bool has_name(const XMLElement& element) {
  const char* name = element.Attribute("name");
  return name != nullptr && *name != '\0';
}

/// Removes a shape, and its <visual> or <collision> if it was the only one.
void leave_out(XMLElement& shape, XMLElement& element) {
  XMLElement* geometry = shape.Parent()->ToElement();
  geometry->DeleteChild(&shape);
  if (geometry->FirstChildElement() == nullptr) element.Parent()->DeleteChild(&element);
}

/// Reads a shape of a <visual> or <collision>. One that is left out, with a warning, is removed from the document, too.
std::optional<Geometry> read_geometry(XMLElement& shape, XMLElement& element, Meshes& meshes, Meshes::Use use,
                                      Findings& findings) {
  const int errors = findings.error_count();
  const std::optional<Geometry> geometry = read_shape(shape, meshes, use, findings);
  if (!geometry) {
    if (findings.error_count() == errors) leave_out(shape, element);
    return std::nullopt;
  }
  if (smallest(*geometry) < 0.0) {
    findings.error(element.GetLineNum(), fmt::format("<{}> has a shape of negative size", element.Name()));
    return std::nullopt;
  }
  if (smallest(*geometry) == 0.0) {
    findings.warning(element.GetLineNum(), fmt::format("<{}> has a shape of size 0; it is left out", element.Name()));
    leave_out(shape, element);
    return std::nullopt;
  }
  return geometry;
}

/// urdfdom reads one shape of a <geometry>: each further one gets a <visual> or <collision> of its own.
void separate_shapes(XMLElement& element) {
  XMLElement* geometry = element.FirstChildElement("geometry");
  XMLElement* last = &element;
  while (XMLElement* shape = geometry->FirstChildElement()->NextSiblingElement()) {
    XMLElement* copy = element.DeepClone(element.GetDocument())->ToElement();
    copy->FirstChildElement("geometry")->DeleteChildren();
    copy->FirstChildElement("geometry")->InsertEndChild(shape);
    last = element.Parent()->InsertAfterChild(last, copy)->ToElement();
  }
}

/// Warns of a texture that no part of the shape shows.
void check_texture(const Shape& shape, const XMLElement& element, Findings& findings) {
  if (!shape.texture) return;
  const auto* mesh = std::get_if<Mesh>(&shape.geometry);
  const bool is_shown = mesh && mesh->data && std::ranges::any_of(mesh->data->parts, [](const MeshPart& part) {
                          return !part.texture && !part.texture_coordinates.empty();
                        });
  if (is_shown) return;
  findings.warning(element.GetLineNum(),
                   fmt::format("the <texture> {} isn't drawn on this shape", in_quotes(shape.texture->file)),
                   "a mesh with texture coordinates and without a texture of its own shows it");
}

/// Reads the shapes of a <visual> or <collision>.
void read_element(XMLElement& element, const Materials* materials, Meshes& meshes, std::vector<Shape>& shapes,
                  Findings& findings) {
  const Meshes::Use use = materials != nullptr ? Meshes::Use::visual : Meshes::Use::collision;
  Shape common;
  common.pose = read_origin(element, findings);
  XMLElement* geometry = element.FirstChildElement("geometry");
  if (geometry != nullptr) keep_shapes(*geometry, findings);
  XMLElement* next = geometry == nullptr ? nullptr : geometry->FirstChildElement();
  if (next == nullptr) {
    findings.warning((geometry == nullptr ? element : *geometry).GetLineNum(),
                     fmt::format("<{}> has no shape; it is left out", element.Name()),
                     fmt::format("<geometry> with a {}", known_shapes));
    element.Parent()->DeleteChild(&element);
    return;
  }
  if (const XMLElement* second = next->NextSiblingElement()) {
    findings.repair(second->GetLineNum(), "a second shape in one <geometry>; each is taken",
                    fmt::format("one <{}> for each shape", element.Name()));
  }
  if (has_name(element)) common.name = read_name(element, "name", findings).value_or("");
  if (materials != nullptr) {
    const Appearance appearance = materials->of(element);
    common.color = appearance.color;
    common.texture = appearance.texture;
  }
  const std::size_t before = shapes.size();
  while (next != nullptr) {
    XMLElement* shape = std::exchange(next, next->NextSiblingElement());
    if (const auto read = read_geometry(*shape, element, meshes, use, findings)) {
      shapes.push_back(common);
      shapes.back().geometry = *read;
      check_texture(shapes.back(), element, findings);
    }
  }
  if (shapes.size() > before + 1) separate_shapes(element);
}

/// Reads all shapes of one kind.
std::vector<Shape> read_shapes(XMLElement& link, const char* kind, const Materials* materials, Meshes& meshes,
                               Findings& findings) {
  std::vector<Shape> shapes;
  XMLElement* next = link.FirstChildElement(kind);
  while (next != nullptr) {
    XMLElement* element = std::exchange(next, next->NextSiblingElement(kind));
    read_element(*element, materials, meshes, shapes, findings);
  }
  return shapes;
}

/// The inertia tensor about the centre, along the axes of the inertial frame.
std::optional<Eigen::Matrix3d> read_tensor(const XMLElement& element, Findings& findings) {
  std::array<double, 6> moments{};
  std::size_t read = 0;
  for (const char* name : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}) {
    const auto value = read_number(element, name, findings);
    if (!value) return std::nullopt;
    moments[read++] = *value;
  }
  const auto [xx, xy, xz, yy, yz, zz] = moments;
  return (Eigen::Matrix3d() << xx, xy, xz, xy, yy, yz, xz, yz, zz).finished();
}

/// The <inertia>, complete for urdfdom: where there is none, one of zeros is added to the document, and products of
/// inertia that it doesn't state are 0.
const XMLElement& complete_inertia(XMLElement& inertial, const std::string& link, Findings& findings) {
  XMLElement* inertia = inertial.FirstChildElement("inertia");
  if (inertia == nullptr) {
    inertia = inertial.InsertNewChildElement("inertia");
    for (const char* name : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}) inertia->SetAttribute(name, "0");
  }
  bool lacks_product = false;
  for (const char* name : {"ixy", "ixz", "iyz"}) {
    if (inertia->Attribute(name) != nullptr) continue;
    lacks_product = true;
    inertia->SetAttribute(name, "0");
  }
  if (lacks_product)
    findings.repair(inertia->GetLineNum(),
                    fmt::format("the inertia of link {} lacks products; they are taken for 0", in_quotes(link)));
  return *inertia;
}

/// Returns false if the <inertial> can't be read.
bool read_inertial(XMLElement& element, LinkDraft& draft, Findings& findings) {
  const XMLElement* mass = element.FirstChildElement("mass");
  if (mass == nullptr) {
    findings.error(element.GetLineNum(), fmt::format("<inertial> of link {} has no <mass>", in_quotes(draft.link.name)),
                   "an <inertial> has <mass value> and <inertia ixx ixy ixz iyy iyz izz>");
    return false;
  }
  const Eigen::Isometry3d frame = read_origin(element, findings);
  const auto kilograms = read_number(*mass, "value", findings);
  const auto tensor = read_tensor(complete_inertia(element, draft.link.name, findings), findings);
  if (!kilograms || !tensor) return false;
  if (*kilograms < 0.0) {
    findings.error(mass->GetLineNum(), fmt::format("link {} has negative mass", in_quotes(draft.link.name)));
    return false;
  }
  draft.has_inertial = true;
  draft.link.inertial.mass = *kilograms;
  draft.link.inertial.center = frame.translation();
  const Eigen::Matrix3d turned = frame.linear() * *tensor * frame.linear().transpose();
  draft.link.inertial.inertia = (turned + turned.transpose()) / 2.0;  // symmetric to the last bit
  return true;
}

}  // namespace

std::optional<LinkDraft> read_link(XMLElement& element, const Materials& materials, Meshes& meshes,
                                   Findings& findings) {
  LinkDraft draft;
  draft.link.line = element.GetLineNum();
  const auto name = read_name(element, "name", findings);
  if (name) draft.link.name = *name;
  if (XMLElement* inertial = element.FirstChildElement("inertial")) {
    draft.has_broken_inertial = !read_inertial(*inertial, draft, findings);
  }
  draft.link.visuals = read_shapes(element, "visual", &materials, meshes, findings);
  draft.link.collisions = read_shapes(element, "collision", nullptr, meshes, findings);
  for (const auto* contact = element.FirstChildElement("contact"); contact != nullptr;
       contact = contact->NextSiblingElement("contact")) {
    read_contact(*contact, draft.link.surface, findings);
  }
  if (!name) return std::nullopt;
  return draft;
}

}  // namespace rehearse::urdf
