#include "src/config/case.hpp"
#include "src/config/changes.hpp"
#include "src/config/cloths.hpp"
#include "src/config/fabrics.hpp"
#include "src/config/units.hpp"

#include <filesystem>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <sstream>

using namespace taut;
using config::Field;
using config::LinearSolver;

namespace {

const std::string file = "cases/x/case.yaml";
const std::string grid = "cloth: {grid: {size: [1, 1], vertices: [3, 3]}}\n";

Case read(const std::string& text, const std::vector<Override>& overrides = {}) {
  return read_case(text, file, overrides);
}

/// The message that reading `text` ends with.
std::string error(const std::string& text, const std::vector<Override>& overrides = {}) {
  try {
    read(text, overrides);
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

/// The message for `rest` that follows a valid cloth on line 1.
std::string error_after_cloth(const std::string& rest) { return error(grid + rest); }

std::string at(const std::string& place, const std::string& message) {
  return file + ":" + place + ": " + message;
}

const std::string everything = R"(
name: full
cloth:
  mesh: meshes/shirt one.obj
  scale: 0.001
  start:
    shape: start.obj
    rotate: {axis: [0, 1, 1], angle: 90 deg}
    translate: [10 cm, 0, 1e-3]
  fabric: denim
  material: {bending: 30 uN m, damping: {mass: 0.1 Hz, stiffness: 2 ms}}
pins:
  - vertices: [0, 4, 12345678901]
    release: 0.1
  - box: {min: [-1, -1, -1], max: [1, 1, 0.30000000000000004]}
    motion:
      - {time: 0}
      - {time: 1, translate: [0, 0, 0.1], rotate: {axis: [0, 0, 1], angle: 1 rad, centre: [0.5, 0, 0]}}
  - near: [[0, 0, 0], [1 m, 0, 0]]
gravity: [0, 0, -1.62]
air: {wind: [20 km/h, 0, 0], drag: 0.5, gust: {speed: 1, length: 2, period: 3}}
time: {end: 2 min, frame_rate: 25 Hz, max_step: 3 ms, min_step: 1 us}
velocity: {solver: mumps, tolerance: 1e-8, max_iterations: 7}
inextensibility: {method: icd, strain: 1 %, solver: mumps, max_iterations: 3, carried_tension: false, compliance: 0.1}
partition: {method: stripes}
output: {fields: [tension, position]}
)";

} // namespace

TEST(Config, DefaultsAreThoseOfTheStructs) {
  const Case input = read(grid);
  Case expected;
  expected.name = std::string("x");
  expected.file = "cases/x/case.yaml";
  expected.cloths[0].grid = config::Grid{.size = {1, 1}, .vertices = {3, 3}};
  expected.inextensibility.method = config::InextensibilityMethod::newton;
  EXPECT_EQ(input, expected);
}

TEST(Config, MethodsAreNewtonsUnlessTheCaseAsksForMore) {
  using enum config::InextensibilityMethod;
  const auto method_of = [](const std::string& keys) { return read(grid + keys).inextensibility.method; };
  EXPECT_EQ(method_of("obstacles: [{sphere: {centre: [0, 0, -1], radius: 0.5}}]"), fast_projection);
  EXPECT_EQ(method_of("contact: {}"), fast_projection);
  EXPECT_EQ(method_of("contact: {model: impulse}"), fast_projection);
  EXPECT_EQ(method_of("obstacles: []"), newton);
  const std::string garment = "cloth: {pattern: shirt.json, edge: 0.01}\ncontact: {}\n";
  EXPECT_EQ(read(garment + "time: {end: 5}").inextensibility.method, fast_projection);
  EXPECT_EQ(read(garment + "time: {end: 5, until_rest: 0.01}").inextensibility.method, newton);
  const std::string two = "cloths: [{grid: {size: [1, 1], vertices: [3, 3]}}, {pattern: shirt.json, edge: "
                          "0.01}]\ncontact: {}\n";
  EXPECT_EQ(read(two + "time: {end: 5}").inextensibility.method, fast_projection);
  EXPECT_EQ(read(two + "time: {end: 5, until_rest: 0.01}").inextensibility.method, newton);
  EXPECT_EQ(method_of("contact: {model: none}\nobstacles: [{sphere: {centre: [0, 0, -1], radius: 0.5}}]"),
            newton);
  EXPECT_EQ(method_of("contact: {}\ninextensibility: {method: newton}"), newton);
  EXPECT_EQ(method_of("inextensibility: {method: icd}"), icd);
  EXPECT_EQ(method_of("inextensibility: {solver: mumps}"), fast_projection);
  EXPECT_EQ(method_of("inextensibility: {faces: 3}"), fast_projection);
  EXPECT_EQ(method_of("velocity: {tolerance: 1e-6}"), fast_projection);
}

TEST(Config, NameComesFromTheFolder) {
  EXPECT_EQ(read_case(grid, "cases/drape/case.yaml").name, "drape");
  EXPECT_EQ(read_case(grid, "drape.yaml").name, "drape");
  EXPECT_EQ(read_case(grid, "./drape.yaml").name, "drape");
  EXPECT_EQ(read_case(grid + "name: other", "cases/drape/case.yaml").name, "other");
  const std::string here = std::filesystem::current_path().filename().string();
  EXPECT_EQ(read_case(grid, "case.yaml").name, here);
  EXPECT_EQ(read_case(grid, "./case.yaml").name, here);
  EXPECT_EQ(read_case(grid, "drape/../case.yaml").name, here);
  EXPECT_EQ(read_case(grid, "cases/./drape//case.yaml").name, "drape");
  EXPECT_EQ(read_case(grid, "/case.yaml").name, "case");
  EXPECT_NO_THROW(read_case(grid + "name: other", ""));
}

TEST(Config, ReadsEveryKey) {
  const Case c = read(everything);
  EXPECT_EQ(c.cloths[0].mesh, "meshes/shirt one.obj");
  EXPECT_EQ(c.cloths[0].start.shape, "start.obj");
  EXPECT_EQ(c.cloths[0].start.rotate.angle, std::numbers::pi / 2);
  EXPECT_EQ(c.cloths[0].start.translate, Vec3(0.1, 0, 1e-3));
  EXPECT_EQ(c.cloths[0].material.damping.mass, 0.1);
  EXPECT_EQ(c.cloths[0].material.damping.stiffness, 0.002);
  ASSERT_EQ(c.pins.size(), 3u);
  EXPECT_EQ(c.pins[0].vertices, (std::vector<Global>{0, 4, 12345678901}));
  EXPECT_EQ(c.pins[0].release, 0.1);
  EXPECT_EQ(c.pins[1].box->max, Vec3(1, 1, 0.30000000000000004));
  ASSERT_EQ(c.pins[1].motion.size(), 2u);
  EXPECT_EQ(c.pins[1].motion[1].rotate.centre, Vec3(0.5, 0, 0));
  EXPECT_EQ(c.pins[2].near->at(1), Vec3(1, 0, 0));
  EXPECT_EQ(c.gravity.at(0), Vec3(0, 0, -1.62));
  EXPECT_DOUBLE_EQ(c.air->wind.x(), 20 / 3.6);
  EXPECT_EQ(c.air->gust, (config::Gust{1, 2, 3}));
  EXPECT_EQ(c.time, (config::Time{.end = 120, .frame_rate = 25, .max_step = 0.003, .min_step = 1e-6}));
  EXPECT_EQ(c.velocity, (config::Velocity{LinearSolver::mumps, 1e-8, 7}));
  EXPECT_EQ(c.inextensibility.strain, 0.01);
  EXPECT_FALSE(c.inextensibility.carried_tension);
  EXPECT_EQ(c.partition.method, config::PartitionMethod::stripes);
  EXPECT_EQ(c.output.fields, (std::vector<Field>{Field::tension, Field::position}));
}

TEST(Config, GravityIsAVectorOrKeyframes) {
  const Case c = read(grid + "gravity: [{time: 1, value: [0, 0, -9]}, {time: 3, value: [0, 0, 9]}]");
  EXPECT_EQ(c.gravity.at(0), Vec3(0, 0, -9));
  EXPECT_EQ(c.gravity.at(1.5), Vec3(0, 0, -4.5));
  EXPECT_EQ(c.gravity.at(4), Vec3(0, 0, 9));
  EXPECT_EQ(c.gravity.largest(), 9);
  EXPECT_EQ(read_case(write_case(c), "case.yaml").gravity, c.gravity);
  const Case single = read(grid + "gravity: [{time: 1, value: [0, 0, -9]}]");
  EXPECT_EQ(read(write_case(single)).gravity, single.gravity);
  EXPECT_EQ(error(grid + "gravity: [{time: 1, value: [0, 0, 1]}, {time: 1, value: [0, 0, 2]}]"),
            at("2:10", "gravity: times must increase from keyframe to keyframe; sort them"));
  EXPECT_THAT(error(grid + "gravity: [{time: 1}]"), testing::HasSubstr("gravity.0: missing key 'value'"));
}

TEST(Config, Quantities) {
  const auto end = [](const std::string& text) { return read(grid + "time: {end: " + text + "}").time.end; };
  EXPECT_EQ(end("250ms"), 0.25);
  EXPECT_EQ(end("'  2  s '"), 2);
  EXPECT_EQ(end("+1.5e1"), 15);
  const Case line = read("cloth: {line: {length: 50 cm, vertices: 9}, material: {density: 3 g/m}}");
  EXPECT_EQ(line.cloths[0].line, (config::Line{0.5, 9}));
  EXPECT_EQ(line.cloths[0].material.density, 0.003);
}

TEST(Config, SeveralCloths) {
  const std::string two = "cloths:\n"
                          "  - {name: shirt, mesh: shirt.obj, fabric: denim, thickness: 2 mm}\n"
                          "  - {line: {length: 1, vertices: 3}, material: {bending: 0}}\n"
                          "pins: [{cloth: shirt, vertices: [0]}, {cloth: 1, range: [0, 1]}]\n";
  const Case c = read(two);
  ASSERT_EQ(c.cloths.size(), 2u);
  EXPECT_EQ(c.cloths[0].name, "shirt");
  EXPECT_EQ(c.cloths[0].thickness, 0.002);
  EXPECT_EQ(c.cloths[0].material.density, config::find_fabric("denim")->density);
  EXPECT_EQ(c.cloths[1].material.density, config::Material{}.density);
  EXPECT_EQ(config::find_cloth(c, *c.pins[0].cloth), 0u);
  EXPECT_EQ(config::find_cloth(c, *c.pins[1].cloth), 1u);
  EXPECT_EQ(read(two, {{"cloths.1.material.bending", "3e-5"}}).cloths[1].material.bending, 3e-5);
  EXPECT_EQ(read_case(write_case(c), file), c);
  // one is one, however it is written
  const Case one = read("cloths: [{grid: {size: [1, 1], vertices: [3, 3]}}]");
  EXPECT_EQ(one, read(grid));
  EXPECT_THAT(write_case(one), testing::HasSubstr("cloth:\n"));
}

TEST(Config, FabricFillsTheMaterialAndItsKeysWin) {
  const config::Fabric& denim = *config::find_fabric("denim");
  const std::string cloth = "cloth: {grid: {size: [1, 1], vertices: [3, 3]}, ";
  const Case plain = read(cloth + "fabric: denim}");
  EXPECT_EQ(plain.cloths[0].fabric, "denim");
  EXPECT_EQ(plain.cloths[0].material.density, denim.density);
  EXPECT_EQ(plain.cloths[0].material.bending, denim.bending);
  EXPECT_EQ(plain.cloths[0].material.shear, denim.shear);
  // The material may stand before the fabric.
  const Case mixed = read(cloth + "material: {density: 100 g/m^2}, fabric: denim}");
  EXPECT_EQ(mixed.cloths[0].material.density, 0.1);
  EXPECT_EQ(mixed.cloths[0].material.bending, denim.bending);
  EXPECT_EQ(read(grid, {{"cloth.fabric", "silk"}}).cloths[0].material.density, 0.083);
}

TEST(Config, FabricsAreCloth) {
  std::set<std::string_view> names;
  for (const config::Fabric& f : config::fabrics()) {
    EXPECT_TRUE(names.insert(f.name).second) << f.name;
    EXPECT_TRUE(f.density > 0.01 && f.density < 1) << f.name;
    EXPECT_TRUE(f.bending > 1e-7 && f.bending < 1e-3) << f.name;
    EXPECT_TRUE(f.shear > 1 && f.shear < 1000) << f.name;
    EXPECT_FALSE(f.source.empty()) << f.name;
  }
  EXPECT_NEAR(config::find_fabric("cotton")->density, 0.1503, 1e-6);
  EXPECT_NEAR(config::find_fabric("denim")->bending, 78.18e-6, 0.01e-6);
}

// The numbers themselves are compared by scripts/validate cusick.
TEST(Config, FabricsDrapeAsIsPublished) {
  for (const config::Fabric& f : config::fabrics()) {
    if (f.published.source.empty()) continue;
    EXPECT_EQ(config::verdict(f), "drapes as published") << f.name;
    EXPECT_NE(config::fabric_table().find(fmt::format("| `{}` |", f.name)), std::string::npos);
  }
  config::Fabric limp = *config::find_fabric("denim");
  limp.drape = limp.published.low - 1;
  EXPECT_EQ(config::verdict(limp), "drapes otherwise");
}

// As sheets of ASTM D1388 and of the Kawabata evaluation system give them.
TEST(Config, UnitsOfFabricSheetsAreRead) {
  const auto material = [](const std::string& keys) {
    return read("cloth: {grid: {size: [40 in, 1], vertices: [2, 2]}, material: {" + keys + "}}").cloths[0];
  };
  EXPECT_DOUBLE_EQ(material("density: 120 gsm").grid->size[0], 1.016);
  for (const char* density : {"120 gsm", "120 g/m2", "120 g/m^2"})
    EXPECT_DOUBLE_EQ(material(fmt::format("density: {}", density)).material.density, 0.12) << density;
  for (const char* bending : {"9 uN m", "9 \u00b5N m", "9 \u03bcN m", "9 mN mm", "0.009 mN m"})
    EXPECT_DOUBLE_EQ(material(fmt::format("bending: {}", bending)).material.bending, 9e-6) << bending;
  for (const char* bending : {"0.1 gf cm^2/cm", "0.1 gf cm2/cm"})
    EXPECT_DOUBLE_EQ(material(fmt::format("bending: {}", bending)).material.bending, 9.80665e-6) << bending;
  EXPECT_NEAR(material("shear: 1 gf/(cm deg)").material.shear, 56.188, 1e-3);
}

// Writing.

TEST(Config, RoundTrip) {
  for (const std::string& text : {grid, everything}) {
    const Case once = read(text);
    const std::string written = write_case(once);
    EXPECT_EQ(read(written), once) << written;
    EXPECT_EQ(write_case(read(written)), written);
  }
}

TEST(Config, RoundTripOfNumbersAndNames) {
  Case c = read(grid);
  c.name = "no: #'yes' \"null\" ~ \xc3\xa4";
  c.time.end = 0.1 + 0.2;
  c.air.emplace();
  c.air->wind = Vec3(-0.0, 5e-324, -1.7976931348623157e308);
  EXPECT_EQ(read(write_case(c)), c);
  EXPECT_NE(write_case(c).find("end: 0.30000000000000004"), std::string::npos);
  EXPECT_NE(write_case(c).find("max_step: 0.01 "), std::string::npos);
  for (const std::string name : {"null", "~", "true", "12", "- a", "a: b", "[", " x "}) {
    c.name = name;
    EXPECT_EQ(read(write_case(c)).name, name);
  }
}

// Texts that would not be read again as they were are refused; the others are.
TEST(Config, RoundTripOfBytes) {
  const auto is_control = [](int byte) { return byte < 0x20 || byte == 0x7f; };
  for (int byte = 1; byte < 0x80; ++byte)
    for (const std::string around : {"", "a", " ", "\n", "\xc3\xa4"}) {
      Case c = read(grid);
      c.name = around + static_cast<char>(byte) + around;
      if (c.name == "." || byte == '/') continue;
      if (is_control(byte) && byte != '\t' && byte != '\n')
        EXPECT_ANY_THROW(read(write_case(c))) << byte;
      else
        EXPECT_EQ(read(write_case(c)).name, c.name) << byte;
    }
  const std::string refusal = "not text: there are bytes here that are no printable UTF-8; remove them";
  EXPECT_EQ(error(grid + "name: a\xff"), at("2:7", refusal));
  EXPECT_EQ(error(grid + "name: \"\\r\""), at("2:7", refusal));
  EXPECT_EQ(error(grid + "\xc3(: 1"), at("2:1", refusal));
}

// Schema and table.

namespace {

using Json = nlohmann::json;

/// Every key of the YAML-like `value` stands in `schema`.
void expect_described(const Json& schema, const std::string& yaml) {
  std::vector<std::pair<std::size_t, const Json*>> open{{0, &schema}}; // indent, schema of that block
  std::istringstream lines(yaml);
  for (std::string line; std::getline(lines, line);) {
    const bool item = line.find("- ") != std::string::npos;
    const std::size_t indent = line.find_first_not_of(" -");
    const std::string key = line.substr(indent, line.find(':') - indent);
    while (open.back().first > indent) open.pop_back();
    if (open.back().first < indent || (item && open.size() > 1 && open.back().first < indent)) FAIL() << line;
    const Json& properties = open.back().second->at("properties");
    ASSERT_TRUE(properties.contains(key)) << line;
    const Json& found = properties.at(key);
    ASSERT_FALSE(found.at("description").get<std::string>().empty());
    if (found.contains("properties"))
      open.emplace_back(indent + 2, &found);
    else if (found.contains("items") && found["items"].contains("properties") && line.find("[]") == line.npos)
      open.emplace_back(indent + 4, &found["items"]);
  }
}

} // namespace

TEST(Config, SchemaDescribesEveryKeyWritten) {
  const Json schema = Json::parse(case_schema());
  EXPECT_EQ(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
  expect_described(schema, write_case(read(everything)));
  Case c = read(grid);
  c.air.emplace();
  expect_described(schema, write_case(c));
}

TEST(Config, SchemaSaysWhatIsAllowed) {
  const Json schema = Json::parse(case_schema());
  EXPECT_EQ(schema["additionalProperties"], false);
  EXPECT_EQ(schema["oneOf"], Json::parse(R"([{"required": ["cloth"]}, {"required": ["cloths"]}])"));
  EXPECT_EQ(schema["properties"]["cloths"]["items"], Json::parse(R"({"$ref": "#/properties/cloth"})"));
  const Json& step = schema["properties"]["time"]["properties"]["max_step"];
  EXPECT_EQ(step, Json::parse(R"({"description": "longest time step", "type": ["number", "string"],
                                 "exclusiveMinimum": 0, "x-unit": "s", "default": 0.01})"));
  const Json& cloth = schema["properties"]["cloth"];
  EXPECT_EQ(cloth["oneOf"].size(), 4u);
  EXPECT_EQ(cloth["additionalProperties"], false);
  EXPECT_EQ(cloth["properties"]["grid"]["required"], Json({"size", "vertices"}));
  EXPECT_EQ(cloth["properties"]["fabric"]["enum"], Json(config::fabric_names()));
  EXPECT_EQ(schema["properties"]["velocity"]["properties"]["solver"]["enum"], Json({"cg", "mumps"}));
  const Json& tolerance = schema["properties"]["velocity"]["properties"]["tolerance"];
  EXPECT_EQ(tolerance["exclusiveMaximum"], 1);
}

TEST(Config, Table) {
  const std::string table = case_table();
  for (const std::string row :
       {"| `time.max_step` | number > 0 | s | `0.01` | longest time step |",
        "| `cloth.grid.vertices` | 2 integers >= 2 |  | required |",
        "| `pins[].vertices` | list of integers >= 0 |  | exactly one of these |",
        "| `pins[].near` | list of 3 numbers | m |",
        "| `pins[].motion[].time` | number >= 0 | s | required |",
        "| `gravity` | 3 numbers, or list of blocks | m/s^2 | `[0,0,-9.81]` |",
        "| `velocity.solver` | `cg`, `mumps` |  | `\"cg\"` |", "| `air` | block |  | vacuum |"})
    EXPECT_NE(table.find(row), std::string::npos) << row << "\n" << table;
}

// Errors.

TEST(ConfigError, UnknownKey) {
  EXPECT_EQ(error_after_cloth("gravty: [0, 0, 0]"),
            at("2:1", "unknown key 'gravty' (did you mean 'gravity'?)"));
  EXPECT_EQ(error_after_cloth("time:\n  ned: 1"), at("3:3", "unknown key 'ned' (did you mean 'end'?)"));
  EXPECT_EQ(error_after_cloth("air: {colour: red}"),
            at("2:7", "unknown key 'colour' (known here: wind, density, drag, gust)"));
  // A misspelt key is named before the one that it leaves missing.
  EXPECT_EQ(error("cloth: {line: {lenght: 1, vertices: 3}}"),
            at("1:16", "unknown key 'lenght' (did you mean 'length'?)"));
}

TEST(ConfigError, WrongUnit) {
  EXPECT_EQ(error_after_cloth("time: {max_step: 5 mm}"),
            at("2:18",
               "time.max_step: 'mm' is not a unit of time; write seconds as a number, or e.g. '10 ms' "
               "(units: s, ms, us, min)"));
  EXPECT_EQ(
      error_after_cloth("velocity: {tolerance: 1 s}"),
      at("2:23",
         "velocity.tolerance: 's' is not a unit of a ratio; write it as a number, or e.g. '1 %' (units: %)"));
}

TEST(ConfigError, WrongType) {
  EXPECT_EQ(error_after_cloth("time: {end: [1]}"),
            at("2:13", "time.end: expected a number in seconds, or e.g. '10 ms', found a list of 1"));
  EXPECT_EQ(error_after_cloth("time: {end: soon}"),
            at("2:13", "time.end: expected a number in seconds, or e.g. '10 ms', found 'soon'"));
  EXPECT_EQ(error_after_cloth("time: {end: }"),
            at("2:8", "time.end: expected a number in seconds, or e.g. '10 ms', found nothing"));
  EXPECT_EQ(error_after_cloth("velocity: {tolerance: small}"),
            at("2:23", "velocity.tolerance: expected a number, e.g. 0.5, found 'small'"));
  EXPECT_EQ(error_after_cloth("velocity: {max_iterations: 2.5}"),
            at("2:28", "velocity.max_iterations: expected a whole number, e.g. 10, found '2.5'"));
  EXPECT_EQ(error_after_cloth("inextensibility: {carried_tension: yes}"),
            at("2:36", "inextensibility.carried_tension: expected true or false, found 'yes'"));
  EXPECT_EQ(error_after_cloth("gravity: -9.81"),
            at("2:10", "gravity: expected a list of 3 numbers, e.g. [0, 0, 1], found '-9.81'"));
  EXPECT_EQ(error_after_cloth("gravity: [0, -9.81]"),
            at("2:10", "gravity: expected a list of 3 numbers, e.g. [0, 0, 1], found a list of 2"));
  EXPECT_EQ(error_after_cloth("name: [a]"), at("2:7", "name: expected a text, found a list of 1"));
  EXPECT_EQ(error("cloth: {mesh: {}}"),
            at("1:15", "cloth.mesh: expected the path of a file, e.g. shirt.obj, found a block of keys"));
  EXPECT_EQ(error_after_cloth("pins: {near: [[0, 0, 0]]}"),
            at("2:7", "pins: expected a list in [ ], or lines that begin with '- ', found a block of keys"));
  EXPECT_EQ(error_after_cloth("partition: metis"),
            at("2:12", "partition: expected a block of keys (method), found 'metis'"));
  EXPECT_EQ(error_after_cloth("air:\ntime: {}"),
            at("2:1", "air: expected a block of keys, found nothing; write {} for its defaults"));
  EXPECT_EQ(error_after_cloth("velocity: {solver: [cg]}"),
            at("2:20", "velocity.solver: expected one of cg, mumps, found a list of 1"));
}

TEST(ConfigError, OutOfRange) {
  EXPECT_EQ(error_after_cloth("time: {end: -1 s}"),
            at("2:13", "time.end: -1 s is out of range; it must be above 0"));
  EXPECT_EQ(error_after_cloth("velocity: {tolerance: 1}"),
            at("2:23", "velocity.tolerance: 1 is out of range; it must be above 0 and below 1"));
  EXPECT_EQ(error("cloth: {grid: {size: [1, 0], vertices: [3, 3]}}"),
            at("1:26", "cloth.grid.size.1: 0 is out of range; it must be above 0"));
  EXPECT_EQ(error("cloth: {grid: {size: [1, 1], vertices: [3, 1]}}"),
            at("1:44", "cloth.grid.vertices.1: 1 is out of range; it must be at least 2"));
  EXPECT_EQ(error_after_cloth("pins:\n  - vertices: [0, -1]"),
            at("3:19", "pins.0.vertices.1: -1 is out of range; it must be at least 0"));
  EXPECT_EQ(error_after_cloth("velocity: {max_iterations: 3000000000}"),
            at("2:28", "velocity.max_iterations: 3000000000 is out of range; it must be at most 2147483647"));
}

TEST(ConfigError, NotFinite) {
  for (const std::string word : {".inf", "-.inf", ".nan", ".NaN", "nan", "inf", "-Infinity"})
    EXPECT_EQ(error_after_cloth("time: {end: " + word + "}"),
              at("2:13", "time.end: " + word + " is not a finite number; write a finite one"));
  EXPECT_EQ(error_after_cloth("time: {end: 1e400}"),
            at("2:13", "time.end: 1e400 is beyond what a number can hold (about 1e-308 to 1e308)"));
  EXPECT_EQ(error_after_cloth("time: {end: 1e308 min}"),
            at("2:13", "time.end: 1e308 min is not a finite number; write a finite one"));
  EXPECT_EQ(error_after_cloth("time: {end: infinite}"),
            at("2:13", "time.end: expected a number in seconds, or e.g. '10 ms', found 'infinite'"));
}

TEST(ConfigError, UnknownWord) {
  EXPECT_EQ(
      error_after_cloth("velocity: {solver: mump}"),
      at("2:20", "velocity.solver: unknown word 'mump' (did you mean 'mumps'?); choose one of cg, mumps"));
  EXPECT_EQ(error_after_cloth("partition: {method: random}"),
            at("2:21", "partition.method: unknown word 'random'; choose one of metis, ptscotch, stripes"));
  EXPECT_EQ(error_after_cloth("output: {fields: [strain, tensoin]}"),
            at("2:27", "output.fields.1: unknown word 'tensoin' (did you mean 'tension'?); choose one of "
                       "position, velocity, owner_rank, strain, tension, reaction, contact, yarn"));
  EXPECT_EQ(error("cloth: {line: {length: 1, vertices: 2}, fabric: denin}"),
            at("1:49",
               "cloth.fabric: unknown word 'denin' (did you mean 'denim'?); choose one of silk, habotai, "
               "crepe, cotton, poplin, wool, tropical, flannel, denim, canvas, flag, polyester, polycotton, "
               "interlock, ponte"));
}

TEST(ConfigError, NotYaml) {
  EXPECT_EQ(error("cloth: [1, 2\n"), at("2:1", "not YAML: end of sequence flow not found; check indentation, "
                                               "colons, brackets and quotes here"));
  EXPECT_EQ(error("a: b: c\n"),
            at("1:5", "not YAML: illegal map value; check indentation, colons, brackets and quotes here"));
  EXPECT_EQ(error("? [a]\n: 1\n"), at("1:3", "a key must be a word"));
  EXPECT_EQ(error("a: &x [*x]\n"), at("1:4", "nested too deep; a few levels are enough"));
  EXPECT_EQ(error(grid + "---\n" + grid),
            at("3:1", "a second document starts here; a file holds only one, so check --- and brackets"));
}

// yaml-cpp by itself finds documents without end behind the first.
TEST(ConfigError, ContentBehindTheDocument) {
  EXPECT_EQ(error("# a comma that is nowhere\n  , y: 1\n"),
            at("2:3", "a second document starts here; a file holds only one, so check --- and brackets"));
}

TEST(ConfigError, AliasesThatMultiply) {
  std::string text = "a: &a [1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (char c = 'b'; c < 'i'; ++c)
    text += fmt::format("{0}: &{0} [*{1}, *{1}, *{1}, *{1}, *{1}, *{1}, *{1}, *{1}]\n", c, char(c - 1));
  EXPECT_THAT(error(text), testing::HasSubstr("aliases (*) stand for too many values; write them out"));
}

TEST(ConfigError, EmptyOrNotAMap) {
  const std::string empty = at("1:1", "the case is empty; give at least 'cloth'");
  EXPECT_EQ(error(""), empty);
  EXPECT_EQ(error("# only this\n"), empty);
  EXPECT_EQ(error("- a\n"), at("1:1", "expected keys such as 'cloth:', found a list of 1"));
  EXPECT_EQ(error("hello"), at("1:1", "expected keys such as 'cloth:', found 'hello'"));
}

TEST(ConfigError, Cloths) {
  EXPECT_EQ(error("cloth: {line: {length: 1, vertices: 3}}\ncloths: []\n"),
            at("2:1", "cloths and cloth exclude each other; keep one"));
  EXPECT_EQ(error("cloths: []\n"), at("1:9", "cloths: must not be empty; give at least one cloth"));
  const std::string two = "cloths:\n"
                          "  - {name: shirt, line: {length: 1, vertices: 3}}\n"
                          "  - {line: {length: 1, vertices: 3}}\n";
  EXPECT_EQ(error(two + "pins:\n  - {vertices: [0], cloth: skirt}\n"),
            at("5:28",
               "pins.0.cloth: there is no cloth 'skirt' (did you mean 'shirt'?); give shirt, or a number "
               "from 0 to 1"));
  EXPECT_EQ(error(two + "pins:\n  - {vertices: [0], cloth: 2}\n"),
            at("5:28", "pins.0.cloth: there is no cloth '2'; give shirt, or a number from 0 to 1"));
  EXPECT_EQ(error(grid + "pins: [{vertices: [0], cloth: x}]\n"),
            at("2:31", "pins.0.cloth: there is no cloth 'x'; give a number from 0 to 0"));
  EXPECT_EQ(
      error(two, {{"cloths.1.name", "shirt"}}),
      "--set cloths.1.name=shirt: cloths.1.name: 'shirt' is the name of cloths.0 already; give each its "
      "own");
  EXPECT_EQ(
      error(two, {{"cloths.1.name", "7"}}),
      "--set cloths.1.name=7: cloths.1.name: must not be a number; cloths have theirs already, from 0 in "
      "the order of the list");
}

TEST(ConfigError, MissingKey) {
  EXPECT_EQ(error("name: a\n"), at("1:1", "give one of the keys cloth, cloths"));
  EXPECT_EQ(error("cloth:\n  grid: {size: [1, 1]}\n"),
            at("2:9",
               "cloth.grid: missing key 'vertices' (numbers of vertices along x and y; row i, column j is "
               "vertex i*nx + j); add it"));
  EXPECT_EQ(error("cloth: {scale: 2}"), at("1:8", "cloth: give one of the keys grid, line, mesh, pattern"));
  EXPECT_EQ(error_after_cloth("pins: [{release: 1}]"),
            at("2:8", "pins.0: give one of the keys vertices, range, box, near, label"));
}

TEST(ConfigError, DuplicateKey) {
  EXPECT_EQ(error_after_cloth("time: {end: 1}\ntime: {end: 2}"),
            at("3:1", "key 'time' is given twice (first at cases/x/case.yaml:2:1); remove one"));
}

TEST(ConfigError, KeysThatExcludeEachOther) {
  EXPECT_EQ(error("cloth:\n  mesh: a.obj\n  grid: {size: [1, 1], vertices: [2, 2]}"),
            at("3:3", "cloth.grid and cloth.mesh exclude each other; keep one"));
  EXPECT_EQ(error_after_cloth("pins: [{vertices: [1], near: [[0, 0, 0]]}]"),
            at("2:24", "pins.0.near and pins.0.vertices exclude each other; keep one"));
}

TEST(ConfigError, Checks) {
  EXPECT_EQ(error_after_cloth("time: {max_step: 1 ms, min_step: 2 ms}"),
            at("2:34", "time.min_step: 0.002 is above max_step, 0.001; make it smaller"));
  EXPECT_EQ(error_after_cloth("time: {max_step: 1e-7}"),
            at("2:7", "time.min_step: 1e-06 is above max_step, 1e-07; make it smaller"));
  EXPECT_EQ(error_after_cloth("pins: [{box: {min: [0, 0, 1], max: [1, 1, 0]}}]"),
            at("2:36", "pins.0.box.max: must not be below min in any direction"));
  EXPECT_EQ(error_after_cloth("pins: [{vertices: []}]"),
            at("2:19", "pins.0.vertices: must not be empty; a pin holds something"));
  EXPECT_EQ(error_after_cloth("pins: [{near: []}]"),
            at("2:15", "pins.0.near: must not be empty; a pin holds something"));
  EXPECT_EQ(error_after_cloth("pins: [{vertices: [1], motion: [{time: 1}, {time: 1}]}]"),
            at("2:32", "pins.0.motion: times must increase from keyframe to keyframe; sort them"));
  EXPECT_THAT(
      error("cloth: {mesh: a.obj, start: {rotate: {angle: 90}}}"),
      testing::HasSubstr("angle: 90 without a unit would be radians, more than a full turn; write '90 deg', "
                         "or '90 rad' if that is meant"));
  for (const char* angle : {"90 rad", "720 deg", "-6.28"}) {
    const Case c = read(std::string("cloth: {mesh: a.obj, start: {rotate: {angle: ") + angle + "}}}");
    EXPECT_EQ(read_case(write_case(c), c.file.string()), c) << angle;
  }
  EXPECT_THAT(error_after_cloth("time: {end: 1e26}"), testing::HasSubstr("end: makes 3e+27 frames"));
  EXPECT_THAT(error_after_cloth("gravity: [0, 0, -1e300]"),
              testing::HasSubstr("gravity: is more than 1e+06 m/s^2"));
  EXPECT_EQ(error("cloth: {mesh: a.obj, start: {rotate: {axis: [0, 0, 0], angle: 1}}}"),
            at("1:45", "cloth.start.rotate.axis: must not be zero; a rotation needs a direction"));
  EXPECT_EQ(error_after_cloth("name: a/b"), at("2:7", "name: must be a word without '/'; it names a folder"));
}

// Overrides.

// A key that the chosen method would not look at: for each, the methods that use it; all others refuse it.
TEST(ConfigError, KeysThatAMethodDoesNotUse) {
  const std::string keep{"fast_projection icd sap shake rattle "}, sweep{"jacobi gauss_seidel "};
  const std::vector<std::pair<std::string, std::string>> used_by{
      {"solver: mumps", keep + "newton "},
      {"max_iterations: 7", keep + "newton "},
      {"residual: 0.2", "newton "},
      {"carried_tension: false", keep + sweep + "newton "},
      {"compliance: 1e-3", keep + "xpbd newton "},
      {"shake: {matrix: lagged}", "shake rattle "},
      {"limiting: {max_sweeps: 9}", sweep},
      {"xpbd: {substeps: 4}", "xpbd "},
      {"springs: {stiffness: 100}", "springs "}};
  for (const std::string_view word : words_of(config::InextensibilityMethod{}))
    for (const auto& [setting, users] : used_by) {
      const std::string method(word), key = setting.substr(0, setting.find(':')),
                                      before = "inextensibility: {method: " + method + ", ";
      const bool uses = users.find(method + " ") != std::string::npos;
      const std::string column = std::to_string(before.size() + setting.find(':') + 3);
      EXPECT_EQ(error_after_cloth(before + setting + "}"),
                uses ? "no error"
                     : at("2:" + column, "inextensibility." + key + ": method " + method +
                                             " does not use it; remove it, or choose another method"));
    }
}

// What goes with a method is not only a matter of its own block.
TEST(ConfigError, MethodsThatDoNotGoWithOtherKeys) {
  const std::string xpbd = "inextensibility: {method: xpbd}\n", plane = "obstacles: [{plane: {}}]\n";
  EXPECT_EQ(error_after_cloth(xpbd), "no error");
  for (const std::string integrator : {"bdf2", "imex"})
    EXPECT_THAT(error_after_cloth(xpbd + "time: {integrator: " + integrator + "}\n"),
                testing::HasSubstr("integrator is not used by inextensibility.method xpbd"));
  EXPECT_EQ(error_after_cloth(plane), "no error");
  for (const std::string_view word : words_of(config::InextensibilityMethod{}))
    EXPECT_EQ(error_after_cloth(plane + "inextensibility: {method: " + std::string(word) + "}\n") ==
                  "no error",
              word == "fast_projection" || word == "newton")
        << word;
  EXPECT_THAT(error_after_cloth(plane + "time: {integrator: bdf2}\n"),
              testing::HasSubstr("integrator bdf2 does not work with contact"));
}

TEST(ConfigOverride, SetsValues) {
  const std::string pinned = grid + "pins: [{vertices: [0]}]";
  EXPECT_EQ(read(grid, {{"time.max_step", "2 ms"}}).time.max_step, 0.002);
  EXPECT_EQ(read(grid, {{"time.end", "2"}, {"time.end", "3"}}).time.end, 3);
  EXPECT_EQ(read(pinned, {{"pins.0.release", "1.0"}}).pins[0].release, 1.0);
  EXPECT_EQ(read(pinned, {{"pins.0.vertices.0", "8"}}).pins[0].vertices, std::vector<Global>{8});
  EXPECT_EQ(read(grid, {{"gravity", "[0, 0, -1]"}}).gravity.at(0), Vec3(0, 0, -1));
  EXPECT_EQ(read(grid, {{"gravity", "[0, 0, -1]"}, {"gravity.0", "5"}}).gravity.at(0), Vec3(5, 0, -1));
  EXPECT_EQ(read(grid, {{"pins", "[{near: [[0, 0, 0]]}]"}}).pins.size(), 1u);
}

TEST(ConfigOverride, MakesMissingBlocks) {
  const Case c = read(grid, {{"air.gust.speed", "3"}});
  ASSERT_TRUE(c.air);
  EXPECT_EQ(c.air->gust.speed, 3);
  EXPECT_EQ(c.air->density, 1.2);
}

TEST(ConfigOverride, TakesThePlaceOfAnExclusiveKey) {
  const Case c = read(grid, {{"cloth.mesh", "a.obj"}});
  EXPECT_EQ(c.cloths[0].mesh, "a.obj");
  EXPECT_FALSE(c.cloths[0].grid);
  EXPECT_EQ(
      error(grid, {{"cloth.mesh", "a.obj"}, {"cloth.line", "{length: 1, vertices: 2}"}}),
      "--set cloth.line={length: 1, vertices: 2}: cloth.line and cloth.mesh exclude each other; keep one");
}

TEST(ConfigOverride, Errors) {
  EXPECT_EQ(error(grid, {{"time.max_stp", "1"}}),
            "--set time.max_stp=1: unknown key 'max_stp' (did you mean 'max_step'?)");
  EXPECT_EQ(error(grid, {{"tme.end", "1"}}), "--set tme.end=1: unknown key 'tme' (did you mean 'time'?)");
  EXPECT_EQ(
      error(grid, {{"time.max_step", "5 mm"}}),
      "--set time.max_step=5 mm: time.max_step: 'mm' is not a unit of time; write seconds as a number, or "
      "e.g. '10 ms' (units: s, ms, us, min)");
  EXPECT_EQ(error(grid, {{"time.end", "[1"}}),
            "--set time.end=[1: not YAML: end of sequence flow not found; check "
            "indentation, colons, brackets and quotes here");
  EXPECT_EQ(error(grid, {{"time.end", ""}}),
            "--set time.end=: time.end: expected a number in seconds, or e.g. '10 ms', found nothing");
  EXPECT_EQ(error(grid, {{"pins.0.release", "1"}}),
            "--set pins.0.release=1: there is no entry 0 to change; add it to the case file");
  EXPECT_EQ(error(grid + "pins: [{vertices: [0]}]", {{"pins.2.release", "1"}}),
            "--set pins.2.release=1: '2' is not an entry of the list, which has 1; count from 0");
  EXPECT_EQ(error(grid + "pins: [{vertices: [0]}]", {{"pins.x.release", "1"}}),
            "--set pins.x.release=1: 'x' is not an entry of the list, which has 1; count from 0");
  EXPECT_EQ(error(grid + "time: {end: 1}", {{"time.end.now", "1"}}),
            "--set time.end.now=1: there is no 'now' below '1'");
}

TEST(Changes, AreToldKeyByKey) {
  const std::string text = "cloth: {grid: {size: [1, 1], vertices: [5, 5]}}\n"
                           "pins: [{vertices: [0, 4]}, {near: [[1, 1, 0]], release: 2}]\n";
  const Case before = read_case(text, "case.yaml");
  EXPECT_TRUE(changes_between(before, before).empty());
  const std::vector<Override> overrides{{"time.end", "2 s"},
                                        {"gravity", "[0, 0, -1]"},
                                        {"pins.1.release", "0.5"},
                                        {"pins.0.motion", "[{time: 1, translate: [0, 0, 1]}]"},
                                        {"air", "{}"}};
  const auto changes = changes_between(before, read_case(text, "case.yaml", overrides));
  std::vector<std::string> words;
  for (const KeyChange& c : changes) words.push_back(c.key + ": " + c.before + " -> " + c.after);
  EXPECT_THAT(words,
              testing::IsSupersetOf({"time.end: 1 -> 2", "gravity: [0, 0, -9.81] -> [0, 0, -1]",
                                     "pins.1.release: 2 -> 0.5",
                                     "pins.0.motion.0.translate: none -> [0, 0, 1]", "air.drag: none -> 1"}));
  for (const KeyChange& c : changes)
    EXPECT_TRUE(c.key.starts_with("time.end") || c.key.starts_with("gravity") || c.key.starts_with("pins.") ||
                c.key.starts_with("air."))
        << c.key;
}
