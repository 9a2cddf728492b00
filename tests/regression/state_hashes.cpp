// Fingerprints of named runs, for the table that every build must reproduce.
//
//   state_hashes TABLE           compares with the table; exit code 1 and a list of what differs
//   state_hashes --write TABLE   writes the table of this build
//
// Every run is made on one thread and on the default backend. The flags of Kokkos are honoured. The
// program needs the kernels and nothing else, so that any compiler can be asked.
#include "ricochet/engine.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

#include <Kokkos_Core.hpp>

#include <cstdint>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <sstream>
#include <string>

namespace ricochet::test {
namespace {

struct NamedScene {
  std::string name;
  Scene scene;
  std::int64_t steps;
};

/// The original's own kind of scene: its box, radius, step and coefficients.
Scene originals_scene()
{
  Scene scene;
  Random random(1);
  for (int k = 0; k < 1500; ++k)
    scene.discs.push_back({random.between(-355, 355), random.between(-355, 355),
                           random.between(-200, 200), random.between(-200, 200)});
  return scene;
}

Scene random_scene(std::size_t count, double width, double height, double speed, double gravity,
                   Contact const& contact, Boundary x, Boundary y, Ids ids, std::uint64_t seed)
{
  Scene scene;
  scene.model = make_model(width, height, gravity, contact, x, y);
  scene.discs = random_discs(scene.model, count, speed, ids, seed);
  return scene;
}

/// A lattice of discs that just touch, at rest under gravity, and among them the rare states: the
/// same centre twice, the same disc twice, a negative zero, denormal numbers.
Scene rare_states()
{
  Scene scene;
  scene.model = make_model(40, 60, 9.81, {Law::restitution, 0.5, 0.5});
  for (int row = 0; row < 10; ++row)
    for (int column = 0; column < 20; ++column)
      scene.discs.push_back({-19.0 + 2 * column, -29.0 + 2 * row, 0, 0});
  scene.discs.push_back({0, 10, 1, 0});
  scene.discs.push_back({0, 10, -1, 2});
  scene.discs.push_back({5, 10, 1, 1});
  scene.discs.push_back({5, 10, 1, 1});
  scene.discs.push_back({-0.0, 20, -0.0, 0});
  scene.discs.push_back({0, 21.5, 4.9e-324, -1e-310});
  scene.discs.push_back({19, 29, 0x1p-1000, 0x1p-1030});
  return scene;
}

std::vector<NamedScene> named_scenes()
{
  constexpr auto walls = Boundary::walls, periodic = Boundary::periodic;
  Contact const elastic{Law::swap_scale, 1, 1}, scaling{Law::swap_scale, 0.93, 0.9},
      damping{Law::restitution, 0.9, 0.8};
  return {
      {"original", originals_scene(), 100},
      {"gas", random_scene(2000, 180, 175, 30, 0, elastic, periodic, periodic, Ids::shuffled, 2),
       100},
      {"gas_in_a_tall_box",
       random_scene(800, 50, 251, 30, 9.81, elastic, periodic, walls, Ids::reversed, 3), 100},
      {"crowd", random_scene(1100, 60, 53, 15, 0, damping, periodic, periodic, Ids::shuffled, 4),
       50},
      {"crowd_in_rows",
       random_scene(1000, 62, 63, 15, 9.81, scaling, walls, walls, Ids::row_major, 5), 50},
      {"crossing_the_box",
       random_scene(150, 41, 37, 2000, 9.81, scaling, walls, walls, Ids::shuffled, 6), 60},
      {"lift", random_scene(500, 71, 73, 10, -3, damping, walls, walls, Ids::shuffled, 7), 100},
      {"rare_states", rare_states(), 50},
      {"large", random_scene(30000, 660, 570, 40, 9.81, damping, walls, walls, Ids::shuffled, 8),
       10},
  };
}

/// Scenes for engines that take only discs that do not overlap: `events` with the step given, `toi`
/// with many shorter ones.
std::vector<NamedScene> separate_scenes()
{
  constexpr auto walls = Boundary::walls, periodic = Boundary::periodic;
  Contact const elastic{Law::swap_scale, 1, 1}, scaling{Law::swap_scale, 0.93, 0.9},
      damping{Law::restitution, 0.95, 0.8}, apart{Law::restitution, 0.9, 0.8, false};
  auto const scene = [](std::size_t count, double width, double height, double gravity,
                        Contact const& contact, Boundary x, Boundary y, double dt) {
    Scene result;
    result.model = make_model(width, height, gravity, contact, x, y);
    result.discs = separate_discs(result.model, count, 10, count);
    result.dt = dt;
    return result;
  };
  return {
      {"dilute_gas", scene(500, 181, 173, 0, elastic, periodic, periodic, 2), 4},
      {"fluid", scene(2000, 115, 109, 0, elastic, walls, walls, 0.3), 5},
      {"solid", scene(1000, 66, 60, 0, elastic, periodic, periodic, 0.1), 5},
      {"gas_in_a_tall_box", scene(700, 50, 251, 1, elastic, periodic, walls, 1), 5},
      {"scaling_gas", scene(1500, 110, 120, 0, scaling, walls, periodic, 0.5), 5},
      {"cooling_gas", scene(1500, 150, 140, 0, damping, walls, walls, 0.5), 5},
      {"lift", scene(500, 71, 73, -0.5, damping, periodic, walls, 0.3), 3},
      {"apart", scene(1000, 60, 70, 3, apart, periodic, walls, 2), 5},
      {"many", scene(12000, 270, 280, 0.1, elastic, walls, walls, 0.3), 2},
  };
}

/// "scene engine precision" -> hash, 16 hex digits.
using Table = std::map<std::string, std::string>;

std::string hash_after(NamedScene const& named, EngineKind engine, Precision precision,
                       Placement placement)
{
  auto const run = make_engine(named.scene.model, {engine, precision, named.scene.dt, placement},
                               named.scene.discs);
  run->advance(named.steps);
  std::ostringstream text;
  text << std::hex << std::setw(16) << std::setfill('0') << run->state_hash();
  return text.str();
}

Table table_of_this_build(Placement placement)
{
  Table table;
  auto const add = [&](NamedScene const& named, EngineKind engine) {
    for (auto const precision : {Precision::double_, Precision::single_})
      table[named.name + " " + name(engine) + " " + name(precision)] =
          hash_after(named, engine, precision, placement);
  };
  for (auto const& named : named_scenes())
    for (auto const engine : {EngineKind::sweep, EngineKind::simultaneous})
      add(named, engine);
  for (auto const& named : separate_scenes()) {
    add(named, EngineKind::events);
    NamedScene stepped = named;
    stepped.scene.dt = named.scene.dt / 16;
    stepped.steps = 8 * named.steps;
    add(stepped, EngineKind::toi);
  }
  return table;
}

Table read(std::string const& path)
{
  Table table;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    auto const space = line.rfind(' ');
    if (!line.empty() && line[0] != '#' && space != std::string::npos)
      table[line.substr(0, space)] = line.substr(space + 1);
  }
  return table;
}

/// Number of entries in which the tables differ; each is printed.
int differences(Table const& actual, Table const& expected, std::string const& where)
{
  int count = 0;
  auto const report = [&](std::string const& key, std::string const& a, std::string const& e) {
    std::cout << key << ", " << where << ": " << a << " instead of " << e << "\n";
    ++count;
  };
  for (auto const& [key, hash] : actual) {
    auto const entry = expected.find(key);
    if (entry == expected.end())
      report(key, hash, "no entry");
    else if (entry->second != hash)
      report(key, hash, entry->second);
  }
  for (auto const& [key, hash] : expected)
    if (actual.count(key) == 0)
      report(key, "nothing", hash);
  return count;
}

int compare_with(std::string const& path)
{
  auto const expected = read(path);
  int const count =
      differences(table_of_this_build(Placement::serial), expected, "on one thread") +
      differences(table_of_this_build(Placement::parallel), expected, "on the default backend");
  std::cout << expected.size() << " entries in the table, "
            << Kokkos::DefaultExecutionSpace().concurrency() << " threads, " << count
            << " differences\n";
  return count == 0 && !expected.empty() ? 0 : 1;
}

int write(std::string const& path)
{
  std::ofstream file(path);
  file << "# scene engine precision state_hash; written by `state_hashes --write`\n";
  for (auto const& [key, hash] : table_of_this_build(Placement::serial))
    file << key << " " << hash << "\n";
  return file.flush() ? 0 : 1;
}

} // namespace
} // namespace ricochet::test

int main(int argc, char** argv)
{
  Kokkos::ScopeGuard const kokkos(argc, argv);
  if (argc == 2)
    return ricochet::test::compare_with(argv[1]);
  if (argc == 3 && std::string(argv[1]) == "--write")
    return ricochet::test::write(argv[2]);
  std::cerr << "usage: state_hashes [--write] TABLE\n";
  return 64;
}
